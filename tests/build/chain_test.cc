// SPDX-License-Identifier: BSD-3-Clause
// Keyframes with an IMU, added in any order: the chain in time, and what was measured between them.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <random>

#include "slamdb/model/preintegration.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/build/taken_apart.h"

namespace slamdb {
namespace {

const Atlas& SessionAtlas() {
  static const Atlas atlas =
      SynthesizeAtlas({.sensor = Sensor::kStereo, .inertial = true, .keyframes = 10, .points = 200, .features = 120});
  return atlas;
}
const Map& Session() { return SessionAtlas().maps[0]; }

template <class List>
void Keep(const std::vector<std::size_t>& rows, List& list) {
  List kept;
  for (const std::size_t row : rows) kept.push_back(list[row]);
  list = std::move(kept);
}

// Those of the session at `rows`, in this order; which is before which, times tell.
NewKeyFrames Rows(const std::vector<std::size_t>& rows) {
  NewKeyFrames columns = KeyFramesOf(Session());
  Keep(rows, columns.timestamps);
  Keep(rows, columns.camera_from_world);
  Keep(rows, columns.features);
  Keep(rows, columns.ids);
  Keep(rows, columns.imu->measurements);
  Keep(rows, columns.imu->velocities);
  Keep(rows, columns.imu->biases);
  Keep(rows, columns.imu->integration_biases);
  columns.imu->previous.clear();
  return columns;
}

Atlas WithCamera() {
  Atlas atlas;
  atlas.vocabulary = SessionAtlas().vocabulary;
  const Camera& camera = SessionAtlas().cameras[0];
  AddCamera(atlas, camera.model, camera.parameters, camera.id);
  AddMap(atlas);
  return atlas;
}

std::vector<std::size_t> Every(std::size_t end) {
  std::vector<std::size_t> rows(end);
  std::iota(rows.begin(), rows.end(), 0U);
  return rows;
}

// What leads to the keyframe in `row` of the session since the one in `since`.
Column<ImuMeasurement> Between(std::size_t since, std::size_t row) {
  Column<ImuMeasurement> measurements;
  for (++since; since <= row; ++since) {
    const auto& part = Session().keyframes[since].preintegration.measurements;
    measurements.insert(measurements.end(), part.begin(), part.end());
  }
  return measurements;
}

void ExpectTheSession(const Map& map) {
  for (const KeyFrame& expected : Session().keyframes) {
    SCOPED_TRACE(ToString(expected.id));
    const auto actual = std::ranges::find(map.keyframes, expected.id, &KeyFrame::id);
    ASSERT_NE(actual, map.keyframes.end());
    EXPECT_EQ(actual->previous, expected.previous);
    EXPECT_EQ(actual->next, expected.next);
    EXPECT_EQ(actual->preintegration.measurements.size(), expected.preintegration.measurements.size());
    EXPECT_LE((actual->preintegration.position - expected.preintegration.position).norm(), 1e-5F);
    if (!expected.previous) continue;
    EXPECT_LE((actual->preintegration.rotation - expected.preintegration.rotation).norm(), 1e-5F);
  }
}

TEST(Chain, FollowsTimesInWhateverOrderRowsStand) {
  std::mt19937 random(5);
  for (int i = 0; i < 5; ++i) {
    Atlas atlas = WithCamera();
    std::vector<std::size_t> rows = Every(10);
    std::ranges::shuffle(rows, random);
    AddKeyFrames(atlas, MapId(0), Rows(rows));
    ExpectTheSession(atlas.maps[0]);
    EXPECT_TRUE(atlas.maps[0].inertial);
  }
}

TEST(Chain, GrowsAtItsEnd) {
  Atlas atlas = WithCamera();
  for (std::size_t row = 0; row < 10; ++row) {
    AddKeyFrames(atlas, MapId(0), Rows({row}));
    if (row == 5) SetImuStage(atlas.maps[0], ImuStage::kInitialized);
  }
  ExpectTheSession(atlas.maps[0]);
  for (const KeyFrame& keyframe : atlas.maps[0].keyframes) EXPECT_TRUE(keyframe.imu_initialized);
}

// Measurements that led over a keyframe are its own and those of what follows.
TEST(Chain, GrowsInItsMiddle) {
  Atlas atlas = WithCamera();
  NewKeyFrames ends = Rows({0, 9});
  ends.imu->measurements[1] = Between(0, 9);
  AddKeyFrames(atlas, MapId(0), ends);
  for (const std::vector<std::size_t>& rows : {std::vector<std::size_t>{4}, {7, 2}, {1, 3, 5, 6, 8}}) {
    NewKeyFrames middle = Rows(rows);
    for (Column<ImuMeasurement>& measurements : middle.imu->measurements) measurements.clear();
    AddKeyFrames(atlas, MapId(0), middle);
  }
  ExpectTheSession(atlas.maps[0]);
}

TEST(Chain, SplitsAMeasurementInWhichAKeyFrameWasTaken) {
  std::mt19937 random(9);
  for (int i = 0; i < 50; ++i) {
    Atlas atlas = WithCamera();
    AddKeyFrames(atlas, MapId(0), Rows({0, 1}));
    const KeyFrame whole = atlas.maps[0].keyframes[1];
    const double gap = whole.timestamp - atlas.maps[0].keyframes[0].timestamp;
    NewKeyFrames middle = Rows({2});
    middle.timestamps[0] = whole.timestamp - gap * std::uniform_real_distribution(0.001, 0.999)(random);
    middle.imu->measurements[0].clear();
    middle.imu->biases[0] = whole.imu_bias;
    middle.imu->integration_biases[0] = whole.preintegration.bias;
    AddKeyFrames(atlas, MapId(0), middle);
    const auto& keyframes = atlas.maps[0].keyframes;
    const ImuPreintegration &first = keyframes[2].preintegration, &second = keyframes[1].preintegration;
    EXPECT_NEAR(static_cast<double>(first.duration), middle.timestamps[0] - keyframes[0].timestamp, 1e-4);
    EXPECT_NEAR(static_cast<double>(second.duration), whole.timestamp - middle.timestamps[0], 1e-4);
    ImuPreintegration joined = second;
    ASSERT_TRUE(JoinPreintegrations(std::array{&first}, joined));
    EXPECT_LE((joined.position - whole.preintegration.position).norm(), 1e-5F);
    EXPECT_LE((joined.velocity - whole.preintegration.velocity).norm(), 1e-4F);
    EXPECT_EQ(keyframes[1].previous, keyframes[2].id);
    EXPECT_EQ(keyframes[0].next, keyframes[2].id);
  }
}

TEST(Chain, BeginsWhereNothingWasMeasured) {
  Atlas atlas = WithCamera();
  NewKeyFrames columns = Rows(Every(10));
  columns.imu->measurements[5].clear();
  AddKeyFrames(atlas, MapId(0), columns);
  const auto& keyframes = atlas.maps[0].keyframes;
  EXPECT_FALSE(keyframes[5].previous);
  EXPECT_FALSE(keyframes[4].next);
  EXPECT_EQ(keyframes[6].previous, keyframes[5].id);
  SetImuStage(atlas.maps[0], ImuStage::kAdjustedTwice);
  AddPoints(atlas, MapId(0), PointsOf(Session()));
  EXPECT_EQ(TroublesOf(atlas), "");
}

// Sessions that were merged have a chain each, whatever their clocks say.
TEST(Chain, IsWhatPreviousSays) {
  Atlas atlas = WithCamera();
  NewKeyFrames columns = Rows({0, 1, 2, 3});
  columns.imu->measurements = {{}, {}, Between(0, 2), Between(1, 3)};
  columns.imu->previous = {{}, {}, columns.ids[0], columns.ids[1]};
  AddKeyFrames(atlas, MapId(0), columns);
  NewKeyFrames later = Rows({5});
  later.imu->measurements = {Between(2, 5)};
  later.imu->previous = {columns.ids[2]};
  AddKeyFrames(atlas, MapId(0), later);
  const auto& keyframes = atlas.maps[0].keyframes;
  EXPECT_EQ(keyframes[2].previous, keyframes[0].id);
  EXPECT_EQ(keyframes[0].next, keyframes[2].id);
  EXPECT_EQ(keyframes[3].previous, keyframes[1].id);
  EXPECT_EQ(keyframes[2].next, keyframes[4].id);
  EXPECT_FALSE(keyframes[3].next);
}

TEST(ImuStage, IsOfTheMapAndItsKeyFrames) {
  Atlas atlas = WithCamera();
  AddKeyFrames(atlas, MapId(0), Rows(Every(10)));
  Map& map = atlas.maps[0];
  EXPECT_FALSE(map.imu_initialized);
  SetImuStage(map, ImuStage::kAdjusted);
  EXPECT_TRUE(map.imu_initialized && map.imu_ba1 && !map.imu_ba2);
  EXPECT_TRUE(std::ranges::all_of(map.keyframes, [](const KeyFrame& k) { return bool(k.imu_initialized); }));
  SetImuStage(map, ImuStage::kNone);
  EXPECT_FALSE(map.imu_initialized || map.imu_ba1);
  EXPECT_TRUE(std::ranges::none_of(map.keyframes, [](const KeyFrame& k) { return bool(k.imu_initialized); }));
}

}  // namespace
}  // namespace slamdb
