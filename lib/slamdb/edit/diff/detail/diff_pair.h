// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "slamdb/edit/diff/detail/diff_match.h"
#include "slamdb/edit/diff/detail/diff_same.h"

// How the entities of a pair differ: the second half of DiffAtlases.
namespace slamdb::detail {

enum KeyFrameAspect : std::size_t {
  kPose,
  kTime,
  kCalibration,
  kFeatures,
  kLostFeatures,
  kBagOfWords,
  kInertial,
  kState,
  kOriginMap,
  kCarriedByKeyFrame,
  kKeyFrameAspects
};
inline constexpr std::array<std::string_view, kKeyFrameAspects> kKeyFrameAspectNames = {
    "pose",         "time",          "camera and calibration", "features",   "features lost",
    "bag of words", "inertial data", "flags and state",        "origin map", "members of a fork"};

enum PointAspect : std::size_t {
  kPosition,
  kNormal,
  kDistances,
  kDescriptor,
  kObservationCount,
  kReference,
  kReplacement,
  kBad,
  kFirstKeyFrame,
  kPointOrigin,
  kFrameCounts,
  kCarriedByPoint,
  kPointAspects
};
inline constexpr std::array<std::string_view, kPointAspects> kPointAspectNames = {
    "position",    "normal",   "distance range", "descriptor", "observation count",        "reference keyframe",
    "replacement", "bad flag", "first keyframe", "origin map", "visible and found counts", "members of a fork"};

enum MapAspect : std::size_t { kFlags, kBigChange, kRoots, kCarriedByMap, kMapAspects };
inline constexpr std::array<std::string_view, kMapAspects> kMapAspectNames = {
    "inertial flags", "count of big changes", "initial, lowest and origin keyframes", "members of a fork"};

enum CameraAspect : std::size_t { kParameters, kCameraAspects };
inline constexpr std::array<std::string_view, kCameraAspects> kCameraAspectNames = {"parameters"};

enum LinkKind : std::size_t {
  kObservations,
  kSlots,
  kCovisibility,
  kParents,
  kChildren,
  kLoops,
  kMerges,
  kInTime,
  kLinkKinds
};
inline constexpr std::array<std::string_view, kLinkKinds> kLinkNames = {
    "observations", "slots", "covisibility", "parents", "children", "loop edges", "merge edges", "previous and next"};

struct LinkCounts {
  std::uint32_t removed = 0, added = 0, changed = 0;
  // A reference that is not the same, by whether there is one before and after.
  void Count(bool before, bool after) { ++(before && after ? changed : before ? removed : added); }
};

// How a pair differs.
struct PairDiff {
  std::uint32_t aspects = 0;  // bits
  bool renumbered = false, other_ids = false;
  float distance = 0;  // of what moved

  void Note(std::size_t aspect, bool same) {
    if (!same) aspects |= 1U << aspect;
  }
  bool Has(std::size_t aspect) const { return (aspects >> aspect & 1) != 0; }
};
struct KeyFramePairDiff : PairDiff {
  float degrees = 0;
  std::array<LinkCounts, kLinkKinds> links;
};
struct PointPairDiff : PairDiff {
  LinkCounts observations;
};

// Compares pairs field by field, and references by where they lead. Const, and so safe to share between threads.
class PairComparison {
 public:
  PairComparison(const NumberedAtlas& before, const NumberedAtlas& after, const AtlasPairing& pairing, Sameness same)
      : before_(before), after_(after), pairing_(pairing), same_(same) {}

  // By number in the atlas before; nothing differs where there is no partner.
  KeyFramePairDiff CompareKeyFrame(std::uint32_t n) const;
  PointPairDiff ComparePoint(std::uint32_t n) const;
  PairDiff CompareMap(std::uint32_t row) const;
  PairDiff CompareCamera(std::uint32_t row) const;

 private:
  bool SameKeyFrame(std::uint32_t map_a, KeyFrameId a, std::uint32_t map_b, KeyFrameId b) const;
  bool SamePoint(std::uint32_t map_a, MapPointId a, std::uint32_t map_b, MapPointId b) const;
  bool SameCamera(CameraId a, CameraId b) const;
  bool SameOrigin(std::uint32_t a, std::uint32_t b) const;
  bool SameCalibration(const KeyFrame& a, const KeyFrame& b) const;
  void CompareEdges(std::uint32_t n, std::uint32_t partner, KeyFramePairDiff& diff) const;
  void CompareSlots(std::uint32_t n, std::uint32_t partner, LinkCounts& slots) const;
  void CompareObservations(std::uint32_t n, std::uint32_t partner, LinkCounts& observations) const;
  void CompareFirst(std::uint32_t n, std::uint32_t partner, PairDiff& diff) const;
  std::uint64_t TargetBefore(std::uint32_t map, KeyFrameId id) const;
  std::uint64_t TargetAfter(std::uint32_t map, KeyFrameId id) const;

  const NumberedAtlas &before_, &after_;
  const AtlasPairing& pairing_;
  const Sameness same_;
};

}  // namespace slamdb::detail
