// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "python/src/errors.h"
#include "python/src/map_in_atlas.h"
#include "python/src/module.h"
#include "python/src/reopen.h"
#include "slamdb/formats/info.h"
#include "slamdb/model/statistics.h"
#include "slamdb/plot/plot.h"
#include "slamdb/view/page.h"

// What notebooks show of atlases, and their tables. slamdb/notebook.py and slamdb/tables.py document what is here.
namespace slamdb::python {

namespace py = pybind11;

namespace {

// An atlas of that map alone, with its cameras.
std::shared_ptr<HeldAtlas> Alone(const MapInAtlas& map) {
  Atlas alone;
  const auto value = map.atlas->value();
  alone.cameras = value->cameras;
  alone.maps.push_back(map.In(*value));
  return std::make_shared<HeldAtlas>(std::move(alone));
}

// What is in each of its maps, as far as a notebook shows it.
py::list Statistics(const HeldAtlas& atlas) {
  const auto value = atlas.value();
  const AtlasStatistics statistics = [&] {
    const py::gil_scoped_release unlocked;
    return ComputeStatistics(*value);
  }();
  py::list maps;
  for (const MapStatistics& map : statistics.maps) {
    py::dict row;
    row["map"] = IdOrNone(map.id);
    row["sensor"] = std::string(NameOf(map.sensor)) + (map.has_imu ? ", IMU" : "");
    row["keyframes"] = map.keyframes;
    row["points"] = map.points;
    row["observations"] = map.observations;
    row["reprojection_error_px"] = map.reprojection_error.mean;
    row["trajectory_length"] = map.trajectory_length;
    row["unit"] = map.metric ? "m" : "units";
    row["duration_s"] = map.end_time - map.begin_time;
    maps.append(row);
  }
  return maps;
}

// Its plan as SVG; None where there is no Cairo.
std::optional<std::string> Plan(const HeldAtlas& atlas, int width) {
  if (!CanPlot()) return std::nullopt;
  const auto value = atlas.value();
  const py::gil_scoped_release unlocked;
  return DrawPlot(*value, {.kind = PlotKind::kPlan, .width = width}).bytes;
}

const std::map<std::string, ViewKeypoints> kKeypoints = {{"auto", ViewKeypoints::kAuto},
                                                         {"all", ViewKeypoints::kAll},
                                                         {"matched", ViewKeypoints::kMatched},
                                                         {"none", ViewKeypoints::kNone}};

// The page of `slamdb view`, and what is not in it.
py::tuple ViewPageOf(const std::vector<std::shared_ptr<HeldAtlas>>& atlases, const std::vector<std::string>& names,
                     const std::string& title, const std::string& keypoints, bool side_by_side, bool normals,
                     bool check, bool diff, int threads, const py::object& progress) {
  if (!kKeypoints.contains(keypoints)) throw py::value_error("keypoints is 'auto', 'all', 'matched' or 'none'");
  const ViewOptions options{.title = title,
                            .keypoints = kKeypoints.at(keypoints),
                            .layout = side_by_side ? ViewLayout::kSideBySide : ViewLayout::kOverlay,
                            .normals = normals,
                            .check = check,
                            .diff = diff,
                            .threads = threads,
                            .progress = ProgressTo(progress)};
  std::vector<std::shared_ptr<Atlas>> values;
  std::vector<ViewInput> inputs;
  for (std::size_t i = 0; i < atlases.size(); ++i) {
    values.push_back(atlases[i]->value());
    inputs.push_back({.atlas = values.back().get(), .name = names[i]});
  }
  const ViewPage page = [&] {
    const py::gil_scoped_release unlocked;
    return MakeViewPage(inputs, options);
  }();
  return py::make_tuple(page.html, page.report.left_out);
}

// Calls a function of a module of the package, which is not imported before.
auto Calling(const char* module, const char* function) {
  return [module, function](const py::object& self) { return py::module_::import(module).attr(function)(self); };
}

}  // namespace

void DefineNotebook(py::module_& module) {
  module.def("alone", &Alone);
  module.def("statistics", &Statistics);
  module.def("plan", &Plan);
  module.def("view_page", &ViewPageOf);

  Reopen<py::class_<HeldAtlas, std::shared_ptr<HeldAtlas>>>(module, "Atlas")
      .def("_repr_html_", Calling("slamdb.notebook", "html_of_atlas"));
  Reopen<py::class_<MapInAtlas>>(module, "Map").def("_repr_html_", Calling("slamdb.notebook", "html_of_map"));
  Reopen<py::class_<KeyFramesInMap>>(module, "KeyFrames")
      .def("to_pandas", Calling("slamdb.tables", "frame_of_keyframes"),
           "A DataFrame with a row for each: id, timestamp (seconds), x, y, z (camera centre, world), qx, qy, qz, qw "
           "(world from camera), parent (<NA>: none), bad. Raises ImportError where pandas is not installed.");
  Reopen<py::class_<PointsInMap>>(module, "Points")
      .def("to_pandas", Calling("slamdb.tables", "frame_of_points"),
           "A DataFrame with a row for each: id, x, y, z (world), nx, ny, nz (mean viewing direction), observations "
           "(how many keyframes see it), reference_keyframe (<NA>: none), min_distance, max_distance, bad. Raises "
           "ImportError where pandas is not installed.");
}

}  // namespace slamdb::python
