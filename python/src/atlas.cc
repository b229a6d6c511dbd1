// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include "python/src/module.h"
#include "python/src/row_class.h"
#include "slamdb/formats/info.h"

namespace slamdb::python {

namespace py = pybind11;

namespace {

std::vector<MapInAtlas> MapsOf(const std::shared_ptr<HeldAtlas>& atlas) {
  std::vector<MapInAtlas> maps;
  const auto value = atlas->value();
  for (const Map& map : value->maps) maps.push_back({atlas, maps.size(), map.id});
  return maps;
}

py::list CamerasOf(const HeldAtlas& atlas) {
  py::list cameras;
  const auto value = atlas.value();
  for (const Camera& camera : value->cameras) {
    py::dict parameters;
    const std::vector<std::string> names = ParameterNames(camera.model);
    for (std::size_t i = 0; i < std::min(names.size(), camera.parameters.size()); ++i)
      parameters[names[i].c_str()] = camera.parameters[i];
    py::dict described;
    described["id"] = IdOrNone(camera.id);
    described["model"] = std::string(NameOf(camera.model));
    described["parameters"] = parameters;
    cameras.append(described);
  }
  return cameras;
}

std::string TextOf(const MapInAtlas& map) {
  const auto shown = map.map();
  return ToString(map.id) + ": " + Counted(shown->keyframes.size(), "keyframe") + ", " +
         Counted(shown->points.size(), "point");
}

std::string TextOf(const std::shared_ptr<HeldAtlas>& atlas) {
  std::string text = "<slamdb.Atlas: " + Counted(atlas->value()->maps.size(), "map");
  for (const MapInAtlas& map : MapsOf(atlas)) text += "; " + TextOf(map);
  return text + ">";
}

}  // namespace

void DefineAtlas(py::module_& module) {
  py::class_<MapInAtlas> map(module, "Map", "Keyframes and map points in one world frame.");
  DefineIdentity(map);
  map.def_property_readonly("id", [](const MapInAtlas& m) { return IdOrNone(m.id); })
      .def_property_readonly("keyframes", [](const MapInAtlas& m) { return KeyFramesInMap{m}; })
      .def_property_readonly("points", [](const MapInAtlas& m) { return PointsInMap{m}; })
      .def_property_readonly(
          "inertial", [](const MapInAtlas& m) { return static_cast<bool>(m.map()->inertial); },
          "of a session with an IMU")
      .def_property_readonly("imu_initialized",
                             [](const MapInAtlas& m) { return static_cast<bool>(m.map()->imu_initialized); })
      .def("__repr__", [](const MapInAtlas& m) { return "<slamdb.Map: " + TextOf(m) + ">"; });

  py::class_<HeldAtlas, std::shared_ptr<HeldAtlas>>(module, "Atlas", "Maps, their keyframes and points, and cameras.")
      .def_property_readonly("maps", &MapsOf, "the maps, each in a world frame of its own")
      .def_property_readonly("cameras", &CamerasOf, "[{id, model, parameters: {fx: ...}}]")
      .def_property_readonly("vocabulary_name", [](const HeldAtlas& a) { return a.value()->vocabulary.name; })
      .def_property_readonly(
          "vocabulary_checksum", [](const HeldAtlas& a) { return a.value()->vocabulary.checksum; },
          "MD5, 32 hexadecimal digits")
      .def_property_readonly(
          "layout", [](const HeldAtlas& a) { return a.value()->layout; },
          "of the fork's file it was read from; empty: ORB-SLAM3 v1.0")
      .def("__repr__", [](const std::shared_ptr<HeldAtlas>& a) { return TextOf(a); });
}

}  // namespace slamdb::python
