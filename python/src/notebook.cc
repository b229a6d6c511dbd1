// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/choices.h"
#include "cli/words.h"
#include "python/src/arguments.h"
#include "python/src/errors.h"
#include "python/src/files.h"
#include "python/src/map_in_atlas.h"
#include "python/src/module.h"
#include "python/src/reopen.h"
#include "python/src/unlocked.h"
#include "slamdb/base/error.h"
#include "slamdb/base/output_name.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/info.h"
#include "slamdb/many/selected.h"
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
  const AtlasStatistics statistics = WithoutGil([&] { return ComputeStatistics(*value); });
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
  const Unlocked unlocked;
  return DrawPlot(*value, {.kind = PlotKind::kPlan, .width = width}).bytes;
}

// Atlases to show, of which a page is made.
struct Viewing {
  std::vector<AtlasOrPath> sources;
  ReadOptions read;
  ViewOptions options;
  std::string findings, report;  // what a report found: the path of one, or its JSON
  OutputFile output;
  std::size_t embedded = 0;  // bytes of a page for which keypoints are left out where it is larger; 0: none are

  ViewPage Do(Notices& notices) const {
    if (output.any())
      if (const std::string why = WhyNoPage(output.path); !why.empty()) throw Error(ErrorKind::kUsage, why);
    ViewOptions page_options = options;
    const bool reported = !findings.empty() || !report.empty();
    if (reported && sources.size() != 1) throw Error(ErrorKind::kUsage, "findings= is of one atlas");
    // What a part leaves out would be found missing.
    if (!read.selection.everything() || reported) page_options.check = false;
    std::vector<std::shared_ptr<const Atlas>> held;  // to which inputs refer
    std::vector<ViewInput> inputs;
    for (const AtlasOrPath& source : sources) inputs.push_back(InputOf(source, held, notices));
    if (!findings.empty()) inputs.front().findings = ReadFindings(findings, sources.front().path);
    if (!report.empty()) inputs.front().findings = ParseFindings(report, sources.front().path);
    ViewPage page = MakeViewPage(inputs, page_options);
    if (embedded != 0 && page.html.size() > embedded && options.keypoints == ViewKeypoints::kAuto) {
      page_options.keypoints = ViewKeypoints::kNone;
      page = MakeViewPage(inputs, page_options);
      page.report.left_out.emplace_back(
          "keypoints, which are too many for a notebook; slamdb.view(atlas, 'map.html') has them");
    }
    output.Write(page.html);
    return page;
  }

 private:
  ViewInput InputOf(const AtlasOrPath& source, std::vector<std::shared_ptr<const Atlas>>& held,
                    Notices& notices) const {
    RefuseIdleSelection(source, read);
    const Format* format = nullptr;
    if (source.atlas) {
      held.push_back(source.atlas);
    } else {
      const HeldSource file = HoldInput(Location(source.path), read);
      format = read.format.empty() ? FindFormatOfInput(file) : &FormatById(read.format);
      held.push_back(std::make_shared<const Atlas>(ReadPartToShow(source.path, file, read, notices)));
    }
    return ViewInputOf(*held.back(), source.path, format, cli::InCommandWords);
  }
};

Viewing ViewingOf(Arguments& given) {
  Viewing viewing{.sources = given.Sources("sources"), .read = ReadingOf(given)};
  viewing.read.needs = Content::kPoses | Content::kPoints;
  ViewOptions& options = viewing.options;
  given.Take("title", options.title);
  given.TakeWord("keypoints", cli::kViewKeypoints, options.keypoints);
  if (given.Get<bool>("side_by_side")) options.layout = ViewLayout::kSideBySide;
  given.Take("normals", options.normals);
  given.Take("check", options.check);
  given.Take("diff", options.diff);
  given.TakeRun(options);
  options.wording = cli::InCommandWords;
  viewing.findings = given.Path("findings");
  given.Take("report", viewing.report);
  viewing.output = given.Output("output");
  given.Take("embedded", viewing.embedded);
  return viewing;
}

// The page of `slamdb view`, and what is not in it.
py::tuple ViewPageOf(const py::dict& values) {
  Arguments given(values);
  const Viewing viewing = ViewingOf(given);
  given.RequireAllTaken();
  Notices notices;
  const ViewPage page = WithoutGil([&] { return viewing.Do(notices); });
  return py::make_tuple(page.html, page.report.left_out, ListOf(notices));
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
