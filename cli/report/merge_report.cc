// SPDX-License-Identifier: BSD-3-Clause
#include "cli/report/merge_report.h"

#include <algorithm>

#include "cli/report/json.h"
#include "cli/report/layout.h"
#include "cli/report/similarity.h"

namespace slamdb::cli {
namespace {

using nlohmann::ordered_json;

struct CountName {
  const char* name;
  std::uint64_t ContentCounts::*field;
};
constexpr CountName kCounts[] = {
    {"maps", &ContentCounts::maps},
    {"keyframes", &ContentCounts::keyframes},
    {"points", &ContentCounts::points},
    {"cameras", &ContentCounts::cameras},
    {"features", &ContentCounts::features},
    {"observations", &ContentCounts::observations},
    {"slots", &ContentCounts::slots},
    {"connections", &ContentCounts::connections},
    {"parents", &ContentCounts::parents},
    {"children", &ContentCounts::children},
    {"loop_edges", &ContentCounts::loop_edges},
    {"merge_edges", &ContentCounts::merge_edges},
    {"temporal_links", &ContentCounts::temporal_links},
    {"references", &ContentCounts::references},
    {"landmarks", &ContentCounts::landmarks},
};

std::int64_t ShiftOf(const MergedInput& input, IdKind kind) {
  return static_cast<std::int64_t>(input.shift[static_cast<std::size_t>(kind)]);
}

// "keyframe +186, point +44351; camera 0 is 0", or "ids kept".
std::string ShiftText(const MergedInput& input) {
  std::string text;
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  for (std::size_t kind = 0; kind < kIdKinds; ++kind)
    if (const std::int64_t shift = ShiftOf(input, static_cast<IdKind>(kind)); shift != 0)
      add(std::string(NameOf(static_cast<IdKind>(kind))) + (shift > 0 ? " +" : " ") + std::to_string(shift));
  for (const IdPair& camera : input.cameras)
    if (camera.before != camera.after)
      add("camera " + std::to_string(camera.before) + " -> " + std::to_string(camera.after));
  return text.empty() ? "kept" : text;
}

std::string InputsTable(const MergeReport& report) {
  using enum Table::Align;
  constexpr std::size_t kLandmarksColumn = 5;
  Table table({kLeft, kRight, kRight, kRight, kRight, kRight, kLeft});
  table.Add({"input", "maps", "keyframes", "points", "observations", "landmarks", "ids"});
  const auto add = [&](const std::string& name, const ContentCounts& counts, const std::string& ids) {
    table.Add({name, Grouped(counts.maps), Grouped(counts.keyframes), Grouped(counts.points),
               Grouped(counts.observations), Grouped(counts.landmarks), ids});
  };
  for (const MergedInput& input : report.inputs) add(input.name, input.counts, ShiftText(input));
  if (report.left_out.maps > 0) add("left out", report.left_out, "");
  add("result", report.result, "");
  if (report.result.landmarks + report.left_out.landmarks == 0) table.Drop(kLandmarksColumn);
  return table.ToString();
}

ordered_json CountsJson(const ContentCounts& counts) {
  ordered_json json;
  for (const CountName& count : kCounts) json[count.name] = counts.*count.field;
  return json;
}

ordered_json InputJson(const MergedInput& input) {
  ordered_json shift, cameras = ordered_json::array();
  for (std::size_t kind = 0; kind < kIdKinds; ++kind)
    if (const auto as_kind = static_cast<IdKind>(kind); as_kind != IdKind::kCamera)
      shift[std::string(NameOf(as_kind))] = ShiftOf(input, as_kind);
  for (const IdPair& camera : input.cameras) cameras.push_back({{"old", camera.before}, {"new", camera.after}});
  return {{"input", input.name}, {"counts", CountsJson(input.counts)}, {"shift", shift}, {"cameras", cameras}};
}

// What the transform, the anchors and the fusion came to.
std::string JoinText(const JoinReport& join) {
  std::string text = "joined " + ToString(join.second) + " into " + ToString(join.first) + ": " +
                     SimilarityText(join.first_from_second) + "\n";
  if (join.fit)
    text += "  anchors fit within " + Short(join.fit->rms) + " (root mean square), at most " + Short(join.fit->max) +
            "; " + Grouped(static_cast<std::uint64_t>(std::ranges::count(join.fit->inliers, 1))) + " of " +
            Counted(join.fit->inliers.size(), "was used", "were used") + "\n";
  text += "  " + Counted(join.keyframes, "keyframe") + " and " + Counted(join.points, "point") + " changed map; " +
          ToString(join.link.second) + " hangs on " + ToString(join.link.first) + ", " + Short(join.link_distance) +
          " away, by a merge edge\n";
  if (join.fused)
    text += "  " + Counted(join.fused->fused, "point") + " fused, " + Short(join.fused->mean_distance) +
            " apart on average; " + Counted(join.fused->observations, "observation") + " moved, covisibility of " +
            Counted(join.fused->keyframes, "keyframe") + " counted anew\n";
  if (join.fused_landmarks > 0) text += "  " + Counted(join.fused_landmarks, "landmark") + " fused\n";
  return text;
}

ordered_json JoinJson(const JoinReport& join) {
  ordered_json json = {
      {"map", join.first.value()},
      {"first_from_second", SimilarityJson(join.first_from_second)},
      {"link",
       {{"first", join.link.first.value()}, {"second", join.link.second.value()}, {"distance", join.link_distance}}},
      {"keyframes", join.keyframes},
      {"points", join.points},
      {"left_inertial", join.left_inertial},
      {"warnings", join.warnings}};
  if (join.fit) {
    auto inliers = ordered_json::array();
    for (const std::uint8_t inlier : join.fit->inliers) inliers.push_back(inlier != 0);
    json["fit"] = {
        {"rms", join.fit->rms}, {"max", join.fit->max}, {"residuals", join.fit->residuals}, {"inliers", inliers}};
  }
  if (join.fused)
    json["fused"] = {{"candidates", join.fused->candidates},       {"points", join.fused->fused},
                     {"seen_together", join.fused->seen_together}, {"observations", join.fused->observations},
                     {"cleared_slots", join.fused->cleared_slots}, {"keyframes", join.fused->keyframes},
                     {"mean_distance", join.fused->mean_distance}};
  json["fused_landmarks"] = join.fused_landmarks;
  return json;
}

}  // namespace

std::string MergeText(const MergeReport& report) {
  std::string text = InputsTable(report);
  for (const MapTwice& twice : report.same_maps)
    text += ToString(twice.map) + " of " + report.inputs[twice.input].name + " is " + ToString(twice.first_map) +
            " of " + report.inputs[twice.first_input].name +
            " again: " + (twice.left_out ? "left out" : "kept as a copy") + "\n";
  if (report.left_out.cameras > 0)
    text += Counted(report.left_out.cameras, "camera") + " unified with the same one of an earlier input\n";
  if (report.dropped_list_entries > 0)
    text += Counted(report.dropped_list_entries, "null pointer or repetition", "null pointers and repetitions") +
            " in lists dropped\n";
  text += "nothing was lost: maps, keyframes, points, features, observations and edges add up\n";
  return report.join ? text + JoinText(*report.join) : text;
}

std::string MergeJson(const MergeReport& report, const std::string& output) {
  ordered_json json = {{"output", output},
                       {"inputs", ordered_json::array()},
                       {"same_maps", ordered_json::array()},
                       {"dropped_list_entries", report.dropped_list_entries},
                       {"other_vocabularies", report.other_vocabularies},
                       {"left_out", CountsJson(report.left_out)},
                       {"result", CountsJson(report.result)}};
  for (const MergedInput& input : report.inputs) json["inputs"].push_back(InputJson(input));
  for (const MapTwice& twice : report.same_maps)
    json["same_maps"].push_back({{"input", report.inputs[twice.input].name},
                                 {"map", twice.map.value()},
                                 {"first_input", report.inputs[twice.first_input].name},
                                 {"first_map", twice.first_map.value()},
                                 {"left_out", twice.left_out}});
  if (report.join) json["join"] = JoinJson(*report.join);
  return JsonText(json);
}

}  // namespace slamdb::cli
