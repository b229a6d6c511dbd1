// SPDX-License-Identifier: BSD-3-Clause
#include "cli/report/merge_text.h"

#include <algorithm>

#include "cli/report/layout.h"
#include "cli/report/similarity.h"

namespace slamdb::cli {
namespace {

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

}  // namespace

std::string JoinText(const JoinReport& join) {
  const std::string moved = SimilarityText(join.first_from_second);
  std::string text = "joined " + ToString(join.second) + " into " + ToString(join.first) +
                     (moved == "nothing" ? ", as they lie" : ": " + moved) + "\n";
  if (join.fit)
    text += "  anchors fit within " + Short(join.fit->rms) + " (root mean square), at most " + Short(join.fit->max) +
            "; " + Grouped(static_cast<std::uint64_t>(std::ranges::count(join.fit->inliers, 1))) + " of " +
            Counted(join.fit->inliers.size(), "was used", "were used") + "\n";
  if (join.link.first)
    text += "  " + Counted(join.keyframes, "keyframe") + " and " + Counted(join.points, "point") + " changed map; " +
            ToString(join.link.second) + " hangs on " + ToString(join.link.first) + ", " + Short(join.link_distance) +
            " away, by a merge edge\n";
  if (join.fused)
    text += "  " + Counted(join.fused->fused, "point") + " fused, " + Short(join.fused->mean_distance) +
            " apart on average; " + Counted(join.fused->observations, "observation") + " moved, covisibility of " +
            Counted(join.fused->keyframes, "keyframe") + " counted anew\n";
  if (join.landmarks > 0)
    text += "  " + Counted(join.landmarks, "landmark") + " changed map, of which " + Grouped(join.fused_landmarks) +
            (join.fused_landmarks == 1 ? " was fused" : " were fused") +
            (join.alike && join.alike->fused > 0 ? ", " + Short(join.alike->mean_distance) + " apart on average" : "") +
            "\n";
  if (join.alike && join.alike->plain > 0)
    text += "  " + Counted(join.alike->plain, "landmark") + " without a descriptor not compared\n";
  if (join.alike && join.alike->unplaced > 0)
    text += "  " + Counted(join.alike->unplaced, "landmark") + " without covariance not compared\n";
  return text;
}

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

}  // namespace slamdb::cli
