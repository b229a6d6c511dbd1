// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/formats/mcap/detail/writer.h"
#include "slamdb/formats/trajectory/detail/poses.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/index.h"

namespace slamdb::detail {

// A message at its time.
struct TimedMessage {
  std::uint64_t time = 0;  // nanoseconds since 1970
  std::uint16_t channel = 0;
  std::size_t cloud = kNoCloud;  // row of a map: its points, which are not in memory
  std::string message;           // otherwise

  static constexpr std::size_t kNoCloud = ~std::size_t{0};
};

// The schemas of a file, and the one channel that all maps share.
struct McapChannels {
  explicit McapChannels(McapWriter& writer);

  std::uint16_t clouds, poses, scenes, calibrations;  // schemas
  std::uint16_t transforms;                           // channel
};

// A map as it is found in a file: its frames `map_0/upright`, `map_0` and `map_0/camera`, its topics `/map_0/points`.
struct McapMap {
  std::size_t row = 0;  // of the maps that are written
  std::string frame;    // `map_0`
  const Map* map = nullptr;
  const KeyFrameTrajectory* trajectory = nullptr;  // null: it has no poses
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();   // in the map's frame
  bool has_points = false;
  std::uint64_t begin = 0;  // its first keyframe
};

// Adds the channels of a map, and its messages but for those that others share. The caller sorts them by time.
void AddMessages(const McapMap& map, const AtlasIndex& index, const McapChannels& channels, McapWriter& writer,
                 std::vector<TimedMessage>& messages);

// Nanoseconds since 1970, or the nearest that there is where they reach beyond 2262, or before 1970; `outside` counts
// those.
std::uint64_t LogTime(double seconds, std::size_t& outside);

}  // namespace slamdb::detail
