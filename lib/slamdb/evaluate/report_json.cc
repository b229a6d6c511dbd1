// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/evaluate/evaluate.h"
#include "slamdb/model/detail/json.h"

namespace slamdb {
namespace {

using detail::Json;

Json JsonOf(const ErrorStatistics& statistics) {
  return {{"count", statistics.count},   {"rmse", statistics.rmse}, {"mean", statistics.mean},
          {"median", statistics.median}, {"std", statistics.std},   {"min", statistics.min},
          {"max", statistics.max},       {"sse", statistics.sse},   {"p25", statistics.p25},
          {"p75", statistics.p75},       {"p90", statistics.p90},   {"p95", statistics.p95},
          {"p99", statistics.p99}};
}

// What absolute and relative errors have both.
template <class Errors>
void AddStatistics(const Errors& errors, Json& json) {
  json["translation"] = JsonOf(errors.translation);
  json["rotation_degrees"] = JsonOf(errors.rotation_degrees);
  json["rotation_part"] = JsonOf(errors.rotation_part);
  json["full_transformation"] = JsonOf(errors.full_transformation);
}

Json JsonOf(const AppliedAlignment& alignment) {
  return {{"kind", NameOf(alignment.kind)},
          {"reference_from_estimate", detail::JsonOf(alignment.reference_from_estimate)},
          {"pairs", alignment.pairs},
          {"on_line", alignment.on_line}};
}

Json JsonOf(const TrajectoryCoverage& coverage) {
  Json gaps = Json::array();
  for (const CoverageGap& gap : coverage.gaps)
    gaps.push_back({{"begin_time", gap.begin_time}, {"end_time", gap.end_time}, {"trajectory_length", gap.length}});
  const auto side = [](std::size_t poses, double begin, double end, double length) -> Json {
    return {{"poses", poses}, {"begin_time", begin}, {"end_time", end}, {"trajectory_length", length}};
  };
  return {{"pairs", coverage.pairs},
          {"estimate",
           side(coverage.estimate_poses, coverage.estimate_begin, coverage.estimate_end, coverage.estimate_length)},
          {"reference",
           side(coverage.reference_poses, coverage.reference_begin, coverage.reference_end, coverage.reference_length)},
          {"largest_time_difference", coverage.largest_time_difference},
          {"paired_share", coverage.paired_share()},
          {"duration_share", coverage.duration_share()},
          {"length_share", coverage.length_share()},
          {"gap_limit", coverage.gap_limit},
          {"gaps", gaps}};
}

std::string_view NameOf(DeltaUnit unit) {
  switch (unit) {
    case DeltaUnit::kFrames:
      return "frames";
    case DeltaUnit::kMetres:
      return "m";
    case DeltaUnit::kSeconds:
      return "s";
    case DeltaUnit::kDegrees:
      break;
  }
  return "degrees";
}

Json JsonOf(const Eigen::Quaterniond& rotation) { return {rotation.x(), rotation.y(), rotation.z(), rotation.w()}; }

Json JsonOf(const PairedPose& pose) {
  return {{"timestamp", pose.timestamp},
          {"reference_timestamp", pose.reference_timestamp},
          {"position", detail::JsonOf(pose.position)},
          {"rotation_xyzw", JsonOf(pose.rotation)},
          {"reference_position", detail::JsonOf(pose.reference_position)},
          {"reference_rotation_xyzw", JsonOf(pose.reference_rotation)},
          {"translation", pose.translation_error},
          {"rotation_degrees", pose.rotation_error_degrees}};
}

Json JsonOf(const RelativeErrors& relative, bool with_errors) {
  Json json = {{"delta", {{"value", relative.delta.value}, {"unit", NameOf(relative.delta.unit)}}}};
  AddStatistics(relative, json);
  json["point_distance"] = JsonOf(relative.point_distance);
  json["point_distance_ratio_percent"] = JsonOf(relative.point_distance_ratio);
  if (!with_errors) return json;
  Json& list = json["poses"] = Json::array();
  for (const RelativeError& error : relative.errors)
    list.push_back({{"from", error.from},
                    {"to", error.to},
                    {"translation", error.translation},
                    {"rotation_degrees", error.rotation_degrees}});
  return json;
}

Json JsonOf(const TrajectoryEvaluation& evaluation, bool with_errors) {
  Json json;
  json["maps"] = Json::array();
  for (const MapId map : evaluation.maps) json["maps"].push_back(detail::JsonId(map));
  json["alignment"] = JsonOf(evaluation.alignment);
  json["time_offset"] = evaluation.time_offset;
  json["coverage"] = JsonOf(evaluation.coverage);
  AddStatistics(evaluation.absolute, json["absolute"]);
  json["relative"] = Json::array();
  for (const RelativeErrors& relative : evaluation.relative) json["relative"].push_back(JsonOf(relative, with_errors));
  if (with_errors) {
    Json& list = json["poses"] = Json::array();
    for (const PairedPose& pose : evaluation.poses) list.push_back(JsonOf(pose));
  }
  json["warnings"] = evaluation.warnings;
  return json;
}

}  // namespace

std::string ToJson(const EvaluationReport& report, const EvaluationReportOptions& options) {
  Json json = detail::ReportHead("evaluate", options.input);
  json["reference"] = detail::TextOrNull(options.reference);
  json["evaluations"] = Json::array();
  for (const TrajectoryEvaluation& evaluation : report.evaluations)
    json["evaluations"].push_back(JsonOf(evaluation, options.with_errors));
  json["unevaluated"] = Json::array();
  for (const UnevaluatedMap& map : report.unevaluated)
    json["unevaluated"].push_back({{"map", detail::JsonId(map.map)}, {"reason", map.reason}});
  json["breaches"] = options.breaches;
  return detail::JsonText(json);
}

}  // namespace slamdb
