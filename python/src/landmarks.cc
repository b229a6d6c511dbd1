// SPDX-License-Identifier: BSD-3-Clause
#include "python/src/map_in_atlas.h"
#include "python/src/module.h"
#include "python/src/reopen.h"

// Landmarks with Gaussian positions, of MRPT.
namespace slamdb::python {

namespace py = pybind11;

namespace {

struct LandmarksInMap {
  MapInAtlas of;
  std::vector<Landmark>& list() const { return of.map().landmarks; }
};

// A member of all landmarks as an array over it.
template <class Number, class MemberOf>
auto Members(MemberOf member_of, py::ssize_t width = 1) {
  return [member_of, width](const LandmarksInMap& landmarks) {
    static const Landmark none{};
    const std::vector<Landmark>& list = landmarks.list();
    ArrayPlace place{
        &member_of(list.empty() ? none : list.front()), {static_cast<py::ssize_t>(list.size())}, {sizeof(Landmark)}};
    if (width > 1) {
      place.shape.push_back(width);
      place.strides.push_back(sizeof(Number));
    }
    return ViewOf(landmarks.of.kept(), py::dtype::of<Number>(), std::move(place));
  };
}

py::array Covariances(const LandmarksInMap& landmarks) {
  const std::vector<Landmark>& list = landmarks.list();
  py::array_t<double> covariances({static_cast<py::ssize_t>(list.size()), py::ssize_t{3}, py::ssize_t{3}});
  double* at = covariances.mutable_data();
  for (const Landmark& landmark : list) at = std::copy_n(landmark.pose().covariance.data(), 9, at);  // symmetric
  return ReadOnly(std::move(covariances));
}

}  // namespace

void DefineLandmarks(py::module_& module) {
  py::class_<LandmarksInMap>(module, "Landmarks", "The MRPT landmarks of a map: columns as numpy arrays.")
      .def("__len__", [](const LandmarksInMap& l) { return l.list().size(); })
      .def_property_readonly("ids", Members<std::uint64_t>([](const Landmark& l) -> auto& { return l.id; }),
                             "(N,) uint64: CLandmark::ID; NONE where it has none")
      .def_property_readonly("means",
                             Members<double>(
                                 [](const Landmark& l) -> auto& { return l.mean; }, 3),
                             "(N, 3) float64, writable: in the world frame of the map, metres or its units")
      .def_property_readonly("normals",
                             Members<double>(
                                 [](const Landmark& l) -> auto& { return l.normal; }, 3),
                             "(N, 3) float64, writable: towards their sensors; zeros: not known")
      .def_property_readonly("covariances", &Covariances, "(N, 3, 3) float64, computed: of the means; zeros: not known")
      .def_property_readonly("seen_counts",
                             Members<std::uint32_t>([](const Landmark& l) -> auto& { return l.seen_count; }),
                             "(N,) uint32, writable: how often they were seen");
  Reopen<py::class_<MapInAtlas>>(module, "Map")
      .def_property_readonly(
          "landmarks", [](const MapInAtlas& m) { return LandmarksInMap{m}; }, "the MRPT landmarks; no .osa holds them");
}

}  // namespace slamdb::python
