// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>

#include "slamdb/model/atlas.h"

// The steps of CompleteAtlas.
namespace slamdb::detail {

// What was derived: how many of each kind.
struct Completed {
  std::uint64_t observations = 0;  // of points, by what keyframes say
  std::uint64_t slots = 0;         // keypoints that see a point, by what points say
  std::uint64_t freed = 0;         // keypoints of a point that another keypoint of the picture is already
  std::atomic<std::uint64_t> grids = 0, descriptors = 0, normals = 0, ranges = 0, references = 0;
  std::uint64_t connections = 0, parents = 0;
};

// All that concerns a keyframe and its features alone.
void CompleteFeatures(KeyFrame& keyframe, Completed& completed);

// Observations and slots, then what follows from them for each point.
void CompletePoints(Map& map, int threads, Completed& completed);
// The latter alone, of the points from row `first` on.
void SummarizePoints(Map& map, std::size_t first, int threads, Completed& completed);

// The root of the spanning tree: what is recorded, or the lowest id of those without a parent, or the lowest of all.
KeyFrameId RootOf(const Map& map);

// The initial, origin and lowest keyframes, and the largest id.
void CompleteIds(Map& map);

}  // namespace slamdb::detail
