// SPDX-License-Identifier: BSD-3-Clause
#include "python/src/module.h"
#include "python/src/reopen.h"
#include "python/src/row_class.h"

// Landmarks with Gaussian positions, of MRPT.
namespace slamdb::python {

namespace py = pybind11;

namespace {

using LandmarksInMap = EntitiesInMap<&Map::landmarks>;

template <class Number, class Member>
auto OfLandmarks(const Member& member, py::ssize_t width = 1) {
  return MembersOf<LandmarksInMap, Number>(member, width);
}

py::array Covariances(const LandmarksInMap& landmarks) {
  const auto list = landmarks.list();
  auto covariances = NewArray<double>({static_cast<py::ssize_t>(list->size()), py::ssize_t{3}, py::ssize_t{3}});
  double* at = covariances.mutable_data();
  for (const Landmark& landmark : *list) at = std::copy_n(landmark.pose().covariance.data(), 9, at);  // symmetric
  return ReadOnly(std::move(covariances));
}

}  // namespace

void DefineLandmarks(py::module_& module) {
  py::class_<LandmarksInMap> landmarks(module, "Landmarks", "The MRPT landmarks of a map: columns as numpy arrays.");
  DefineContainer(landmarks, "landmark");
  landmarks
      .def_property_readonly("ids", FixedMembersOf<LandmarksInMap, std::uint64_t>(&Landmark::id),
                             "(N,) uint64: CLandmark::ID; NONE where it has none")
      .def_property_readonly("means", OfLandmarks<double>(&Landmark::mean, 3),
                             "(N, 3) float64, writable: in the world frame of the map, metres or its units")
      .def_property_readonly("normals", OfLandmarks<double>(&Landmark::normal, 3),
                             "(N, 3) float64, writable: towards their sensors; zeros: not known")
      .def_property_readonly("covariances", &Covariances, "(N, 3, 3) float64, computed: of the means; zeros: not known")
      .def_property_readonly("seen_counts", OfLandmarks<std::uint32_t>(&Landmark::seen_count),
                             "(N,) uint32, writable: how often they were seen");
  Reopen<py::class_<MapInAtlas>>(module, "Map")
      .def_property_readonly(
          "landmarks", [](const MapInAtlas& m) { return LandmarksInMap{m}; }, "the MRPT landmarks; no .osa holds them");
}

}  // namespace slamdb::python
