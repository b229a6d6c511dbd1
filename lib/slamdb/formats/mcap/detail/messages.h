// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/formats/export/detail/points.h"
#include "slamdb/formats/mcap/detail/graph.h"
#include "slamdb/formats/trajectory/detail/poses.h"

// Foxglove's messages, in protobuf. Times in nanoseconds since 1970.
namespace slamdb::detail {

// Where a frame is in another.
std::string FrameTransformMessage(std::uint64_t time, std::string_view parent, std::string_view child,
                                  const Rigid3f& parent_from_child);

std::string PosesMessage(std::uint64_t time, std::string_view frame, const std::vector<TimedPose>& poses);

// Lines as entities of a scene.
std::string SceneMessage(std::uint64_t time, std::string_view frame, const std::vector<GraphLines>& lines);

// The calibration of a keyframe's undistorted image, without its time; `camera` may be null.
std::string CalibrationBody(std::string_view frame, const KeyFrame& keyframe, const Camera* camera);
// And with it.
std::string CalibrationMessage(std::uint64_t time, std::string_view body);

// What stands in front of the points of a cloud: rows of `PointStride(ids)` bytes.
std::string CloudHead(std::uint64_t time, std::string_view frame, std::uint64_t points, IdColumn ids);
std::uint32_t PointStride(IdColumn ids);

}  // namespace slamdb::detail
