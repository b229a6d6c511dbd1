// SPDX-License-Identifier: BSD-3-Clause
// Atlases that are not sound are built on, or refused and left as they are: whatever is wrong with them.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <functional>
#include <span>

#include "slamdb/base/error.h"
#include "slamdb/build/links.h"
#include "tests/build/taken_apart.h"
#include "tests/support/corrupt.h"
#include "tests/support/equals_atlas.h"

namespace slamdb {
namespace {

// What is built, of columns of the sound atlas.
std::vector<std::function<void(Atlas&)>> Works(Base base) {
  const Map& sound = SoundAtlas(base).maps[0];
  NewKeyFrames keyframes = KeyFramesOf(sound);
  keyframes.ids.clear();
  if (keyframes.imu) keyframes.imu->previous.clear();
  for (double& time : keyframes.timestamps) time += keyframes.imu ? 0.0625 : 0;  // between those that are there
  if (keyframes.imu)
    for (Column<ImuMeasurement>& measurements : keyframes.imu->measurements) measurements.clear();
  const KeyFrameId one = sound.keyframes[1].id, other = sound.keyframes[3].id;
  const MapPointId point = sound.points[5].id;
  std::vector<std::function<void(Atlas&)>> works = {
      [](Atlas& atlas) {
        AddCamera(atlas, CameraModel::kPinhole, {1, 2, 3, 4});
      },
      [](Atlas& atlas) { AddMap(atlas); },
      [keyframes, id = sound.id](Atlas& atlas) { AddKeyFrames(atlas, id, keyframes); },
      [=](Atlas& atlas) { SetParents(atlas.maps[0], std::array{KeyFrameEdge(other, one)}); },
      [=](Atlas& atlas) { AddEdges(atlas.maps[0], EdgeKind::kLoop, std::array{KeyFrameEdge(other, one)}); },
      [=](Atlas& atlas) { SetReferences(atlas.maps[0], std::array{std::pair(point, other)}); },
      [](Atlas& atlas) { UpdateConnections(atlas.maps[0]); },
      [](Atlas& atlas) {
        UpdatePoints(atlas.maps[0], std::array{0U, 1U, 2U, 3U, 4U, 5U});
      },
      [](Atlas& atlas) { SetImuStage(atlas.maps[0], ImuStage::kAdjusted); },
  };
  for (const KeyFrame& keyframe : std::span(sound.keyframes).first(4))
    for (const std::uint64_t keypoint : {7, 90}) {
      works.emplace_back([=, id = keyframe.id](Atlas& atlas) {
        AddObservations(atlas.maps[0], std::array{PointObservation{point, id, keypoint}});
      });
      works.emplace_back([=, id = keyframe.id, map = sound.id](Atlas& atlas) {
        AddPoints(atlas, map, {.positions = {{0, 0, 3}}, .observations = {{0, id, keypoint}}});
      });
    }
  return works;
}

TEST(Build, OnDamagedAtlases) {
  std::size_t built = 0, refused = 0;
  for (const Twin& twin : Twins()) {
    SCOPED_TRACE(twin.rule);
    Atlas damaged = SoundAtlas(twin.base);
    twin.corrupt(damaged);
    if (damaged.maps.empty()) continue;
    const auto works = Works(twin.base);
    for (std::size_t i = 0; i < works.size(); ++i) {
      Atlas atlas = damaged;
      try {
        works[i](atlas);
        ++built;
      } catch (const Error&) {
        ++refused;
        EXPECT_THAT(atlas, EqualsAtlas(damaged)) << "what is refused changes nothing";
      }
    }
  }
  EXPECT_GT(built, 5 * Twins().size());
  EXPECT_GT(refused, Twins().size());
}

}  // namespace
}  // namespace slamdb
