// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include "slamdb/model/digest.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/formats/store/atlases.h"

namespace slamdb::store_test {
namespace {

TEST(StoreRoundtrip, OddAtlasComesBackToTheLastBit) {
  const TemporaryFolder folder;
  const Atlas odd = OddAtlas();
  SaveIn(folder / "s.db", odd);
  const Atlas back = LoadFrom(folder / "s.db");
  EXPECT_EQ(FirstDifference(back, odd), "");
  EXPECT_EQ(HashOf(back), HashOf(odd));
}

TEST(StoreRoundtrip, StoreToStore) {
  const TemporaryFolder folder;
  SaveIn(folder / "one.db", OddAtlas());
  const SaveReport report = SaveIn(folder / "two.db", LoadFrom(folder / "one.db"), "other name");
  EXPECT_EQ(FirstDifference(LoadFrom(folder / "two.db", "other name"), OddAtlas()), "");
  EXPECT_EQ(report.hash, HashOf(OddAtlas()));
}

TEST(StoreRoundtrip, EmptyAtlas) {
  const TemporaryFolder folder;
  SaveIn(folder / "s.db", Atlas());
  EXPECT_EQ(FirstDifference(LoadFrom(folder / "s.db"), Atlas()), "");
}

class SensorRoundtrip : public ::testing::TestWithParam<std::tuple<Sensor, bool>> {};

TEST_P(SensorRoundtrip, SynthesizedAtlasComesBack) {
  const TemporaryFolder folder;
  const auto [sensor, inertial] = GetParam();
  const Atlas atlas = SynthesizeAtlas({.sensor = sensor,
                                       .inertial = inertial,
                                       .maps = 2,
                                       .keyframes = 12,
                                       .points = 200,
                                       .features = 300,
                                       .threads = 1});
  SaveIn(folder / "s.db", atlas);
  EXPECT_EQ(FirstDifference(LoadFrom(folder / "s.db"), atlas), "");
}

INSTANTIATE_TEST_SUITE_P(AllSensors, SensorRoundtrip,
                         ::testing::Combine(::testing::Values(Sensor::kMonocular, Sensor::kStereo, Sensor::kRgbd,
                                                              Sensor::kFisheyeStereo),
                                            ::testing::Bool()));

TEST(StoreRoundtrip, ThreadsDoNotChangeAnything) {
  const TemporaryFolder folder;
  SaveIn(folder / "s.db", SoundAtlas());
  ReadOptions one;
  one.threads = 1;
  ReadOptions many;
  many.threads = 7;
  EXPECT_EQ(FirstDifference(LoadFrom(folder / "s.db", "a", one), LoadFrom(folder / "s.db", "a", many)), "");
}

// What follows from other columns is left out: a keyframe of 200 keypoints takes less than half of its .osa bytes.
TEST(StoreRoundtrip, DerivedColumnsTakeNoSpace) {
  const TemporaryFolder folder;
  const Atlas atlas = SoundAtlas();
  SaveIn(folder / "s.db", atlas);
  std::size_t osa_bytes = 0;
  std::size_t keypoints = 0;
  for (const Map& map : atlas.maps) {
    for (const KeyFrame& keyframe : map.keyframes) {
      const Features& features = keyframe.features;
      keypoints += features.keypoints.size();
      osa_bytes += features.keypoints.size() * (28 + 28 + 4 + 4 + 32 + 8 + 8) + features.grid.cell_sizes.size() * 12;
    }
  }
  const std::size_t stored = std::stoull(
      Sql(folder / "s.db",
          "SELECT (SELECT sum(length(columns)) FROM picture) + (SELECT sum(length(points)) FROM keyframe_features)"));
  EXPECT_LT(stored, osa_bytes / 2);
  EXPECT_LT(stored, keypoints * 90);
}

TEST(StoreRoundtrip, SeveralAtlasesInOneFile) {
  const TemporaryFolder folder;
  SaveIn(folder / "s.db", OddAtlas(), "odd");
  SaveIn(folder / "s.db", SoundAtlas(), "sound");
  SaveIn(folder / "s.db", Atlas(), "empty");
  EXPECT_EQ(FirstDifference(LoadFrom(folder / "s.db", "odd"), OddAtlas()), "");
  EXPECT_EQ(FirstDifference(LoadFrom(folder / "s.db", "sound"), SoundAtlas()), "");
  EXPECT_EQ(FirstDifference(LoadFrom(folder / "s.db", "empty"), Atlas()), "");
}

TEST(StoreRoundtrip, HashTellsFieldsApart) {
  const Atlas atlas = OddAtlas();
  const std::uint64_t hash = HashOf(atlas);
  const auto differs = [&](auto change) {
    Atlas other = atlas;
    change(other);
    return HashOf(other) != hash;
  };
  EXPECT_TRUE(differs([](Atlas& a) { a.maps[0].points[0].position.x() = -a.maps[0].points[0].position.x(); }));
  EXPECT_TRUE(differs([](Atlas& a) { a.maps[0].keyframes[0].features.descriptors[4][31] ^= 1; }));
  EXPECT_TRUE(differs([](Atlas& a) { a.maps[0].keyframes[0].preintegration.duration = -0.0F; }));
  EXPECT_TRUE(differs([](Atlas& a) { std::swap(a.maps[0].points[0], a.maps[0].points[1]); }));
  EXPECT_TRUE(differs([](Atlas& a) { a.maps[0].imu_ba2.recorded = 9; }));
  EXPECT_TRUE(differs([](Atlas& a) { a.encoding.text = true; }));
}

}  // namespace
}  // namespace slamdb::store_test
