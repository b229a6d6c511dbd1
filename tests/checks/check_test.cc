// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/checks/check.h"

#include <gmock/gmock.h>

#include <cstring>
#include <limits>
#include <random>

#include "slamdb/base/error.h"
#include "tests/support/corrupt.h"
#include "tests/support/kind_of.h"

namespace slamdb {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const RuleResult* FindResult(const CheckReport& report, std::string_view id) {
  for (const RuleResult& result : report.results)
    if (result.id == id) return &result;
  return nullptr;
}

// With three dangling observations (error), one keyframe of a map that never was (warning) and one wild merge scale
// (note).
Atlas Damaged() {
  Atlas atlas = SoundAtlas(Base::kMonocular);
  for (std::size_t row = 0; row < 3; ++row)
    atlas.maps[0].points[row].observations.push_back({KeyFrameId(100'000 + row), 0, -1});
  atlas.maps[0].keyframes[1].origin_map = 99;
  atlas.maps[0].keyframes[0].merge_scale = std::numeric_limits<float>::quiet_NaN();
  return atlas;
}

TEST(CheckAtlas, CountsBySeverity) {
  const CheckReport report = CheckAtlas(Damaged(), {});
  EXPECT_EQ(report.Count(Severity::kError), 3u);
  EXPECT_EQ(report.Count(Severity::kWarning), 1u);
  EXPECT_EQ(report.Count(Severity::kNote), 1u);
  EXPECT_FALSE(report.ok());
  EXPECT_EQ(report.checked.size(), ReadRules().size());
}

TEST(CheckAtlas, StatesTheBreachAndWhereItIs) {
  const Atlas atlas = Damaged();
  const CheckReport report = CheckAtlas(atlas, {});
  const RuleResult* result = FindResult(report, "observation-target");
  ASSERT_NE(result, nullptr);
  const Finding& finding = result->findings[0];
  EXPECT_EQ(finding.place, (Place{.map = atlas.maps[0].id, .point = atlas.maps[0].points[0].id}));
  EXPECT_EQ(finding.message, "observed by kf 100000, which does not exist");
  EXPECT_EQ(ToString(finding.place), "map 0, mp " + std::to_string(atlas.maps[0].points[0].id.value()));
}

TEST(CheckAtlas, SaysWhenTheTargetIsInAnotherMap) {
  Atlas atlas = SoundAtlas(Base::kTwoMaps);
  atlas.maps[1].keyframes[2].merge_edges.push_back(atlas.maps[0].keyframes[0].id);
  const CheckReport report = CheckAtlas(atlas, {});
  const RuleResult* result = FindResult(report, "merge-edge-target");
  ASSERT_NE(result, nullptr);
  EXPECT_THAT(result->findings[0].message, HasSubstr("which is in map 0"));
}

TEST(CheckAtlas, KeepsSomeFindingsAndCountsAll) {
  const CheckReport report = CheckAtlas(Damaged(), {.max_findings = 2});
  const RuleResult* result = FindResult(report, "observation-target");
  ASSERT_NE(result, nullptr);
  EXPECT_EQ(result->count, 3u);
  EXPECT_EQ(result->findings.size(), 2u);
}

TEST(CheckAtlas, DoesNotDependOnThreads) {
  const Atlas atlas = Damaged();
  const CheckReport one = CheckAtlas(atlas, {.threads = 1}), many = CheckAtlas(atlas, {.threads = 5});
  ASSERT_EQ(one.results.size(), many.results.size());
  for (std::size_t i = 0; i < one.results.size(); ++i) {
    EXPECT_EQ(one.results[i].id, many.results[i].id);
    EXPECT_EQ(one.results[i].findings, many.results[i].findings);
  }
}

TEST(CheckAtlas, TakesOverrides) {
  const CheckReport ignored = CheckAtlas(Damaged(), {.ignore = {"observation-target", "uninitialised"}});
  EXPECT_EQ(FindResult(ignored, "observation-target"), nullptr);
  EXPECT_TRUE(ignored.ok());
  EXPECT_EQ(ignored.checked.size(), ReadRules().size() - 2);

  const CheckReport changed = CheckAtlas(Damaged(), {.warn = {"observation-target"}, .error = {"origin-map-id"}});
  EXPECT_EQ(FindResult(changed, "observation-target")->severity, Severity::kWarning);
  EXPECT_EQ(FindResult(changed, "origin-map-id")->severity, Severity::kError);
}

TEST(CheckAtlas, StrictMakesWarningsErrors) {
  const CheckReport report = CheckAtlas(Damaged(), {.ignore = {"observation-target"}, .strict = true});
  EXPECT_EQ(report.Count(Severity::kError), 1u);
  EXPECT_EQ(report.Count(Severity::kWarning), 0u);
  EXPECT_EQ(report.Count(Severity::kNote), 1u);
}

TEST(CheckAtlas, RefusesUnknownNames) {
  EXPECT_EQ(KindOf([] { return CheckAtlas(Atlas(), {.ignore = {"no-such-rule"}}); }), ErrorKind::kUsage);
  EXPECT_EQ(KindOf([] { return CheckAtlas(Atlas(), {.gates = {{"min-luck", 7}}}); }), ErrorKind::kUsage);
}

TEST(CheckAtlas, HoldsGates) {
  const Atlas& atlas = SoundAtlas(Base::kTwoMaps);
  const CheckReport passed = CheckAtlas(atlas, {.gates = {{"min-keyframes", 24},
                                                          {"max-maps", 2},
                                                          {"max-reprojection-px", 3},
                                                          {"min-points", 100},
                                                          {"max-components", 2},
                                                          {"min-observers", 2}}});
  EXPECT_THAT(passed.results, IsEmpty());
  const CheckReport failed = CheckAtlas(atlas, {.gates = {{"min-keyframes", 25}, {"max-maps", 1}}});
  ASSERT_EQ(failed.results.size(), 2u);
  EXPECT_EQ(failed.results[0].id, "gate-min-keyframes");
  EXPECT_EQ(failed.results[0].severity, Severity::kError);
  EXPECT_EQ(failed.results[0].findings[0].message, "has 24 keyframes, fewer than 25");
  EXPECT_EQ(failed.results[1].findings[0].message, "has 2 maps with keyframes, more than 1");
  EXPECT_FALSE(failed.ok());
}

TEST(CheckAtlas, EmptyAtlasIsHeldAgainstEveryRule) {
  const CheckReport report = CheckAtlas(Atlas(), {});
  ASSERT_EQ(report.results.size(), 2u);
  EXPECT_EQ(report.results[0].id, "atlas-not-empty");
  EXPECT_EQ(report.results[1].id, "vocabulary-checksum");
}

// What an atlas has none of, it is not sound without; landmarks need neither keyframes nor points.
TEST(CheckAtlas, AnAtlasOfNothingIsNotSound) {
  const auto finding = [](const Atlas& atlas) {
    const CheckReport report = CheckAtlas(atlas, {});
    const RuleResult* result = FindResult(report, "atlas-not-empty");
    EXPECT_TRUE(result == nullptr || !report.ok());
    return result == nullptr ? std::string() : result->findings[0].message;
  };
  Atlas atlas = SoundAtlas(Base::kMonocular);
  EXPECT_EQ(finding(atlas), "");
  atlas.maps.emplace_back().id = MapId(atlas.next_ids.map++);  // what ORB-SLAM3 begins, and saves with the rest
  EXPECT_EQ(finding(atlas), "");
  EXPECT_EQ(FindResult(CheckAtlas(atlas, {}), "map-not-empty")->severity, Severity::kNote);
  atlas.maps.pop_back();
  for (MapPoint& point : atlas.maps[0].points) point.bad = true;
  EXPECT_EQ(finding(atlas), "has no points but such as are flagged bad: there is nothing to localise in");
  atlas.maps[0].points.clear();
  EXPECT_EQ(finding(atlas), "has no points: there is nothing to localise in");
  atlas.maps[0].keyframes.clear();
  EXPECT_EQ(finding(atlas), "has no keyframes: there is nothing to localise in");
  atlas.maps[0].landmarks.resize(1);
  EXPECT_EQ(finding(atlas), "");
  atlas.maps.clear();
  EXPECT_EQ(finding(atlas), "has no maps: there is nothing to localise in");
}

// Overwrites ids, counts and numbers all over the atlas; whatever that makes of it, rules and fixes come back.
TEST(CheckAtlas, SurvivesAnything) {
  for (const Base base : {Base::kMonocular, Base::kFisheyeStereo, Base::kInertial, Base::kTwoMaps}) {
    std::mt19937_64 random(static_cast<std::uint64_t>(base) + 1);
    const auto wild = [&]() -> std::int32_t {
      constexpr std::int32_t kValues[] = {
          -1, 0, 1, 7, 1 << 30, std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::max()};
      return kValues[random() % std::size(kValues)];
    };
    for (int round = 0; round < 30; ++round) {
      Atlas atlas = SoundAtlas(base);
      for (Map& map : atlas.maps) {
        for (KeyFrame& keyframe : map.keyframes) {
          if (random() % 3 != 0) continue;
          Features& features = keyframe.features;
          const auto id = KeyFrameId(static_cast<std::uint64_t>(wild()));
          switch (random() % 12) {
            case 0:
              keyframe.id = id;
              break;
            case 1:
              keyframe.parent = id;
              break;
            case 2:
              features.count = wild();
              break;
            case 3:
              features.left_count = wild();
              break;
            case 4:
              features.right_count = wild();
              break;
            case 5:
              features.map_points.resize(random() % 9);
              break;
            case 6:
              keyframe.bounds = {wild(), wild(), 0, 1, wild(), wild(), wild(), wild()};
              break;
            case 7:
              keyframe.pyramid.levels = wild();
              keyframe.pyramid.factors.clear();
              break;
            case 8:
              features.grid.cell_sizes.resize(random() % 5, 1u << 31);
              break;
            case 9:
              keyframe.camera_from_world.rotation.coeffs().setZero();
              break;
            case 10:
              keyframe.connections.push_back({id, wild()});
              break;
            case 11:
              features.undistorted.clear();
              features.bag_of_words.weights.clear();
              break;
          }
        }
        for (MapPoint& point : map.points) {
          if (random() % 8 != 0) continue;
          if (!point.observations.empty()) point.observations[0].left = wild();
          if (!point.observations.empty()) point.observations.back().right = wild();
          point.reference = KeyFrameId(static_cast<std::uint64_t>(wild()));
          point.position.setConstant(std::numeric_limits<float>::quiet_NaN());
        }
        map.repeated_keyframes.push_back({random(), static_cast<std::uint32_t>(wild()), random()});
      }
      atlas.repeated_maps.push_back({random(), 0, random()});
      atlas.cameras[0].parameters.resize(random() % 6);
      EXPECT_FALSE(CheckAtlas(atlas, {.vocabulary_words = 10, .threads = 1}).ok());
      for (const Rule& rule : ReadRules())
        if (rule.fix) rule.fix.apply(atlas);
    }
  }
}

TEST(DropEmptyMaps, MovesUpWhatNamesLaterMaps) {
  Atlas atlas;
  atlas.maps.resize(4);
  for (std::size_t row : {1, 3}) atlas.maps[row].keyframes.resize(2);
  atlas.maps[1].repeated_points = {{0, 3, 0}};
  atlas.repeated_maps = {{2, 0, 0}, {4, 0, 1}, {6, 0, 3}};  // maps at positions 0, 1, 3, 5
  const Rule* rule = FindRule("map-not-empty");
  EXPECT_EQ(rule->fix.apply(atlas), 2u);
  ASSERT_EQ(atlas.maps.size(), 2u);
  EXPECT_THAT(atlas.repeated_maps, ElementsAre(RepeatedEntry{1, 0, 0}, RepeatedEntry{3, 0, 1}));
  EXPECT_THAT(atlas.maps[0].repeated_points, ElementsAre(RepeatedEntry{0, 1, 0}));
}

TEST(DropEmptyMaps, LeavesMapsOfLandmarks) {
  Atlas atlas;
  atlas.maps.resize(2);
  atlas.maps[1].landmarks.resize(1);
  EXPECT_EQ(FindRule("map-not-empty")->fix.apply(atlas), 1u);
  ASSERT_EQ(atlas.maps.size(), 1u);
  EXPECT_EQ(atlas.maps[0].landmarks.size(), 1u);
}

}  // namespace
}  // namespace slamdb
