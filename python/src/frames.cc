// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "cli/choices.h"
#include "python/src/estimates.h"
#include "python/src/module.h"
#include "python/src/verb.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/frame/axes.h"
#include "slamdb/edit/frame/similarity_text.h"
#include "slamdb/edit/frame/transform_atlas.h"
#include "slamdb/model/geodetic.h"

// Verbs that move maps. slamdb/frames.py documents what is here.
namespace slamdb::python {

namespace py = pybind11;

namespace {

// Where to: one of these.
struct Way {
  std::string by, axes, georeference, origin;
  std::optional<double> scale;
  std::optional<std::optional<UpMethod>> gravity;
  AtlasOrPath onto;
  EstimatesOptions reference;
  FitOptions fit;

  Destination Find(Notices& notices) const {
    if (!by.empty()) return ReadSimilarity(by);
    if (scale) return Similarity3d{.scale = *scale};
    if (!axes.empty()) return Similarity3d{.rotation = ParseAxes(axes)};
    if (gravity) return TurnUpright{*gravity};
    if (onto.any()) return OntoTrajectory{PositionsOf(EstimatesOf(onto, reference, notices)), fit};
    OntoEarth earth{.fixes = ReadRecordedFixes(georeference, {.time_unit = TimeUnitOf(reference.read)}, &notices),
                    .fit = fit};
    if (!origin.empty()) earth.origin = ParseGeodetic(origin);
    return earth;
  }

  static std::optional<TimeUnit> TimeUnitOf(ReadOptions read) { return read.of<TrajectoryReadOptions>().time_unit; }
};

FitOptions FitOf(Arguments& given) {
  FitOptions fit;
  given.Take("max_dt", fit.max_time_difference, cli::kNonNegative);
  given.Take("robust", fit.outlier_distance, cli::kPositive);
  given.Take("time_offset", fit.time_offset, cli::kFinite);
  given.Take("estimate_time_offset", fit.estimate_time_offset);
  given.Take("body", fit.body);
  const bool with_scale = given.Get<bool>("with_scale"), without_scale = given.Get<bool>("without_scale");
  if (with_scale && without_scale) throw Error(ErrorKind::kUsage, "with_scale= and without_scale= exclude each other");
  if (with_scale || without_scale) fit.with_scale = with_scale;
  return fit;
}

// How positions are paired matters where there are some.
void RefuseIdle(const Way& way, Arguments& given) {
  if (way.georeference.empty()) given.RefuseIdle({"origin"}, "is for georeference= only");
  if (way.onto.any() || !way.georeference.empty()) return;
  const std::string why = "is for onto= and georeference= only";
  given.RefuseIdle(
      {"max_dt", "robust", "estimate_time_offset", "body", "with_scale", "without_scale", "time_unit", "times"}, why);
  if (way.fit.time_offset != 0) given.RefuseIdle({"time_offset"}, why);
}

Way WayOf(Arguments& given) {
  Way way{.by = given.Path("by"), .georeference = given.Path("georeference")};
  given.Take("axes", way.axes);
  given.Take("origin", way.origin);
  given.Take("scale", way.scale);
  given.TakeWord("gravity", cli::kUpMethods, way.gravity);
  way.onto = given.SourceAt("onto");
  way.fit = FitOf(given);
  way.reference = {.body = way.fit.body, .only_positions = true};
  way.reference.read.of<TrajectoryReadOptions>() = TimesOf(given);
  const int ways = !way.by.empty() + !way.axes.empty() + !way.georeference.empty() + way.scale.has_value() +
                   way.gravity.has_value() + way.onto.any();
  if (ways != 1) throw Error(ErrorKind::kUsage, "give one of by=, scale=, axes=, gravity=, onto= and georeference=");
  RefuseIdle(way, given);
  return way;
}

}  // namespace

void DefineFrames(py::module_& module) {
  DefineChange(module, "transform", [](Arguments& given) {
    TransformOptions options;
    given.TakeIds("map", options.maps);
    given.TakeRun(options);
    return [options, way = WayOf(given)](Atlas& atlas, Notices& notices) {
      TransformOptions transform = options;
      transform.to = way.Find(notices);
      const TransformReport report = TransformAtlas(atlas, transform);
      TellWarnings(report, notices);
      return ToJson(report);
    };
  });
}

}  // namespace slamdb::python
