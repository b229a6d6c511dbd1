// SPDX-License-Identifier: BSD-3-Clause
// Atlases may hold anything: the page shows what can be shown.
#include <gmock/gmock.h>

#include <limits>

#include "tests/support/corrupt.h"
#include "tests/view/page_data.h"

namespace slamdb::testing {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr float kInfinity = std::numeric_limits<float>::infinity(),
                kNotANumber = std::numeric_limits<float>::quiet_NaN();

class ViewDamage : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!HasViewPage()) GTEST_SKIP() << "built without esbuild";
  }
  Atlas atlas = SoundAtlas(Base::kMonocular);
  Map& map = atlas.maps[0];
};

TEST_F(ViewDamage, PositionsThatAreNoneAreHidden) {
  map.points[0].position.y() = kNotANumber;
  map.points[1].position.setConstant(kInfinity);
  map.points[2].bad = true;
  map.points[3].position.setConstant(3.4e38F);
  map.points[4].position.setConstant(-3.4e38F);
  const PageData page = DataOf(atlas);
  const std::vector<std::uint8_t> hidden = page.Hidden();
  EXPECT_THAT((std::vector<int>(hidden.begin(), hidden.begin() + 6)), ElementsAre(1, 1, 2, 0, 0, 0));
  EXPECT_EQ(page.Positions()[3], Eigen::Vector3d::Constant(3.4e38F));
  for (std::size_t row = 5; row < page.points(); ++row)
    EXPECT_LT((page.Positions()[row] - map.points[row].position.cast<double>()).norm(), 0.05);
  EXPECT_EQ(page.OneByte("points/error")[0], 0);
}

TEST_F(ViewDamage, ABlockOfNothingElseIsHidden) {
  for (MapPoint& point : map.points) point.position.setConstant(kNotANumber);
  EXPECT_THAT(DataOf(atlas).Hidden(), Each(1));
  for (MapPoint& point : map.points) point.position.setConstant(7);
  EXPECT_THAT(DataOf(atlas).Positions(), Each(Eigen::Vector3d(7, 7, 7)));
}

TEST_F(ViewDamage, PosesThatAreNoneAreFlagged) {
  map.keyframes[1].camera_from_world.translation.x() = kNotANumber;
  map.keyframes[2].camera_from_world.rotation.coeffs().setZero();
  map.keyframes[3].camera_from_world.rotation.coeffs().setConstant(3e38F);
  map.keyframes[4].bad = true;
  map.keyframes[5].timestamp = std::numeric_limits<double>::quiet_NaN();
  const PageData page = DataOf(atlas);
  const std::vector<std::uint8_t> flags = page.OneByte("keyframes/flags");
  EXPECT_EQ(flags[0] & 2, 0);
  for (const int row : {1, 2, 3}) {
    EXPECT_EQ(flags[row] & 2, 2) << row;
    EXPECT_THAT(page.Poses()[row], ElementsAre(0, 0, 0, 0, 0, 0, 1)) << row;
  }
  EXPECT_EQ(flags[4] & 1, 1);
  EXPECT_TRUE(std::isnan(page.Times()[5]));
  EXPECT_EQ(page.Times()[0], 0);
}

TEST_F(ViewDamage, ReferencesToNothingAreLeftOut) {
  map.points[0].observations.push_back({KeyFrameId(4711), 1, -1});
  map.points[0].observations.push_back(map.points[0].observations[0]);
  map.points[0].reference = KeyFrameId(4711);
  map.points[1].observations.clear();
  map.points[1].reference = KeyFrameId();
  map.keyframes[3].parent = KeyFrameId(4711);
  map.keyframes[3].connections.push_back({KeyFrameId(4711), 100});
  map.keyframes[3].camera = CameraId(99);
  const std::size_t observers = SoundAtlas(Base::kMonocular).maps[0].points[0].observations.size();
  const PageData page = DataOf(atlas);
  EXPECT_EQ(page.Seen()[0].size(), observers);
  EXPECT_THAT(page.Seen()[1], IsEmpty());
  EXPECT_EQ(page.References()[0], -1);
  EXPECT_EQ(page.References()[1], -1);
  EXPECT_EQ(page.Parents()[3], -1);
  EXPECT_EQ(page.Varints("keyframes/camera")[3], 0U);
  EXPECT_EQ(page.Covisibility(), DataOf(SoundAtlas(Base::kMonocular)).Covisibility());
}

TEST_F(ViewDamage, IdsAreKeptToTheLastBit) {
  map.points[0].id = MapPointId(~std::uint64_t{0} - 1);
  map.points[1].id = MapPointId();
  map.points[2].id = map.points[3].id;
  map.keyframes[0].id = KeyFrameId(std::uint64_t{1} << 63);
  const PageData page = DataOf(atlas);
  for (std::size_t row = 0; row < 4; ++row) EXPECT_EQ(page.PointIds()[row], map.points[row].id.value());
  EXPECT_EQ(page.KeyFrameIds()[0], std::uint64_t{1} << 63);
}

TEST_F(ViewDamage, NothingIsAPageToo) {
  const PageData none = DataOf(Atlas());
  EXPECT_EQ(none.points(), 0U);
  EXPECT_THAT(none.header.at("/atlases/0/maps"_json_pointer), IsEmpty());
  Atlas empty;
  empty.maps.resize(2);
  empty.maps[1].id = MapId(5);
  const PageData page = DataOf(empty);
  EXPECT_TRUE(page.header.at("/atlases/0/maps/0/id"_json_pointer).is_null());
  EXPECT_EQ(page.header.at("/atlases/0/maps/1/id"_json_pointer), 5);
  EXPECT_EQ(DataOf(std::vector<const Atlas*>()).header.at("atlases").size(), 0U);
}

// Every way in which a rule is broken, in which nothing may fall over, is shown where it is.
TEST_F(ViewDamage, FindingsStandAtWhatTheyAreOf) {
  for (const Twin& twin : Twins()) {
    Atlas broken = SoundAtlas(twin.base);
    twin.corrupt(broken);
    const PageData page = DataOf(broken, {.notes = true});
    const auto& findings = page.header.at("findings");
    EXPECT_TRUE(std::ranges::any_of(findings, [&](const auto& finding) { return finding.at("rule") == twin.rule; }))
        << twin.rule;
    const std::vector<std::uint64_t> points = page.PointIds(), keyframes = page.KeyFrameIds();
    for (const auto& finding : findings) {
      const std::int64_t row = finding.at("row");
      if (row < 0) continue;
      const std::string kind = finding.at("kind");
      if (kind == "camera") continue;
      EXPECT_EQ(std::to_string((kind == "point" ? points : keyframes).at(row)), finding.at("id")) << finding;
    }
  }
}

TEST_F(ViewDamage, FindingsTellPlaceRuleAndConsequence) {
  for (std::size_t i = 0; i < 3; ++i) map.points[i].reference = KeyFrameId(4711);
  const PageData page = DataOf({&atlas, &atlas}, {.max_findings = 2});
  const auto& rules = page.header.at("rules");
  const auto rule = std::ranges::find_if(rules, [](const auto& found) { return found.at("count") == 6; });
  ASSERT_NE(rule, rules.end()) << rules;
  EXPECT_FALSE(rule->at("title").get<std::string>().empty());
  EXPECT_FALSE(rule->at("consequence").get<std::string>().empty());
  std::vector<std::string> places;
  for (const auto& finding : page.header.at("findings"))
    if (finding.at("rule") == rule->at("id")) places.push_back(finding.at("place"));
  const std::string of_map = ToString(map.id) + ", ";
  const std::string first = of_map + ToString(map.points[0].id), second = of_map + ToString(map.points[1].id);
  EXPECT_THAT(places, ElementsAre(first, second, first, second)) << "of both atlases, one behind the other";
}

TEST_F(ViewDamage, FindingsOfBothAtlasesAreInTheirRows) {
  map.points[8].reference = KeyFrameId(4711);
  const Atlas& sound = SoundAtlas(Base::kTwoMaps);
  const PageData page = DataOf({&sound, &atlas});
  std::size_t first = 0;
  for (const Map& of_sound : sound.maps) first += of_sound.points.size();
  const auto& findings = page.header.at("findings");
  const auto found = std::ranges::find_if(
      findings, [](const auto& finding) { return finding.at("text").dump().find("4711") != std::string::npos; });
  ASSERT_NE(found, findings.end());
  EXPECT_EQ(found->at("atlas"), 1);
  EXPECT_EQ(found->at("map"), sound.maps.size());
  EXPECT_EQ(found->at("row"), first + 8);
}

TEST_F(ViewDamage, NotesAreToldWhenAskedFor) {
  map.keyframes[1].merge_scale = kNotANumber;  // uninitialised memory, as every healthy file has
  EXPECT_THAT(DataOf(atlas).header.at("findings"), IsEmpty());
  EXPECT_EQ(DataOf(atlas).header.at("findings_left_out"), 0);
  const auto findings = DataOf(atlas, {.notes = true}).header.at("findings");
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].at("severity"), "note");
}

TEST_F(ViewDamage, FindingsAreCutOffAndCounted) {
  for (MapPoint& point : map.points) point.reference = KeyFrameId(4711);
  const PageData page = DataOf(atlas, {.max_findings = 3});
  EXPECT_GE(page.header.at("findings_left_out").get<std::size_t>(), map.points.size() - 3);
  EXPECT_THAT(DataOf(atlas, {.check = false}).header.at("findings"), IsEmpty());
}

}  // namespace
}  // namespace slamdb::testing
