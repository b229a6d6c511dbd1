// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/live/post_load.h"

#include <algorithm>
#include <numeric>

namespace slamdb::live {
namespace {

// What the target of a link is; a keyframe otherwise.
bool IsOfCamera(LinkKind kind) { return kind == LinkKind::kCamera || kind == LinkKind::kRightCamera; }
bool IsOfPoint(LinkKind kind) { return kind == LinkKind::kSlot || kind == LinkKind::kReplacement; }

}  // namespace

std::string_view ToString(LinkKind kind) {
  constexpr std::array<std::string_view, kLinkKinds> kNames = {
      "observation",   "reference keyframe", "replacement",     "feature slot", "connection", "parent",
      "child",         "loop edge",          "merge edge",      "previous",     "next",       "camera",
      "second camera", "initial keyframe",   "lowest keyframe", "origin"};
  return kNames[static_cast<std::size_t>(kind)];
}

std::uint64_t PostLoadReport::dangling() const {
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

void PostLoadReport::Add(const DanglingLink& link) {
  ++counts[static_cast<std::size_t>(link.kind)];
  constexpr std::uint64_t kLargestId = (std::uint64_t{1} << 31) - 1;  // more is uninitialised memory
  if (link.target <= kLargestId && !IsOfCamera(link.kind)) {
    std::uint64_t& floor = IsOfPoint(link.kind) ? point_floor : keyframe_floor;
    floor = std::max(floor, link.target + 1);
  }
  if (examples.size() < kMostExamples) examples.push_back(link);
}

void PostLoadReport::Append(const PostLoadReport& later) {
  for (std::size_t i = 0; i < kLinkKinds; ++i) counts[i] += later.counts[i];
  const std::size_t room = kMostExamples - examples.size();
  examples.insert(examples.end(), later.examples.begin(),
                  later.examples.begin() + static_cast<std::ptrdiff_t>(std::min(room, later.examples.size())));
  bad_keyframes += later.bad_keyframes;
  bad_points += later.bad_points;
  duplicate_ids += later.duplicate_ids;
  keyframe_floor = std::max(keyframe_floor, later.keyframe_floor);
  point_floor = std::max(point_floor, later.point_floor);
}

std::string PostLoadReport::ToString() const {
  if (whole()) return "whole\n";
  std::string text;
  const auto line = [&](std::uint64_t count, std::string_view what) {
    if (count > 0) text += std::to_string(count) + " " + std::string(what) + "\n";
  };
  for (std::size_t i = 0; i < kLinkKinds; ++i)
    line(counts[i], "dangling: " + std::string(live::ToString(static_cast<LinkKind>(i))));
  line(bad_keyframes, "bad keyframes in the lists");
  line(bad_points, "bad points in the lists");
  line(duplicate_ids, "duplicate ids");
  return text;
}

}  // namespace slamdb::live
