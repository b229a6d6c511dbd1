// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

#include "slamdb/base/notices.h"
#include "slamdb/model/atlas.h"

namespace slamdb::detail {

// Makes an atlas that ORB-SLAM3 can load of what a format of another program holds: fills what its reader left empty,
// as ORB-SLAM3 derives it from what is there. What the reader has set stays as it is.
//
//   keyframes with keypoints  inverse focal lengths, calibration matrix; keypoints as detected or undistorted, one from
//                             the other; right_x and depth (-1); rows for points; a pyramid of 8 levels of 1.2; bounds
//                             that hold all keypoints; the grid
//   observations              of points by what keyframes say, where no point has any; the other way round, where no
//                             keyframe sees any point. Further keypoints of one picture that are the same point are
//                             freed
//   points                    observation count, descriptor (MatrixForm::kEmpty), normal, distance range, reference and
//                             first keyframe
//   graph                     covisibility, where no keyframe has any; one spanning tree; keyframes with loop or merge
//                             edges are kept from culling
//   maps, atlas               root, origins, lowest and largest ids, counters
//
// Says in one note what was derived, and what nothing here can make. `program` is whose file it was: `RTAB-Map`.
//
// Cost: that of ORB-SLAM3's UpdateConnections for every keyframe. `threads` 0: every core. Throws nothing.
void CompleteAtlas(Atlas& atlas, std::string_view program, int threads, Notices& notices);

// The bounds of an image without distortion, and ORB-SLAM3's grid of 64 x 48 cells over it.
ImageBounds BoundsOfImage(std::int32_t width, std::int32_t height);

// Sets focal lengths and principal point, pixels, with all that follows from them.
void SetPinhole(KeyFrame& keyframe, float fx, float fy, float cx, float cy);

}  // namespace slamdb::detail
