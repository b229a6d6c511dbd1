// SPDX-License-Identifier: BSD-3-Clause
// Every rule: silent on sound atlases, found on its twin, cleared by its fix.
#include <gmock/gmock.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <ostream>
#include <set>

#include "slamdb/checks/check.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/support/corrupt.h"

namespace slamdb {

std::ostream& operator<<(std::ostream& out, const Twin& twin) { return out << twin.rule; }

namespace {

using ::testing::Contains;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::TestWithParam;
using ::testing::ValuesIn;

constexpr std::uint64_t kWords = 1'000'000;  // the vocabulary of synthetic atlases is a million words or less

std::set<std::string, std::less<>> BrokenRules(const Atlas& atlas) {
  CheckOptions options;
  options.threads = 1;
  options.vocabulary_words = kWords;
  std::set<std::string, std::less<>> ids;
  for (const RuleResult& result : CheckAtlas(atlas, options).results) ids.insert(result.id);
  return ids;
}

std::string Explain(const Atlas& atlas) {
  std::string text;
  for (const RuleResult& result : CheckAtlas(atlas, {}).results)
    text += result.id + ": " + ToString(result.findings[0].place) + ": " + result.findings[0].message + "\n";
  return text;
}

class SoundAtlasTest : public TestWithParam<Base> {};

TEST_P(SoundAtlasTest, HasNoFindings) {
  EXPECT_THAT(BrokenRules(SoundAtlas(GetParam())), IsEmpty()) << Explain(SoundAtlas(GetParam()));
}

TEST_P(SoundAtlasTest, IsLeftAsItIsByEveryFix) {
  for (const Rule& rule : ReadRules()) {
    if (!rule.fix) continue;
    Atlas atlas = SoundAtlas(GetParam());
    EXPECT_EQ(rule.fix.apply(atlas), 0u) << rule.fix.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Bases, SoundAtlasTest,
                         ::testing::Values(Base::kMonocular, Base::kRgbd, Base::kFisheyeStereo, Base::kInertial,
                                           Base::kTwoMaps));

Atlas Broken(const Twin& twin) {
  Atlas atlas = SoundAtlas(twin.base);
  twin.corrupt(atlas);
  return atlas;
}

class TwinTest : public TestWithParam<Twin> {};

TEST_P(TwinTest, IsFoundByItsRuleAndNoOther) {
  const Atlas broken = Broken(GetParam());
  std::set<std::string, std::less<>> allowed{std::string(GetParam().rule)};
  for (const std::string_view also : GetParam().also) allowed.insert(std::string(also));
  const auto found = BrokenRules(broken);
  EXPECT_THAT(found, Contains(std::string(GetParam().rule)));
  for (const std::string& id : found) EXPECT_THAT(allowed, Contains(id)) << Explain(broken);
}

TEST_P(TwinTest, FindingsNameAPlaceAndABreach) {
  for (const RuleResult& result : CheckAtlas(Broken(GetParam()), {.vocabulary_words = kWords}).results) {
    ASSERT_FALSE(result.findings.empty());
    EXPECT_GE(result.count, result.findings.size());
    for (const Finding& finding : result.findings) {
      EXPECT_FALSE(finding.message.empty());
      EXPECT_THAT(finding.message, Not(::testing::EndsWith(".")));
      // What is broken, and not what should hold.
      EXPECT_THAT(finding.message, Not(::testing::HasSubstr(result.title)));
      // The place names an entity; what concerns the atlas as a whole is named in words.
      if (finding.place == Place{}) {
        EXPECT_THAT(finding.message, ::testing::ContainsRegex("vocabulary|next .* id|map|entry|keyframe|point"));
      }
    }
  }
}

class FixTest : public TestWithParam<Twin> {};

TEST_P(FixTest, ClearsItsRuleForGood) {
  const Rule* rule = FindRule(GetParam().rule);
  Atlas atlas = Broken(GetParam());
  EXPECT_GT(rule->fix.apply(atlas), 0u);
  EXPECT_THAT(BrokenRules(atlas), Not(Contains(std::string(rule->id)))) << Explain(atlas);
  EXPECT_EQ(rule->fix.apply(atlas), 0u) << "not idempotent";
}

std::string TwinName(const ::testing::TestParamInfo<Twin>& info) {
  std::string name(info.param.rule);
  std::ranges::replace(name, '-', '_');
  return name + "_" + std::to_string(info.index);
}

// All fixes one after the other, in the order of the catalogue: none breaks what another one repaired.
TEST_P(FixTest, AgreesWithTheOtherFixes) {
  Atlas atlas = Broken(GetParam());
  for (const Rule& rule : ReadRules())
    if (rule.fix) rule.fix.apply(atlas);
  for (const std::string& id : BrokenRules(atlas)) EXPECT_FALSE(FindRule(id)->fix) << id << "\n" << Explain(atlas);
}

std::vector<Twin> FixableTwins() {
  std::vector<Twin> fixable;
  for (const Twin& twin : Twins())
    if (const Rule* rule = FindRule(twin.rule); rule != nullptr && rule->fix) fixable.push_back(twin);
  return fixable;
}
INSTANTIATE_TEST_SUITE_P(Twins, FixTest, ValuesIn(FixableTwins()), TwinName);
INSTANTIATE_TEST_SUITE_P(Twins, TwinTest, ValuesIn(Twins().begin(), Twins().end()), TwinName);

TEST(Catalogue, HasATwinForEveryRule) {
  for (const Rule& rule : ReadRules()) {
    const auto of_rule = [&](const Twin& twin) { return twin.rule == rule.id; };
    EXPECT_TRUE(std::ranges::any_of(Twins(), of_rule)) << rule.id;
  }
}

TEST(Catalogue, SaysWhyThereIsNoFix) {
  for (const Rule& rule : ReadRules()) EXPECT_TRUE(rule.fix || !rule.fix.unfixable.empty()) << rule.id;
}

TEST(Catalogue, HasUniqueKebabCaseIdsAndTitles) {
  std::set<std::string_view> ids, titles;
  for (const Rule& rule : ReadRules()) {
    EXPECT_TRUE(ids.insert(rule.id).second) << rule.id;
    EXPECT_TRUE(titles.insert(rule.title).second) << rule.title;
    EXPECT_FALSE(rule.consequence.empty()) << rule.id;
    EXPECT_TRUE(std::ranges::all_of(rule.id, [](char c) { return (c >= 'a' && c <= 'z') || c == '-'; })) << rule.id;
    EXPECT_EQ(FindRule(rule.id), &rule);
  }
  EXPECT_EQ(FindRule("no-such-rule"), nullptr);
}

// What is told and repaired of a time is its own unit: others of the map neither hide it nor are changed with it.
TEST(TimestampSeconds, AreMendedOneByOne) {
  const Atlas sound = SoundAtlas(Base::kMonocular);
  const std::size_t count = sound.maps[0].keyframes.size();
  const Rule& rule = *std::ranges::find(ReadRules(), "timestamp-seconds", &Rule::id);
  for (const std::size_t wrong : {std::size_t{1}, count / 2, count - 1}) {
    Atlas atlas = sound;
    for (std::size_t row = 0; row < wrong; ++row) atlas.maps[0].keyframes[row].timestamp *= row % 2 == 0 ? 1e9 : 1e3;
    const CheckReport report = CheckAtlas(atlas, {.vocabulary_words = kWords});
    const auto found = std::ranges::find(report.results, "timestamp-seconds", &RuleResult::id);
    ASSERT_NE(found, report.results.end());
    EXPECT_EQ(found->count, wrong);
    for (const Finding& finding : found->findings) EXPECT_TRUE(finding.place.keyframe) << finding.message;
    EXPECT_EQ(rule.fix.apply(atlas), wrong);
    for (std::size_t row = 0; row < count; ++row)
      EXPECT_NEAR(atlas.maps[0].keyframes[row].timestamp, sound.maps[0].keyframes[row].timestamp,
                  row < wrong ? 1e-5 : 0);
  }
}

// A distortion that is not of floats, or not finite, tells nothing of where keypoints belong.
TEST(KeypointUndistorted, AsksNothingOfALensThatCannotBeTold) {
  const auto breaks = [](const std::function<void(Matrix&)>& spoil) {
    Atlas atlas = SoundAtlas(Base::kMonocular);
    for (KeyFrame& keyframe : atlas.maps[0].keyframes) {
      keyframe.features.keypoints[3].x += 0.5F;
      spoil(keyframe.distortion);
    }
    return BrokenRules(atlas);
  };
  EXPECT_THAT(breaks([](Matrix&) {}), Contains("keypoint-undistorted"));
  EXPECT_THAT(breaks([](Matrix& matrix) { matrix.type += 1; }), Not(Contains("keypoint-undistorted")));
  const auto fill = [](Matrix& matrix) { std::ranges::fill(matrix.data, std::byte{0xFF}); };
  EXPECT_THAT(breaks(fill), Not(Contains("keypoint-undistorted")));
}

}  // namespace
}  // namespace slamdb
