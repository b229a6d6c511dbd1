// SPDX-License-Identifier: BSD-3-Clause
#include "python/src/new_imu.h"

#include "python/src/given.h"

namespace slamdb::python {

namespace py = pybind11;

namespace {

class Part {
 public:
  explicit Part(py::handle object) : object_(object) {}

  py::object operator()(const char* name) const { return PartOf(object_, name); }
  static std::string Place(const char* name) { return std::string("imu.") + name; }

  template <class Element>
  std::vector<Element> Rows(const char* name, py::ssize_t width) const {
    return GivenElements<Element, float>((*this)(name), Place(name), {-1, width});
  }
  Vector6f Variances(const char* name) const {
    const auto numbers = GivenAs<float>((*this)(name), Place(name), {6});
    return Eigen::Map<const Vector6f>(numbers.data());
  }

 private:
  py::handle object_;
};

std::vector<Column<ImuMeasurement>> MeasurementsOf(const py::object& given) {
  std::vector<Column<ImuMeasurement>> measurements;
  for (const py::handle item : GivenItems(given, "imu.measurements")) {
    const std::string name = "imu.measurements: row " + std::to_string(measurements.size());
    measurements.push_back(GivenElements<ImuMeasurement, float, Column<ImuMeasurement>>(item, name, {-1, 7}));
  }
  return measurements;
}

// Of one column alone the other is 0.
std::vector<ImuBias> BiasesOf(const Part& part) {
  const auto accelerometer = part.Rows<Eigen::Vector3f>("accelerometer_biases", 3);
  const auto gyroscope = part.Rows<Eigen::Vector3f>("gyroscope_biases", 3);
  if (!accelerometer.empty() && !gyroscope.empty() && accelerometer.size() != gyroscope.size())
    RefuseGiven("imu.gyroscope_biases", "has " + std::to_string(gyroscope.size()) + " rows, but there are " +
                                            std::to_string(accelerometer.size()) + " accelerometer_biases");
  std::vector<ImuBias> biases(std::max(accelerometer.size(), gyroscope.size()));
  for (std::size_t row = 0; row < accelerometer.size(); ++row) biases[row].accelerometer = accelerometer[row];
  for (std::size_t row = 0; row < gyroscope.size(); ++row) biases[row].gyroscope = gyroscope[row];
  return biases;
}

}  // namespace

std::optional<NewImu> GivenImu(py::handle object) {
  if (object.is_none()) return std::nullopt;
  const Part part(object);
  if (part("body_from_camera").is_none() || part("measurements").is_none())
    RefuseGiven("imu", "has no body_from_camera or no measurements; it is slamdb.ImuArrays");
  NewImu imu;
  imu.body_from_camera = GivenTransform(part("body_from_camera"), "imu.body_from_camera");
  imu.noise = part.Variances("noise");
  imu.walk_noise = part.Variances("walk_noise");
  imu.measurements = MeasurementsOf(part("measurements"));
  imu.velocities = part.Rows<Eigen::Vector3f>("velocities", 3);
  imu.biases = BiasesOf(part);
  static_assert(sizeof(ImuBias) == 6 * sizeof(float));
  imu.integration_biases = part.Rows<ImuBias>("integration_biases", 6);
  imu.previous = GivenIdsOf<KeyFrame>(part("previous"), "imu.previous");
  return imu;
}

}  // namespace slamdb::python
