// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/layouts/infer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "slamdb/formats/orbslam3/infer_layout.h"
#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/formats/layouts/invented_layouts.h"
#include "tests/formats/orbslam3/real_atlases.h"
#include "tests/support/message_of.h"

namespace slamdb::testing {
namespace {

using ::testing::HasSubstr;

Source In(const std::string& bytes) { return {std::as_bytes(std::span(bytes)), "forged"}; }

Atlas ReadAs(const std::string& bytes, const std::string& layout) {
  Notices notices;
  ReadOptions options;
  options.of<Orbslam3ReadOptions>().layout = layout;
  return ReadOrbslam3(In(bytes), options, notices);
}

const Atlas& RealSession() {
  static const Atlas atlas = [] {
    Notices notices;
    return ReadOrbslam3(SLAMDB_FIXTURES "/session_small_a/session_small_a.osa", {}, notices);
  }();
  return atlas;
}

std::string WrittenIn(const Atlas& atlas, const std::string& layout) {
  Notices notices;
  WriteOptions options;
  options.of<Orbslam3WriteOptions>().layout = layout;
  std::string bytes;
  const auto append = [&](Bytes more) { bytes.append(reinterpret_cast<const char*>(more.data()), more.size()); };
  WriteOrbslam3(atlas, Target(append, "written"), options, notices);
  return bytes;
}

class RealAtlas13 : public ::testing::TestWithParam<const char*> {};
TEST_P(RealAtlas13, IsOfV1) {
  SLAMDB_REQUIRE_REAL_ATLAS(path, GetParam());
  const InferredLayout inferred = InferLayout(path);
  EXPECT_TRUE(inferred.known);
  EXPECT_EQ(inferred.layout.id, "v1.0");
  EXPECT_TRUE(inferred.same_bytes);
  EXPECT_TRUE(inferred.sure());
}
INSTANTIATE_TEST_SUITE_P(InferLayout, RealAtlas13, ::testing::ValuesIn(kRealAtlases));

class KnownLayout : public ::testing::TestWithParam<std::string> {};
TEST_P(KnownLayout, IsTold) {
  const std::string bytes = WrittenIn(RealSession(), GetParam());
  const InferredLayout inferred = InferLayout(In(bytes));
  EXPECT_TRUE(inferred.known);
  EXPECT_EQ(inferred.layout.id, GetParam());
  EXPECT_TRUE(inferred.same_bytes);
}
std::vector<std::string> Ids() {
  std::vector<std::string> ids;
  for (const Layout& layout : KnownLayouts()) ids.push_back(layout.id);
  return ids;
}
INSTANTIATE_TEST_SUITE_P(InferLayout, KnownLayout, ::testing::ValuesIn(Ids()));

// Of layouts that nobody knows: what is found reads the file as its own layout does, or tells look-alikes apart where
// nothing does, and gives the same bytes.
class InventedLayout : public ::testing::TestWithParam<int> {};
TEST_P(InventedLayout, IsReadAndGivenBack) {
  std::mt19937_64 random(static_cast<std::uint64_t>(GetParam()));
  const Invention fork = InventLayout(
      random, {.insertions = 1, .removals = GetParam() % 4 == 3 ? 1 : 0, .classes = {"MapPoint", "KeyFrame"}});
  const std::string bytes = Forge(RealSession(), fork.layout, random);
  const InferredLayout inferred = InferLayout(In(bytes));
  EXPECT_TRUE(inferred.same_bytes) << ::testing::PrintToString(fork.changes);
  EXPECT_TRUE(SameCore(ReadAs(bytes, ToJson(inferred.layout)), ReadAs(bytes, ToJson(fork.layout))))
      << ::testing::PrintToString(fork.changes);
}
INSTANTIATE_TEST_SUITE_P(InferLayout, InventedLayout, ::testing::Range(0, 12));

Layout WithMember(const char* of, const char* behind, LayoutMember member) {
  Layout layout = KnownLayouts().front();
  layout.id = "";
  std::vector<LayoutMember>& members = layout.Find(of)->members;
  const auto at = std::ranges::find(members, behind, &LayoutMember::name);
  members.insert(at + 1, std::move(member));
  return layout;
}

TEST(InferLayout, NamesWhatIsDifferent) {
  std::mt19937_64 random(1);
  const Layout fork = WithMember("MapPoint", "nObs", {"x1", "arr<f64,7>"});
  const InferredLayout inferred = InferLayout(In(Forge(RealSession(), fork, random)));
  EXPECT_FALSE(inferred.known);
  ASSERT_EQ(inferred.differences.size(), 1U);
  EXPECT_EQ(inferred.differences[0], "MapPoint: arr<u8,56> more, between nObs and mWorldPos");
}

TEST(InferLayout, SaysWhatWouldFitAsWell) {
  // A flag among flags may be any of them.
  std::mt19937_64 random(1);
  const Layout fork = WithMember("KeyFrame", "mbNotErase", {"x1", "bool"});
  const InferredLayout inferred = InferLayout(In(Forge(RealSession(), fork, random)));
  EXPECT_FALSE(inferred.sure());
  EXPECT_TRUE(inferred.same_bytes);
}

// A fork with one byte more behind mBackupRefKFId, next to which mbBad stands; `one` in so many of a hundred points.
std::string WithFlags(int percent) {
  Atlas atlas = RealSession();
  atlas.layout = ToJson(WithMember("MapPoint", "mBackupRefKFId", {"x1", "u8"}));
  int row = 0;
  for (MapPoint& point : atlas.maps[0].points)
    point.carried.Make().members.push_back(static_cast<std::byte>(row++ % 100 < percent));
  return EncodeOrbslam3(atlas);
}
std::uint64_t Bad(const Atlas& atlas) {
  return static_cast<std::uint64_t>(
      std::ranges::count_if(atlas.maps[0].points, [](const MapPoint& point) { return bool(point.bad); }));
}

class FlagBesideBad : public ::testing::TestWithParam<int> {};
TEST_P(FlagBesideBad, IsNotTakenForIt) {
  const std::string bytes = WithFlags(GetParam());
  const InferredLayout inferred = InferLayout(In(bytes));
  EXPECT_TRUE(inferred.same_bytes);
  EXPECT_EQ(Bad(ReadAs(bytes, ToJson(inferred.layout))), 0U);
}
INSTANTIATE_TEST_SUITE_P(InferLayout, FlagBesideBad, ::testing::Values(1, 3, 50, 90, 100));

TEST(InferLayout, AnotherLayoutThatFitsCanBeChosen) {
  const std::string bytes = WithFlags(1);
  const InferredLayout first = InferLayout(In(bytes)), second = InferLayout(In(bytes), {.choice = 2});
  ASSERT_FALSE(first.alternatives.empty());
  ASSERT_EQ(second.differences.size(), 1U);
  EXPECT_EQ(second.differences[0], first.alternatives[0]);
  EXPECT_EQ(second.alternatives[0], first.differences[0]);
  EXPECT_TRUE(second.same_bytes);
  EXPECT_GT(Bad(ReadAs(bytes, ToJson(second.layout))), 0U);
  for (const std::size_t choice : {std::size_t{0}, first.alternatives.size() + 2})
    EXPECT_THAT(MessageOf([&] { (void)InferLayout(In(bytes), {.choice = choice}); }), HasSubstr("to choose"));
  EXPECT_THAT(MessageOf([] { (void)InferLayout(In(EncodeOrbslam3(RealSession())), {.choice = 2}); }),
              HasSubstr("1 layout fits"));
}

TEST(InferLayout, FindsAMissingCounter) {
  Layout fork = KnownLayouts().front();
  std::vector<LayoutMember>& members = fork.Find("Atlas")->members;
  std::erase_if(members, [](const LayoutMember& member) { return member.name == "KeyFrame::nNextId"; });
  std::mt19937_64 random(1);
  const InferredLayout inferred = InferLayout(In(Forge(RealSession(), fork, random)));
  ASSERT_EQ(inferred.differences.size(), 1U);
  EXPECT_EQ(inferred.differences[0], "Atlas: no KeyFrame::nNextId");
}

// ---- What is no file of any layout

TEST(InferLayout, RefusesWhatIsCut) {
  const std::string bytes = EncodeOrbslam3(RealSession());
  for (const std::size_t part : {1, 3, 5, 7})
    EXPECT_THAT(MessageOf([&] { (void)InferLayout(In(bytes.substr(0, bytes.size() * part / 8))); }),
                HasSubstr("no layout found"));
}

TEST(InferLayout, RefusesAnArchiveOfNothing) {
  const std::string bytes = EncodeOrbslam3(RealSession());
  EXPECT_THAT(MessageOf([&] { (void)InferLayout(In(bytes.substr(0, 40) + std::string(5000, '\0'))); }),
              HasSubstr("no keyframe was found"));
}

// Grids everywhere, each a keyframe to look at.
TEST(InferLayout, EndsWhereEverythingLooksLikeAKeyframe) {
  std::string bytes = EncodeOrbslam3(RealSession()).substr(0, 40);
  std::mt19937_64 random(1);
  const std::string grid("\x40\0\0\0\x30\0\0\0", 8), first("\5\0\1\0\0\0\0", 7);
  for (int i = 0; i < 200'000; ++i)
    bytes += i % 7 == 0 ? grid : i % 7 == 3 ? first : std::string(1, static_cast<char>(random()));
  EXPECT_THAT(MessageOf([&] { (void)InferLayout(In(bytes)); }), HasSubstr("no layout found"));
}

// Counts and bytes that are changed anywhere lead to a layout or an error, never to the end of memory.
TEST(InferLayout, SurvivesChangedBytes) {
  const Atlas atlas = SynthesizeAtlas({.keyframes = 6, .points = 60, .features = 80, .threads = 1});
  std::mt19937_64 random(1);
  const std::string whole = Forge(atlas, WithMember("KeyFrame", "mnId", {"x1", "vec<f32>"}), random);
  for (int i = 0; i < 5; ++i) {
    std::string bytes = whole;
    for (int change = 0; change <= i % 4; ++change) bytes[random() % bytes.size()] = static_cast<char>(random());
    try {
      EXPECT_GE(InferLayout(In(bytes)).keyframes, 1U);
    } catch (const Error& error) {
      EXPECT_NE(error.kind(), ErrorKind::kInternal) << error.what();
    }
  }
}

TEST(InferLayout, TextOfAnotherLayoutNeedsTheSources) {
  Atlas atlas = RealSession();
  atlas.encoding.text = true;
  const std::string bytes = WrittenIn(atlas, ToJson(WithMember("KeyFrame", "mnId", {"x1", "u64"})));
  const std::string message = MessageOf([&] { (void)InferLayout(In(bytes)); });
  EXPECT_THAT(message, HasSubstr("`DeriveLayoutOfFolder`"));
  EXPECT_THAT(message, ::testing::Not(HasSubstr("`InferLayout`")));
}

TEST(InferLayout, TextIsOfAKnownLayout) {
  Atlas atlas = RealSession();
  atlas.encoding.text = true;
  const InferredLayout inferred = InferLayout(In(WrittenIn(atlas, "visible-found")));
  EXPECT_EQ(inferred.layout.id, "visible-found");
  EXPECT_TRUE(inferred.same_bytes);
}

}  // namespace
}  // namespace slamdb::testing
