// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "slamdb/edit/merge/merge.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/index.h"
#include "slamdb/model/similarity.h"
#include "slamdb/model/umeyama.h"
#include "slamdb/synthetic/synthesize.h"

// Sound maps that are at one place twice and do not know, and what bends them.
namespace slamdb::testing {

// A camera that goes round a room twice and does not know that it is there again: its second round has points of its
// own, and descriptors that differ in some bits.
inline Atlas MakeTwoRounds(Sensor sensor, bool inertial = false) {
  const Atlas first = SynthesizeAtlas({.sensor = sensor,
                                       .inertial = inertial,
                                       .keyframes = 40,
                                       .points = 1200,
                                       .features = 300,
                                       .pixel_noise = 0,
                                       .loops = false});
  Atlas second = first;
  Map& map = second.maps[0];
  for (KeyFrame& keyframe : map.keyframes) {
    keyframe.timestamp += 100;
    for (Descriptor& descriptor : keyframe.features.descriptors) descriptor[0] ^= 0x0F;
  }
  for (MapPoint& point : map.points) point.descriptor[0] ^= 0x0F;
  MergeOptions options;
  JoinOptions& join = options.join.emplace();
  join.first = join.second = map.id;
  join.first_from_second.emplace();
  join.anchors = {{map.keyframes.back().id, map.keyframes.front().id}};
  Atlas both = MergeAtlases({first, second}, options).atlas;
  for (KeyFrame& keyframe : both.maps[0].keyframes) keyframe.merge_edges.clear();
  return both;
}

// What bends the map at its end; keyframes before it by their share of the way.
struct Bend {
  double scale = 1, radians = 0, shift = 0;

  Similarity3d At(double share) const {
    const Eigen::AngleAxisd turn(radians * share, Eigen::Vector3d::UnitZ());
    return {std::pow(scale, share), Eigen::Quaterniond(turn), Eigen::Vector3d(shift, -shift, 0) * share};
  }
};

// Moves each keyframe by its part of the bend, and points with their reference keyframe.
inline void BendMap(Map& map, const Bend& bend) {
  const auto at = [&](std::uint32_t row) {
    return bend.At(static_cast<double>(row) / static_cast<double>(map.keyframes.size() - 1));
  };
  const IdTable rows = KeyFrameTable(map);
  for (MapPoint& point : map.points) {
    const Similarity3d motion = at(rows.Find(point.reference.value()));
    point.position = (motion * point.position.cast<double>()).cast<float>();
    point.normal = (motion.rotation * point.normal.cast<double>()).cast<float>();
    point.min_distance *= static_cast<float>(motion.scale);
    point.max_distance *= static_cast<float>(motion.scale);
  }
  for (std::uint32_t row = 0; row < map.keyframes.size(); ++row) {
    KeyFrame& keyframe = map.keyframes[row];
    const Similarity3d motion = at(row);
    const Eigen::Vector3d center = motion * CameraCenter(keyframe).cast<double>();
    const Eigen::Quaterniond rotation =
        keyframe.camera_from_world.rotation.cast<double>().normalized() * motion.rotation.conjugate();
    keyframe.camera_from_world.rotation = rotation.cast<float>();
    keyframe.camera_from_world.translation = (-(rotation * center)).cast<float>();
  }
}

inline Atlas MakeMissedLoop(Sensor sensor, const Bend& bend) {
  Atlas atlas = MakeTwoRounds(sensor);
  BendMap(atlas.maps[0], bend);
  return atlas;
}

// Root mean square distance of cameras from those of the truth, after the best transform.
inline double TrajectoryError(const Map& map, const Map& truth, bool with_scale) {
  std::vector<Eigen::Vector3d> is, should;
  for (std::size_t row = 0; row < map.keyframes.size(); ++row) {
    is.emplace_back(CameraCenter(map.keyframes[row]).cast<double>());
    should.emplace_back(CameraCenter(truth.keyframes[row]).cast<double>());
  }
  return SolveUmeyama(is, should, {.with_scale = with_scale}).rms;
}

}  // namespace slamdb::testing
