// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "cli/choices.h"
#include "python/src/errors.h"
#include "python/src/estimates.h"
#include "python/src/module.h"
#include "python/src/unlocked.h"
#include "python/src/verb.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/frame/similarity_text.h"
#include "slamdb/edit/words/words.h"
#include "slamdb/formats/g2o/options.h"
#include "slamdb/formats/geographic/options.h"
#include "slamdb/formats/layouts/layout_text.h"
#include "slamdb/formats/mrpt/options.h"
#include "slamdb/formats/orbslam3/boost_versions.h"
#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/rows/options.h"
#include "slamdb/formats/trajectories.h"
#include "slamdb/many/convert.h"
#include "slamdb/many/names.h"
#include "slamdb/many/selected.h"
#include "slamdb/plot/plot.h"
#include "slamdb/synthetic/synthesize.h"

// Verbs that write what is to be looked at, or used elsewhere. slamdb/outputs.py documents what is here.
namespace slamdb::python {

namespace py = pybind11;

namespace {

// What is to be shown: an atlas, or the part of a file.
std::shared_ptr<const Atlas> ToShow(const AtlasOrPath& source, const ReadOptions& read, Notices& notices) {
  RefuseIdleSelection(source, read);
  if (source.atlas) return source.atlas;
  return std::make_shared<const Atlas>(ReadPartToShow(source.path, HoldInput(source.path, read), read, notices));
}

std::optional<std::uint32_t> BoostVersionOf(Arguments& given) {
  if (!given.Has("boost_version")) return std::nullopt;
  const std::string name = given.Get<std::string>("boost_version");
  if (const auto version = BoostVersionByName(name)) return version;
  throw Error(ErrorKind::kUsage, WhyNoBoostVersion(name));
}

WriteOptions WritingOf(Arguments& given) {
  WriteOptions write;
  given.Take("to", write.format);
  if (given.Get<bool>("text")) write.format = "orbslam3-text";
  given.Take("strict", write.strict);
  given.Take("overwrite", write.overwrite);
  given.Take("sync", write.sync);
  given.Take("wait", write.of<StoreWriteOptions>().lock_timeout, cli::kNonNegative);
  Orbslam3WriteOptions& archive = write.of<Orbslam3WriteOptions>();
  if (given.Has("to_layout")) archive.layout = LayoutNamed(given.Path("to_layout"));
  archive.boost_version = BoostVersionOf(given);
  given.Take("long_bytes", archive.long_bytes);
  if (archive.long_bytes && *archive.long_bytes != 4 && *archive.long_bytes != 8)
    throw Error(ErrorKind::kUsage, "long_bytes= is 4 or 8");
  if (given.Has("map")) write.of<ExportOptions>().map = MapId(given.Get<std::uint64_t>("map"));
  PointCloudOptions& cloud = write.of<PointCloudOptions>();
  cloud.binary = !given.Get<bool>("ascii");
  given.TakeWord("color", cli::kColors, cloud.color);
  given.Take("cameras", cloud.cameras);
  given.Take("most_points", write.of<GeographicOptions>().most_points, cli::kNonNegative);
  given.Take("mrpt_own_slots", write.of<MrptWriteOptions>().own_slots);
  given.Take("sim3", write.of<G2oWriteOptions>().similarities);
  given.Take("with_database", write.of<ColmapWriteOptions>().with_database);
  given.TakeWord("colmap_schema", cli::kColmapSchemas, write.of<ColmapWriteOptions>().schema);
  given.TakeRun(write);
  return write;
}

struct Converting {
  AtlasOrPath source;
  std::string output, origin, images;
  ConvertOptions options;

  std::string Do(Notices& notices) const {
    ConvertOptions convert = options;
    const Location to(NamedOutput(source.path, output, convert.write.format));
    const Format& format = FormatOfOutput(to, convert.write.format);
    RefuseIdleSelection(source, convert.read);
    convert.write.of<StoreWriteOptions>().provenance =
        source.path.empty() ? "convert" : "convert " + Location(source.path).ToString();
    convert.where = WhereOnEarth(origin, source.path, format, notices);
    if (!images.empty()) convert.write.of<ColmapWriteOptions>().pictures = FindKeyFramePictures(images);
    const Converted converted =
        source.atlas ? Convert(*source.atlas, to, convert, notices)
                     : Convert(HoldInput(Location(source.path), convert.read), source.path, to, convert, notices);
    return ToJson(converted.report, {.input = source.path, .output = convert.dry_run ? std::string() : to.ToString()});
  }
};

// Options that would be without effect.
void RefuseIdleOptions(const Format& output, Arguments& given) {
  const auto are_for = [&](bool fits, std::initializer_list<const char*> names, const std::string& whose) {
    if (!fits) given.RefuseIdle(names, "is for " + whose + " only; the output is " + std::string(output.title));
  };
  are_for(IsTrajectory(output) || given.Has("onto"), {"body"}, "trajectories");
  are_for(output.id == "g2o", {"sim3"}, "g2o");
  are_for(output.has_colors, {"color"}, "PLY, PCD, glTF and MCAP");
  are_for(output.id == "ply", {"cameras"}, "PLY");
  are_for(output.is_on_globe, {"origin", "most_points"}, "KML and GeoJSON");
  are_for(cli::NamesPictures(output), {"images"}, "COLMAP, NeRF and Gaussian splatting");
  are_for(cli::IsModel(output), {"with_database"}, "COLMAP models");
  are_for(output.id.starts_with("orbslam3"), {"long_bytes"}, "archives of ORB-SLAM3");
}

void DefineConvert(py::module_& module) {
  DefineReport(module, "convert", [](Arguments& given) {
    Converting converting{.source = given.SourceAt("source"), .output = given.OutputAtlas("output")};
    given.Take("origin", converting.origin);
    converting.images = given.Path("images");
    ConvertOptions& options = converting.options;
    options.read = ReadingOf(given);
    options.read.of<TrajectoryReadOptions>() = TimesOf(given);
    options.read.of<ColmapReadOptions>().database = given.Path("database");
    options.onto = given.Path("onto");
    options.read_onto = options.read;
    options.read_onto.format.clear();
    options.read_onto.selection = {};
    options.write = WritingOf(given);
    const Location to(NamedOutput(converting.source.path, converting.output, options.write.format));
    RefuseIdleOptions(FormatOfOutput(to, options.write.format), given);
    given.Take("body", options.body);
    options.write.of<TrajectoryOptions>().pose_frame = options.body ? PoseFrame::kBody : PoseFrame::kCamera;
    given.Take("sanitize", options.sanitize);
    given.Take("dry_run", options.dry_run);
    return [converting](Notices& notices) { return converting.Do(notices); };
  });
}

std::map<std::string, PlotKind> KindsOfPlots() {
  std::map<std::string, PlotKind> kinds;
  for (const PlotKind kind : PlotKinds()) kinds.emplace(NameOf(kind), kind);
  return kinds;
}

struct Plotting {
  AtlasOrPath source, with;
  ReadOptions read;
  EstimatesOptions reference;
  EvaluationOptions evaluation;
  PlotOptions options;
  OutputFile output;

  PlotReference HoldAgainst(const Atlas& atlas, Notices& notices) const {
    const Format* format = source.atlas ? nullptr : FindFormatOfInput(Location(source.path));
    Estimates own = slamdb::EstimatesOf(atlas, source.path, format, reference.body, notices);
    Estimates truth = EstimatesOf(with, reference, notices);
    TellWhosePoses(own, truth, reference.body, notices);
    Estimate only = TakeOnly(std::move(truth));
    EvaluationReport report = EvaluateEstimates(std::move(own), only, evaluation);
    TellWarnings(report, notices);
    TellUnevaluated(report, notices);
    return {std::move(only.poses), std::move(report), only.open_scale ? "map units" : "m"};
  }

  std::string Do(Notices& notices) const {
    const auto atlas = ToShow(source, read, notices);
    PlotOptions plot = options;
    if (!source.path.empty()) plot.title = NameOf(Location(source.path));
    if (with.any()) plot.reference = HoldAgainst(*atlas, notices);
    std::string bytes = DrawPlot(*atlas, plot).bytes;
    output.Write(bytes);
    return bytes;
  }
};

Plotting PlottingOf(Arguments& given) {
  Plotting plotting{.source = given.SourceAt("source"), .with = given.SourceAt("with_"), .read = ReadingOf(given)};
  plotting.read.needs = Content::kPoses | Content::kPoints;
  plotting.read.features = FeatureColumns::kGeometry;
  TakeEvaluation(given, plotting.evaluation);
  plotting.evaluation.deltas.clear();  // errors of motions are not drawn
  plotting.reference = {.body = given.Get<bool>("body"),
                        .only_positions = plotting.evaluation.alignment != AlignmentKind::kOrigin};
  plotting.reference.read.of<TrajectoryReadOptions>() = TimesOf(given);
  PlotOptions& options = plotting.options;
  if (plotting.with.any()) options.kind = PlotKind::kTrajectory;
  given.TakeWord("kind", KindsOfPlots(), options.kind);
  if (plotting.with.any() && options.kind != PlotKind::kTrajectory)
    throw Error(ErrorKind::kUsage, "with_= is for kind='trajectory'");
  if (!plotting.with.any())
    given.RefuseIdle({"max_dt", "estimate_time_offset", "by_index", "time_unit", "times", "align", "joint", "body"},
                     "goes with with_= only");
  if (given.Has("picture"))
    given.TakeWord("picture", cli::kPlotFormats, options.format);
  else if (given.Has("output"))
    options.format = PlotFormatOf(TextOfPath(given.Get<py::object>("output")));
  given.Take("width", options.width, cli::kPlotWidth);
  given.Take("scale", options.scale, cli::kPlotScale);
  given.Take("dark", options.dark);
  given.Take("together", options.together);
  options.threads = given.threads();
  plotting.output = given.Output("output");
  return plotting;
}

void DefinePlot(py::module_& module) {
  module.def("plot", [](const py::dict& values) {
    Arguments given(values);
    const Plotting plotting = PlottingOf(given);
    given.RequireAllTaken();
    Notices notices;
    const std::string bytes = WithoutGil([&] { return plotting.Do(notices); });
    return py::make_tuple(py::bytes(bytes), ListOf(notices));
  });
}

struct Synthesizing {
  SyntheticOptions options;
  std::string vocabulary;
  OutputFile truth;

  std::string Do(Atlas& atlas) const {
    SyntheticSessions made = SynthesizeSessions(options);
    if (const auto loaded = VocabularyAt(vocabulary, options.threads))
      RecomputeWords(made.atlas, loaded->tree, loaded->identity, {.threads = options.threads});
    std::string rooms;
    for (const Similarity3d& room_from_map : made.room_from_map) rooms += ToText(room_from_map) + "\n";
    truth.Write(rooms);
    atlas = std::move(made.atlas);
    return "null";
  }
};

SyntheticOptions SyntheticOptionsOf(Arguments& given) {
  SyntheticOptions options;
  given.TakeWord("sensor", cli::kSensors, options.sensor);
  given.Take("inertial", options.inertial);
  given.Take("maps", options.maps, cli::kMapsMade);
  given.Take("keyframes", options.keyframes);
  given.Take("points", options.points);
  given.Take("features", options.features);
  given.Take("noise", options.pixel_noise, cli::kNonNegative);
  given.Take("outliers", options.outliers, cli::kShare);
  given.Take("flipped_bits", options.flipped_bits, cli::kBitsOfDescriptor);
  given.Take("seed", options.seed);
  SessionOptions sessions;
  given.Take("overlap", sessions.overlap, cli::kShare);
  given.Take("common", sessions.common, cli::kShare);
  given.Take("look_alike", sessions.look_alike);
  if (!given.Has("overlap")) given.RefuseIdle({"common"}, "goes with overlap= only");
  if (given.Has("size")) given.RefuseIdle({"keyframes", "points"}, "excludes size=");
  if (given.Has("overlap") || sessions.look_alike) options.sessions = sessions;
  if (given.Has("size")) ScaleTo(given.Get<std::uint64_t>("size"), options);
  given.TakeRun(options);
  return options;
}

void DefineSynthesize(py::module_& module) {
  DefineMaker(module, "synthesize", [](Arguments& given) {
    Synthesizing synthesizing{.options = SyntheticOptionsOf(given)};
    synthesizing.vocabulary = given.Path("vocabulary");
    synthesizing.truth = given.Output("truth");
    return [synthesizing](Atlas& atlas, Notices&) { return synthesizing.Do(atlas); };
  });
}

}  // namespace

void DefineOutputs(py::module_& module) {
  DefineConvert(module);
  DefinePlot(module);
  DefineSynthesize(module);
}

}  // namespace slamdb::python
