// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/mcap/detail/timeline.h"

#include <limits>

#include "slamdb/formats/mcap/detail/graph.h"
#include "slamdb/formats/mcap/detail/messages.h"
#include "slamdb/model/up.h"

namespace slamdb::detail {
namespace {

// Along the timeline: where the camera is, and its calibration wherever it changes.
void AddCamera(const McapMap& map, const AtlasIndex& index, std::uint16_t transforms, std::uint16_t calibrations,
               std::vector<TimedMessage>& messages) {
  const std::string camera_frame = map.frame + "/camera";
  std::string last;
  std::size_t ignored = 0;
  for (const TimedPose& pose : map.trajectory->poses) {
    const std::uint64_t time = LogTime(pose.timestamp, ignored);
    std::string body = CalibrationBody(camera_frame, *pose.keyframe, index.FindCamera(pose.keyframe->camera));
    if (body != last)
      messages.push_back({.time = time, .channel = calibrations, .message = CalibrationMessage(time, body)});
    last = std::move(body);
    messages.push_back({.time = time,
                        .channel = transforms,
                        .message = FrameTransformMessage(time, map.frame, camera_frame, pose.world_from_it)});
  }
}

}  // namespace

McapChannels::McapChannels(McapWriter& writer)
    : clouds(writer.AddSchema("foxglove.PointCloud")),
      poses(writer.AddSchema("foxglove.PosesInFrame")),
      scenes(writer.AddSchema("foxglove.SceneUpdate")),
      calibrations(writer.AddSchema("foxglove.CameraCalibration")),
      transforms(writer.AddChannel("/tf", writer.AddSchema("foxglove.FrameTransform"))) {}

void AddMessages(const McapMap& map, const AtlasIndex& index, const McapChannels& channels, McapWriter& writer,
                 std::vector<TimedMessage>& messages) {
  const std::string topics = "/" + map.frame;
  const Rigid3f upright{Quaternionf(UprightFromMap(map.up).cast<float>()), Eigen::Vector3f::Zero()};
  messages.push_back({.time = map.begin,
                      .channel = channels.transforms,
                      .message = FrameTransformMessage(map.begin, map.frame + "/upright", map.frame, upright)});
  if (map.has_points)
    messages.push_back({.time = map.begin,
                        .channel = writer.AddChannel(topics + "/points", channels.clouds),
                        .cloud = map.row,
                        .message = {}});
  if (map.trajectory == nullptr) return;
  messages.push_back({.time = map.begin,
                      .channel = writer.AddChannel(topics + "/poses", channels.poses),
                      .message = PosesMessage(map.begin, map.frame, map.trajectory->poses)});
  messages.push_back({.time = map.begin,
                      .channel = writer.AddChannel(topics + "/graph", channels.scenes),
                      .message = SceneMessage(map.begin, map.frame, GraphOf(*map.trajectory))});
  AddCamera(map, index, channels.transforms, writer.AddChannel(topics + "/camera", channels.calibrations), messages);
}

std::uint64_t LogTime(double seconds, std::size_t& outside) {
  if (seconds >= 0 && FitsNanoseconds(seconds)) return static_cast<std::uint64_t>(Nanoseconds(seconds));
  ++outside;
  return seconds < 0 ? 0 : std::numeric_limits<std::int64_t>::max();
}

}  // namespace slamdb::detail
