// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/shrink_for_locating.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>

#include "slamdb/base/error.h"
#include "slamdb/checks/check.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/support/equals_atlas.h"

namespace slamdb::testing {
namespace {

std::uint64_t FileBytes(Atlas atlas) {
  atlas.encoding = {};
  return EncodeOrbslam3(atlas).size();
}

Atlas World() {
  return SynthesizeAtlas({.sensor = Sensor::kStereo, .keyframes = 24, .points = 1500, .seed = 1, .threads = 1});
}

TEST(ShrinkForLocating, SaysWhatIsFoundBeforeAndAfter) {
  Atlas atlas = World();
  const std::uint64_t target = FileBytes(atlas) / 2;
  const ShrinkReport report = ShrinkForLocating(atlas, {.target_bytes = target, .threads = 1});
  ASSERT_TRUE(report.found);
  EXPECT_EQ(report.found->places, 24U);
  EXPECT_GE(report.found->before, 12U);
  EXPECT_GE(report.found->after * 100, report.found->before * 80);
  EXPECT_LE(FileBytes(atlas), target + 1000);
  EXPECT_TRUE(CheckAtlas(atlas).ok());
}

// A single keyframe finds a few places at most: what is said to be found is not what was found before.
TEST(ShrinkForLocating, SaysWhenNothingIsFoundAnyMore) {
  Atlas atlas = World();
  const ShrinkReport report = ShrinkForLocating(atlas, {.target_keyframes = 1, .threads = 1});
  ASSERT_TRUE(report.found);
  EXPECT_LT(report.found->after * 2, report.found->before);
}

TEST(ShrinkForLocating, IsTheSameForAnyNumberOfThreads) {
  Atlas one = World(), four = one;
  const ShrinkReport first = ShrinkForLocating(one, {.target_keyframes = 8, .threads = 1});
  const ShrinkReport second = ShrinkForLocating(four, {.target_keyframes = 8, .threads = 4});
  EXPECT_THAT(four, EqualsAtlas(one));
  EXPECT_EQ(ToJson(first), ToJson(second));
}

TEST(ShrinkForLocating, LooksOnlyWhereThereIsAChoice) {
  Atlas atlas = World();
  const ShrinkReport report = ShrinkForLocating(atlas, {.for_localization = true});
  EXPECT_FALSE(report.found);
  EXPECT_THAT(ToJson(report), ::testing::HasSubstr("\"found\": null"));
}

// As a tracking loss leaves it: the newest map is empty. Nothing is to be chosen, but something goes all the same.
TEST(ShrinkForLocating, SurvivesAnEmptyNewestMap) {
  for (const std::uint64_t target : {500U, 0U}) {
    Atlas atlas = World();
    atlas.maps.push_back({.id = MapId(9)});
    ShrinkOptions options{.for_localization = target == 0};
    if (target > 0) options.target_keyframes = target;
    const std::size_t keyframes = atlas.maps[0].keyframes.size();
    EXPECT_FALSE(ShrinkForLocating(atlas, options).found);
    EXPECT_EQ(atlas.maps[0].keyframes.size(), keyframes);
  }
}

// Keyframes without camera, pose or words are located nowhere, and keep nothing from being chosen.
TEST(ShrinkForLocating, SurvivesMapsThatLackEverything) {
  Atlas atlas = World();
  atlas.cameras.clear();
  for (KeyFrame& keyframe : atlas.maps[0].keyframes) keyframe.features.bag_of_words = {};
  const ShrinkReport report = ShrinkForLocating(atlas, {.target_keyframes = 5});
  ASSERT_TRUE(report.found);
  EXPECT_EQ(report.found->after, 0U);
  EXPECT_EQ(atlas.maps[0].keyframes.size(), 5U);
  Atlas bad = World();
  for (KeyFrame& keyframe : bad.maps[0].keyframes) keyframe.bad = true;
  EXPECT_THROW(ShrinkForLocating(bad, {.target_keyframes = 1}), Error);
}

// Half the size finds 95 of 100 places that the whole finds, or more.
class HalfOfReal : public ::testing::TestWithParam<const char*> {};
TEST_P(HalfOfReal, FindsWhatTheWholeFinds) {
  const char* lab = std::getenv("SLAMDB_LAB2");
  const std::string name = GetParam(), fixture = SLAMDB_FIXTURES "/" + name + "/" + name + ".osa";
  const std::string path =
      std::filesystem::exists(fixture) ? fixture : std::string(lab ? lab : "") + "/" + name + ".osa";
  if (!std::filesystem::exists(path))
    GTEST_SKIP() << name << ".osa: not a fixture, and SLAMDB_LAB2 names no folder that holds it";
  Atlas atlas = ReadAtlas(Location{path});
  const std::uint64_t target = FileBytes(atlas) / 2;
  const ShrinkReport report = ShrinkForLocating(atlas, {.target_bytes = target});
  ASSERT_TRUE(report.found);
  EXPECT_GE(report.found->after * 100, report.found->before * 95);
  EXPECT_LE(FileBytes(atlas), target + 1000);
  EXPECT_TRUE(CheckAtlas(atlas).ok());
}
INSTANTIATE_TEST_SUITE_P(Files, HalfOfReal, ::testing::Values("session_small_a", "session_small_b", "p1", "m1"));

}  // namespace
}  // namespace slamdb::testing
