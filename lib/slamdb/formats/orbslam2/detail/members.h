// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/orbslam2/detail/archive.h"
#include "slamdb/model/keyframe.h"
#include "slamdb/model/map_point.h"

// Members of objects that are no pointers, in runs as they stand between those that are. Numbers that can be no pose,
// point or camera are refused.
namespace slamdb::orbslam2 {

// `next_id`: raised to the static member that the file records.
void TakePointHead(Archive& archive, MapPoint& point, std::uint64_t& next_id);
void TakePointMatrices(Archive& archive, MapPoint& point);

void TakeKeyFrameHead(Archive& archive, KeyFrame& keyframe, std::uint64_t& next_id);
void TakeFeatures(Archive& archive, KeyFrame& keyframe);
// With the pyramid, the bounds and the calibration matrix, which stand among them. False: the keyframe has no pose, and
// is at the origin.
bool TakePoses(Archive& archive, KeyFrame& keyframe);
void TakeKeyFrameTail(Archive& archive, KeyFrame& keyframe);

}  // namespace slamdb::orbslam2
