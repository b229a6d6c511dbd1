// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "slamdb/export.h"
#include "slamdb/model/atlas.h"

// What keyframes and points say of each other, set on both sides.
//
// Each function throws Error (kUsage) that names the row and what it should be, and then changes nothing.
// Cost: linear in the map.
namespace slamdb {

// From one keyframe to another.
using KeyFrameEdge = std::pair<KeyFrameId, KeyFrameId>;

// Gives keyframes (first) other parents (second) in the spanning tree; children follow.
//
// Throws Error (kUsage) when one is not in the map, is its own ancestor then, or is the root.
SLAMDB_EXPORT void SetParents(Map& map, std::span<const KeyFrameEdge> parents);

enum class EdgeKind { kLoop, kMerge };

// Adds loop or merge edges, each to both of its keyframes, which must not be culled from then on.
// Returns how many were new.
//
// Throws Error (kUsage) when a keyframe is not in the map, or an edge leads from one to itself.
SLAMDB_EXPORT std::uint64_t AddEdges(Map& map, EdgeKind kind, std::span<const KeyFrameEdge> edges);

// The edges of a map, each once, the smaller id first, ascending; those that lead out of the map are left out.
[[nodiscard]] SLAMDB_EXPORT std::vector<KeyFrameEdge> EdgesOf(const Map& map, EdgeKind kind);

// ORB-SLAM3's essential graph in the same way: the spanning tree, loop and merge edges, covisibility of at least that
// weight, and with an IMU what follows in time.
[[nodiscard]] SLAMDB_EXPORT std::vector<KeyFrameEdge> EssentialEdges(const Map& map, int min_weight = 100);

// Gives points another reference keyframe, by which their distance ranges follow.
//
// Throws Error (kUsage) when a point is not in the map, or a keyframe does not observe its point.
SLAMDB_EXPORT void SetReferences(Map& map, std::span<const std::pair<MapPointId, KeyFrameId>> references);

// "That point is keypoint `keypoint` of that keyframe". Of a fisheye pair the keypoints of the right picture stand
// behind those of the left one.
struct PointObservation {
  MapPointId point;
  KeyFrameId keyframe;
  std::uint64_t keypoint = 0;
};

// Adds observations of points that the map has, on both sides. What follows for these as in UpdatePoints, and the
// covisibility of all that see them; keyframes that were covisible with none before get a parent as in AddPoints.
//
// Throws Error (kUsage) when a point, keyframe or keypoint is not there, a keypoint is a point already, or a point two
// keypoints of one picture.
SLAMDB_EXPORT void AddObservations(Map& map, std::span<const PointObservation> added);

// What follows for the points in `rows` from where they are and what sees them: observation counts, normals, distance
// ranges and most distinctive descriptors, as ORB-SLAM3's UpdateNormalAndDepth and ComputeDistinctiveDescriptors.
//
// Throws Error (kUsage) when there is no such row.
SLAMDB_EXPORT void UpdatePoints(Map& map, std::span<const std::uint32_t> rows);

// Counts covisibility of all keyframes anew, as ORB-SLAM3's UpdateConnections. Parents stay.
SLAMDB_EXPORT void UpdateConnections(Map& map);

}  // namespace slamdb
