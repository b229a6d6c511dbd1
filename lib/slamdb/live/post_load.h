// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/export.h"
#include "slamdb/model/ids.h"

namespace slamdb::live {

class KeyFrame;
class MapPoint;

// The references that are ids at rest and pointers in the live graph.
enum class LinkKind {
  kObservation,  // of a point, by a keyframe that is not there, or at a keypoint that it does not have
  kReference,    // a point's reference keyframe
  kReplacement,  // the point that replaces another
  kSlot,         // the point that a keypoint sees
  kConnection,
  kParent,
  kChild,
  kLoopEdge,
  kMergeEdge,
  kPrevious,
  kNext,
  kCamera,
  kRightCamera,
  kInitialKeyFrame,  // of a map
  kLowestKeyFrame,
  kOrigin,
};
inline constexpr std::size_t kLinkKinds = static_cast<std::size_t>(LinkKind::kOrigin) + 1;
SLAMDB_EXPORT std::string_view ToString(LinkKind kind);  // "observation", "reference keyframe", ...

// A reference whose target is not in the map. The graph goes without it; a save writes it as it was.
struct DanglingLink {
  LinkKind kind;
  MapId map;
  KeyFrameId keyframe;  // which has it; none: the point, or the map itself
  MapPointId point;
  std::uint64_t target = 0;  // the id
  friend bool operator==(const DanglingLink&, const DanglingLink&) = default;
};

// What was not whole in an atlas that was brought to life. Everything else is.
struct SLAMDB_EXPORT PostLoadReport {
  static constexpr std::size_t kMostExamples = 100;

  std::array<std::uint64_t, kLinkKinds> counts{};
  std::vector<DanglingLink> examples;  // the first of them, by map, keyframes before points, in list order
  std::uint64_t bad_keyframes = 0;     // listed though culled: they are in the graph, flagged and without links
  std::uint64_t bad_points = 0;        // likewise
  std::uint64_t duplicate_ids = 0;     // of keyframes and points in one map: links go to the first of equals

  // One past the highest ids that dangle: new objects get ids from there on, not those of others that are missing.
  std::uint64_t keyframe_floor = 0, point_floor = 0;

  double seconds = 0;  // that finding the targets took

  std::uint64_t operator[](LinkKind kind) const { return counts[static_cast<std::size_t>(kind)]; }
  std::uint64_t dangling() const;
  bool whole() const { return dangling() + bad_keyframes + bad_points + duplicate_ids == 0; }

  void Add(const DanglingLink& link);
  void Append(const PostLoadReport& later);
  std::string ToString() const;  // for people: a line for each kind that occurs; "whole" when none does
};

}  // namespace slamdb::live
