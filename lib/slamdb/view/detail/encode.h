// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "slamdb/view/detail/columns.h"
#include "slamdb/view/detail/scene.h"

// The scene as columns. Each function leaves out columns that have nothing to say; see schema/view.md.
namespace slamdb::view {

struct PointColumns {
  Columns columns;
  double error_max = 0;  // pixels of the largest value of points/error
};
PointColumns EncodePoints(const Scene& scene, bool normals, int threads);

struct KeyFrameColumns {
  Columns columns;
  double origin_of_time = 0;  // seconds, the earliest keyframe's
};
KeyFrameColumns EncodeKeyFrames(const Scene& scene);

// Covisibility, loop and merge edges.
Columns EncodeEdges(const Scene& scene);

// The keypoints of left cameras, all or those that see a point of their map.
struct KeypointCounts {
  std::uint64_t all = 0, matched = 0;
};
KeypointCounts CountKeypoints(const Scene& scene, int threads);
Columns EncodeKeypoints(const Scene& scene, bool matched_only, int threads);

Columns EncodeDiff(const SceneDiff& diff);

}  // namespace slamdb::view
