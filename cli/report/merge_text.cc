// SPDX-License-Identifier: BSD-3-Clause
#include "cli/report/merge_text.h"

#include <algorithm>

#include "cli/report/layout.h"
#include "cli/report/similarity.h"

namespace slamdb::cli {
namespace {

// "keyframe +186, point +44351", or nothing.
std::string ShiftText(const std::array<std::uint64_t, kIdKinds>& shifts) {
  std::string text;
  for (std::size_t kind = 0; kind < kIdKinds; ++kind)
    if (const auto shift = static_cast<std::int64_t>(shifts[kind]); shift != 0)
      text += (text.empty() ? "" : ", ") + std::string(NameOf(static_cast<IdKind>(kind))) + (shift > 0 ? " +" : " ") +
              std::to_string(shift);
  return text;
}

// That, and "camera 0 -> 1", or "kept".
std::string IdsText(const MergedInput& input) {
  std::string text = ShiftText(input.shift);
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
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
  for (const MergedInput& input : report.inputs) add(input.name, input.counts, IdsText(input));
  if (report.left_out.maps > 0) add("left out", report.left_out, "");
  add("result", report.result, "");
  if (report.result.landmarks + report.left_out.landmarks == 0) table.Drop(kLandmarksColumn);
  return table.ToString();
}

std::string LedgersTable(const ThreeWayReport& report) {
  using enum Table::Align;
  Table table({kLeft, kRight, kRight, kRight, kRight, kRight, kRight, kRight, kRight});
  table.Add({"", "base", "ours", "theirs", "added", "deleted", "fused", "dropped", "result"});
  const auto add = [&](const char* what, const BranchLedger& of) {
    table.Add({what, Grouped(of.base), Grouped(of.ours), Grouped(of.theirs),
               Grouped(of.added_by_ours + of.added_by_theirs + of.added_by_both),
               Grouped(of.deleted_by_ours + of.deleted_by_theirs + of.deleted_by_both), Grouped(of.fused),
               Grouped(of.dropped), Grouped(of.result)});
  };
  add("keyframes", report.keyframes);
  add("points", report.points);
  add("observations", report.observations);
  if (report.edges.base + report.edges.ours + report.edges.theirs > 0) add("loops and merges", report.edges);
  return table.ToString();
}

std::string MotionText(const MergedBranchMap& map, const BranchMotion& motion, BranchSide side) {
  if (motion.max == 0 && !motion.another_frame) return {};
  return "  " + std::string(NameOf(side)) + ": " + (motion.another_frame ? "moved into the other's frame, then " : "") +
         Counted(motion.common, "common keyframe") + " of " + ToString(map.map) + " shifted by " + Short(motion.rms) +
         " (root mean square), at most " + Short(motion.max) + "; " + Grouped(motion.carried) +
         " others carried along\n";
}

std::string ConflictsText(const std::vector<BranchConflict>& conflicts) {
  constexpr std::size_t kMostShown = 10;
  if (conflicts.empty()) return "no conflicts\n";
  std::string text = Counted(conflicts.size(), "conflict") + ":\n";
  for (std::size_t i = 0; i < std::min(kMostShown, conflicts.size()); ++i)
    text += "  " + ToString(conflicts[i].place) + ": " + MessageOf(conflicts[i]) + "\n";
  if (conflicts.size() > kMostShown)
    text += "  and " + Grouped(conflicts.size() - kMostShown) + " more, which --json lists\n";
  return text;
}

}  // namespace

std::string ThreeWayText(const ThreeWayReport& report) {
  if (report.same) return "both sides are the same: the result is " + report.names[1] + ", as it is\n";
  if (report.unchanged) {
    const bool is_ours = *report.unchanged == BranchSide::kOurs;
    return std::string(is_ours ? "ours" : "theirs") + " has not gone on from " + report.names[0] + ": the result is " +
           report.names[is_ours ? 2 : 1] + ", as it is\n";
  }
  if (report.contains) {
    const bool is_ours = *report.contains == BranchSide::kOurs;
    const std::string &all = report.names[is_ours ? 1 : 2], &part = report.names[is_ours ? 2 : 1];
    return all + " has all new keyframes of " + part + ", as after a merge: the result is " + all +
           ", as it is; what else " + part + " changed is not in it\n";
  }
  std::string text = LedgersTable(report);
  if (const std::string ids = ShiftText(report.shift); !ids.empty())
    text += "ids that " + report.names[2] + " made since the base: " + ids + "\n";
  std::uint64_t by_place = 0;
  for (const MergedBranchMap& map : report.maps) {
    text += MotionText(map, map.motion_of_ours, BranchSide::kOurs);
    text += MotionText(map, map.motion_of_theirs, BranchSide::kTheirs);
    by_place += map.fused ? map.fused->fused : 0;
    if (map.fused && map.fused->fused > 0)
      text += "  " + Counted(map.fused->fused, "new point") + " of theirs fused with those of ours, " +
              Short(map.fused->mean_distance) + " apart on average\n";
  }
  if (report.points.fused > by_place)
    text += "  " + Counted(report.points.fused - by_place, "point") +
            " fused with those that a side put in their place, or that the same keypoint sees\n";
  if (report.dangling > 0) text += Counted(report.dangling, "reference") + " that led nowhere cut\n";
  text += ConflictsText(report.conflicts);
  const std::uint64_t dropped = report.keyframes.dropped + report.points.dropped + report.observations.dropped;
  return text +
         (dropped == 0 ? "nothing was lost: "
                       : Counted(dropped, "thing") + " dropped for what conflicts with it, all else is there: ") +
         "keyframes, points, observations and edges of all three add up\n";
}

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
