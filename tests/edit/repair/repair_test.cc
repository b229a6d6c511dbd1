// SPDX-License-Identifier: BSD-3-Clause
// Repairs: every broken atlas becomes sound, or what stays is said with a reason; and every repair can be taken back.
#include "slamdb/edit/repair/repair.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <limits>
#include <ostream>

#include "slamdb/base/error.h"
#include "tests/support/corrupt.h"
#include "tests/support/equals_atlas.h"
#include "tests/support/kind_of.h"

namespace slamdb {

std::ostream& operator<<(std::ostream& out, const Twin& twin) { return out << twin.rule; }

namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr std::uint64_t kWords = 1'000'000;

std::vector<std::string> ErrorsOf(const Atlas& atlas) {
  std::vector<std::string> errors;
  for (const RuleResult& result : CheckAtlas(atlas, {.vocabulary_words = kWords, .threads = 1}).results)
    if (result.severity == Severity::kError) errors.push_back(result.id);
  return errors;
}

class RepairTwin : public ::testing::TestWithParam<Twin> {
 protected:
  void SetUp() override {
    original_ = SoundAtlas(GetParam().base);
    GetParam().corrupt(original_);
    repaired_ = original_;
    report_ = RepairAtlas(repaired_, {.vocabulary_words = kWords, .threads = 1});
  }
  Atlas original_, repaired_;
  RepairReport report_;
};

TEST_P(RepairTwin, LeavesOnlyWhatItListsWithAReason) {
  std::vector<std::string> listed;
  for (const Unrepaired& rule : report_.left) {
    EXPECT_FALSE(rule.reason.empty()) << rule.rule;
    if (rule.severity == Severity::kError) listed.push_back(rule.rule);
  }
  EXPECT_EQ(ErrorsOf(repaired_), listed);
  EXPECT_EQ(report_.sound(), listed.empty());
  for (const std::string& id : listed) EXPECT_FALSE(FindRule(id)->fix) << id << " has a repair that did not work";
}

TEST_P(RepairTwin, IsTakenBackBitByBit) {
  Atlas atlas = repaired_;
  TakeBack(report_.journal, atlas);
  EXPECT_THAT(atlas, EqualsAtlas(original_));
}

TEST_P(RepairTwin, HasNothingToDoTwice) {
  Atlas again = repaired_;
  const RepairReport report = RepairAtlas(again, {.vocabulary_words = kWords, .threads = 3});
  EXPECT_THAT(report.applied, IsEmpty());
  EXPECT_THAT(report.journal.edits, IsEmpty());
  EXPECT_THAT(again, EqualsAtlas(repaired_));
}

INSTANTIATE_TEST_SUITE_P(Twins, RepairTwin, ::testing::ValuesIn(Twins().begin(), Twins().end()),
                         [](const ::testing::TestParamInfo<Twin>& twin) {
                           std::string name(twin.param.rule);
                           std::ranges::replace(name, '-', '_');
                           return name + "_" + std::to_string(twin.index);
                         });

Atlas Broken(std::string_view rule) {
  const auto twin = std::ranges::find(Twins(), rule, &Twin::rule);
  Atlas atlas = SoundAtlas(twin->base);
  twin->corrupt(atlas);
  return atlas;
}

TEST(Repair, TakesManyBreachesAtOnce) {
  Atlas atlas = SoundAtlas(Base::kMonocular);
  for (const std::string_view rule :
       {"map-listed-once",   "map-not-empty",     "point-bad",        "counters-above-ids", "observation-target",
        "slot-target",       "connection-target", "loop-edge-target", "grid-shape",         "feature-vector-index",
        "observation-index", "reference-target",  "point-observed",   "tree-root",          "initial-keyframe",
        "origin-given",      "rotation-unit",     "point-normal",     "distance-range",     "flag-byte",
        "uninitialised",     "keyframe-bad"})
    std::ranges::find(Twins(), rule, &Twin::rule)->corrupt(atlas);
  const Atlas original = atlas;
  const RepairReport report = RepairAtlas(atlas);
  EXPECT_GT(report.applied.size(), 10u);
  EXPECT_TRUE(report.sound()) << report.left.front().rule << ": " << report.left.front().first.message;
  TakeBack(report.journal, atlas);
  EXPECT_THAT(atlas, EqualsAtlas(original));
}

TEST(Repair, AppliesChosenRulesOnly) {
  Atlas atlas = Broken("slot-target");
  atlas.next_ids.frame = 0;
  const RepairReport report = RepairAtlas(atlas, {.rules = {"counters-above-ids"}});
  EXPECT_THAT(report.applied, ElementsAre(Field(&AppliedFix::rule, "counters-above-ids")));
  ASSERT_THAT(report.left, ElementsAre(Field(&Unrepaired::rule, "slot-target")));
  EXPECT_EQ(report.left[0].reason, "not chosen");
  EXPECT_GT(atlas.next_ids.frame, 0u);
}

TEST(Repair, RefusesRulesThatItCannotRepair) {
  Atlas atlas = SoundAtlas(Base::kMonocular);
  EXPECT_THROW(RepairAtlas(atlas, {.rules = {"no-such-rule"}}), Error);
  EXPECT_THROW(RepairAtlas(atlas, {.rules = {"pose-finite"}}), Error);
}

// What a map loses when ORB-SLAM3 loads it twice over: the slots still tell.
TEST(Repair, RestoresWipedObservations) {
  Atlas atlas = SoundAtlas(Base::kFisheyeStereo);
  const Atlas sound = atlas;
  for (MapPoint& point : atlas.maps[0].points) point.observations.clear();
  EXPECT_TRUE(RepairAtlas(atlas).sound());
  EXPECT_THAT(atlas, EqualsAtlas(sound));
}

TEST(Repair, GrowsATreeOfWhatLostItsParents) {
  Atlas atlas = SoundAtlas(Base::kMonocular);
  Map& map = atlas.maps[0];
  const KeyFrameId root = map.first_keyframe;
  for (KeyFrame& keyframe : map.keyframes) {
    keyframe.children.clear();
    if (keyframe.id != root) keyframe.parent = map.keyframes[3].id;
  }
  EXPECT_TRUE(RepairAtlas(atlas).sound());
  EXPECT_EQ(std::ranges::count(map.keyframes, KeyFrameId(), &KeyFrame::parent), 1);
}

TEST(Journal, RefusesAnAtlasThatItDidNotMake) {
  Atlas atlas = Broken("counters-above-ids");
  const RepairReport report = RepairAtlas(atlas);
  TakeBack(report.journal, atlas);
  EXPECT_THROW(TakeBack(report.journal, atlas), Error);
}

TEST(Journal, KeepsEveryBitOfNan) {
  Atlas before = SoundAtlas(Base::kMonocular);
  KeyFrame& keyframe = before.maps[0].keyframes[2];
  const std::uint32_t signalling = 0x7fa00001;
  std::memcpy(&keyframe.merge_scale, &signalling, sizeof(signalling));
  keyframe.preintegration.covariance.setConstant(-std::numeric_limits<float>::denorm_min());
  keyframe.connections.push_back({KeyFrameId(), std::numeric_limits<std::int32_t>::min()});
  Atlas atlas = before;
  KeyFrame& changed = atlas.maps[0].keyframes[2];
  changed.merge_scale = std::numeric_limits<float>::quiet_NaN();
  changed.preintegration.covariance.setZero();
  changed.connections.clear();
  Journal journal;
  AppendChanges(before, atlas, "test", journal);
  ASSERT_EQ(journal.edits.size(), 1u);
  TakeBack(journal, atlas);
  EXPECT_THAT(atlas, EqualsAtlas(before));
}

TEST(Journal, PutsRemovedEntitiesWhereTheyWere) {
  const Atlas before = SoundAtlas(Base::kTwoMaps);
  Atlas atlas = before;
  std::erase_if(atlas.maps[1].points, [](const MapPoint& point) { return point.id.value() % 3 == 0; });
  atlas.maps[1].keyframes.erase(atlas.maps[1].keyframes.begin());
  atlas.maps.erase(atlas.maps.begin());
  Journal journal;
  AppendChanges(before, atlas, "test", journal);
  TakeBack(journal, atlas);
  EXPECT_THAT(atlas, EqualsAtlas(before));
}

// Of every list, at every place, beside removals and changes.
TEST(Journal, TakesAddedEntitiesOut) {
  const Atlas before = SoundAtlas(Base::kTwoMaps);
  Atlas atlas = before;
  std::vector<Map> more = SoundAtlas(Base::kMonocular).maps;
  more[0].id = MapId(77);
  atlas.maps.insert(atlas.maps.begin() + 1, more[0]);
  more[0].id = MapId(78);
  atlas.maps.push_back(more[0]);
  atlas.cameras.insert(atlas.cameras.begin(), atlas.cameras[0]);
  atlas.cameras[0].id = CameraId(9);
  Map& changed = atlas.maps[0];
  changed.keyframes.erase(changed.keyframes.begin() + 1);
  for (std::size_t i = 0; i < 3; ++i) {
    changed.points.insert(changed.points.begin() + static_cast<std::ptrdiff_t>(2 * i), more[0].points[i]);
    changed.points[2 * i].id = MapPointId(1'000'000 + i);
    changed.keyframes.push_back(more[0].keyframes[i]);
    changed.keyframes.back().id = KeyFrameId(1'000'000 + i);
  }
  changed.points[1].position.x() += 1;
  Journal journal;
  AppendChanges(before, atlas, "test", journal);
  EXPECT_GT(std::ranges::count_if(journal.edits, &EntityEdit::added), 9);
  const Journal read = ParseJournal(ToJson(journal));
  EXPECT_EQ(ToJson(read), ToJson(journal));
  TakeBack(read, atlas);
  EXPECT_THAT(atlas, EqualsAtlas(before));
}

TEST(Journal, TakesMovedEntitiesForRemovedAndAdded) {
  const Atlas before = SoundAtlas(Base::kMonocular);
  Atlas atlas = before;
  std::ranges::reverse(atlas.maps[0].points);
  atlas.maps[0].points.pop_back();
  Journal journal;
  AppendChanges(before, atlas, "test", journal);
  TakeBack(journal, atlas);
  EXPECT_THAT(atlas, EqualsAtlas(before));
}

// An entity that is no longer what was added is nothing to take out.
TEST(Journal, RefusesToTakeOutWhatChanged) {
  const Atlas before = SoundAtlas(Base::kMonocular);
  Atlas atlas = before;
  atlas.maps[0].points.push_back(before.maps[0].points[0]);
  atlas.maps[0].points.back().id = MapPointId(1'000'000);
  Journal journal;
  AppendChanges(before, atlas, "test", journal);
  atlas.maps[0].points.back().found_count = 7;
  EXPECT_EQ(KindOf([&] { TakeBack(journal, atlas); }), ErrorKind::kNotPossible);
}

}  // namespace
}  // namespace slamdb
