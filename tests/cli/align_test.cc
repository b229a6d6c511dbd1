// SPDX-License-Identifier: BSD-3-Clause
//
// slamdb align, and merge --align.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <set>

#include "slamdb/edit/ids/id_map.h"
#include "slamdb/formats/formats.h"
#include "slamdb/optimize/bundle_adjustment.h"
#include "tests/cli/json_schema.h"
#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::StartsWith;

// Two sessions of one room, written by ORB-SLAM3; where the second lies in the first is known from the truth.
std::string Fixture(const std::string& name) { return std::string(SLAMDB_FIXTURES) + "/" + name + "/" + name + ".osa"; }
const std::string kFirst = Fixture("session_small_a"), kSecond = Fixture("session_small_b");

class Align : public ::testing::Test {
 protected:
  std::string At(const std::string& name) const { return folder_ / name; }

  // An atlas of another world.
  std::string Stranger() const {
    const ProcessResult made = RunSlamdb({"synthesize", At("other.osa"), "--sensor", "rgbd", "--seed", "7", "-O"});
    EXPECT_EQ(made.exit_code, 0) << made.err;
    return At("other.osa");
  }

  TemporaryFolder folder_;
};

TEST_F(Align, TellsHowOneSessionLiesInAnother) {
  const ProcessResult result = RunSlamdb({"align", kFirst, kSecond});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("session_small_b.osa map 0 in " + kFirst + " map 0: aligned"));
  EXPECT_THAT(result.out, HasSubstr("points matched"));
}

TEST_F(Align, JsonFollowsTheSchema) {
  for (const std::string& second : {kSecond, Stranger()}) {
    const ProcessResult result = RunSlamdb({"align", "--json", kFirst, second});
    const json report = json::parse(result.out);
    EXPECT_EQ(BreachOf(report, "align.schema.json"), "");
    const json& link = report.at("links").at(0);
    EXPECT_EQ(link.at("verdict") == "aligned", second == kSecond);
    EXPECT_EQ(link.at("verdict") == "aligned", result.exit_code == 0);
  }
}

TEST_F(Align, TellsWhichAtlasesOfAStoreANewOneOverlapsWith) {
  const std::string store = At("maps.db");
  for (const auto& [name, atlas] : {std::pair{"second", kSecond}, {"stranger", Stranger()}, {"first", kFirst}})
    ASSERT_EQ(RunSlamdb({"convert", atlas, store + "#" + name, "-q"}).exit_code, 0);
  const ProcessResult text = RunSlamdb({"align", store + "#first", store});
  EXPECT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("maps.db#second map 0 in " + store + "#first map 0: aligned"));
  EXPECT_THAT(text.out, ::testing::Not(HasSubstr("stranger map 0 in " + store + "#first map 0: aligned")));
  const ProcessResult result = RunSlamdb({"align", "--json", Stranger(), store});
  EXPECT_EQ(result.exit_code, 0) << "it is in the store itself";
  const json report = json::parse(result.out);
  EXPECT_EQ(BreachOf(report, "align.schema.json"), "");
  EXPECT_EQ(report.at("searched").at("input"), store);
  EXPECT_EQ(report.at("searched").at("unlike").size() + report.at("inputs").size(), 4U);
  ASSERT_EQ(RunSlamdb({"remove", store + "#stranger"}).exit_code, 0);
  EXPECT_EQ(RunSlamdb({"align", Stranger(), store}).exit_code, 1);
  EXPECT_EQ(RunSlamdb({"align", store}).exit_code, 1);
  EXPECT_EQ(RunSlamdb({"align", kFirst, store, store}).exit_code, 2);
}

TEST_F(Align, TheOtherWayRoundIsTheInverse) {
  const auto transform = [](const std::string& first, const std::string& second) {
    const json report = json::parse(RunSlamdb({"align", "--json", first, second}).out);
    return report.at("links").at(0).at("first_from_second");
  };
  const json there = transform(kFirst, kSecond), back = transform(kSecond, kFirst);
  double dot = 0;  // of one rotation with the inverse of the other
  for (std::size_t i = 0; i < 4; ++i)
    dot +=
        there.at("rotation_xyzw").at(i).get<double>() * back.at("rotation_xyzw").at(i).get<double>() * (i < 3 ? -1 : 1);
  EXPECT_GT(std::abs(dot), std::cos(0.5 * 0.017));  // half a degree
}

TEST_F(Align, IsTheSameForAnyNumberOfThreads) {
  const ProcessResult one = RunSlamdb({"align", "--json", "--threads", "1", kFirst, kSecond});
  const ProcessResult two = RunSlamdb({"align", "--json", "--threads", "2", kFirst, kSecond});
  EXPECT_EQ(one.out, two.out);
}

TEST_F(Align, SavesWhatMergeTakes) {
  ASSERT_EQ(RunSlamdb({"align", kFirst, kSecond, "--save", At("t.txt")}).exit_code, 0);
  const ProcessResult joined =
      RunSlamdb({"merge", kFirst, kSecond, "-o", At("ab.osa"), "--join", "--transform", At("t.txt")});
  EXPECT_EQ(joined.exit_code, 0) << joined.err;
}

TEST_F(Align, SavesNothingThatIsNotSure) {
  EXPECT_EQ(RunSlamdb({"align", kFirst, Stranger(), "--save", At("t.txt")}).exit_code, 1);
  EXPECT_FALSE(std::filesystem::exists(At("t.txt")));
}

TEST_F(Align, NeedsTwoMaps) {
  const ProcessResult result = RunSlamdb({"align", kFirst});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("has only one map with keyframes"));
}

TEST_F(Align, FindsPlacesWithoutTheRecordedWords) {
  EXPECT_EQ(RunSlamdb({"align", kFirst, kSecond, "--own-vocabulary"}).exit_code, 0);
}

TEST_F(Align, MergeMakesOneMapOfBoth) {
  const ProcessResult result =
      RunSlamdb({"merge", kFirst, kSecond, "-o", At("ab.osa"), "--align", "--json", "--id-map", At("ids.csv")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json report = json::parse(result.out);
  EXPECT_EQ(BreachOf(report, "merge.schema.json"), "");
  ASSERT_EQ(report.at("joins").size(), 1U);
  EXPECT_GT(report.at("joins").at(0).at("fused").at("points"), 300);
  const json info = json::parse(RunSlamdb({"info", "--json", At("ab.osa")}).out);
  ASSERT_EQ(info.at("maps").size(), 1U);
  EXPECT_EQ(info.at("maps").at(0).at("keyframes"), 29);
  EXPECT_EQ(RunSlamdb({"check", At("ab.osa")}).exit_code, 0);
  EXPECT_THAT(ReadWholeFile(At("ids.csv")), HasSubstr(kSecond + ",map,0,0\n"));
}

// Also of points that tightening removed.
TEST_F(Align, MergeTellsNoIdThatIsNotThere) {
  ASSERT_EQ(
      RunSlamdb({"merge", kFirst, kSecond, "-o", At("ab.osa"), "--align", "-q", "--id-map", At("ids.csv")}).exit_code,
      0);
  std::set<std::uint64_t> points;
  const Atlas both = ReadAtlas(At("ab.osa"));
  for (const MapPoint& point : both.maps.at(0).points) points.insert(point.id.value());
  std::size_t named = 0;
  for (const IdMap& ids : ParseIdMapsCsv(ReadWholeFile(At("ids.csv"))))
    for (const IdPair& pair : ids[IdKind::kPoint]) {
      if (pair.after == kNoId) continue;
      EXPECT_TRUE(points.contains(pair.after)) << ids.input << " " << pair.before;
      ++named;
    }
  EXPECT_GT(named, points.size());  // two became one where they are fused
}

TEST_F(Align, MergeLeavesACopyOut) {
  const ProcessResult twice = RunSlamdb({"merge", kFirst, kSecond, kFirst, "-o", At("ab.osa"), "--align", "-q"});
  EXPECT_EQ(twice.exit_code, 0) << twice.err;
  EXPECT_EQ(ReadAtlas(At("ab.osa")).maps.at(0).keyframes.size(), 29U);
  const ProcessResult copy = RunSlamdb({"merge", kFirst, kFirst, "-o", At("copy.osa"), "--align"});
  EXPECT_EQ(copy.exit_code, 1);
  EXPECT_THAT(copy.err, HasSubstr("only one map with keyframes"));
  EXPECT_FALSE(std::filesystem::exists(At("copy.osa")));
}

TEST_F(Align, MergeTightensWhatItJoined) {
  const auto optimizations = [&](const std::string& what) {
    const ProcessResult result =
        RunSlamdb({"merge", kFirst, kSecond, "-o", At(what + ".osa"), "--align", "--json", "--optimize", what});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    const json report = json::parse(result.out);
    EXPECT_EQ(BreachOf(report, "merge.schema.json"), "") << what;
    EXPECT_EQ(RunSlamdb({"check", At(what + ".osa")}).exit_code, 0) << what;
    return report.at("optimizations");
  };
  EXPECT_TRUE(optimizations("none").empty());
  if (!CanOptimize()) GTEST_SKIP() << "needs Ceres";
  const json graph = optimizations("pose-graph"), seam = optimizations("seam"), full = optimizations("full");
  ASSERT_EQ(graph.size(), 1U);
  EXPECT_TRUE(graph.at(0).at("bundle").is_null());
  EXPECT_GT(graph.at(0).at("added_observations"), 100);
  ASSERT_EQ(seam.size(), 1U);
  EXPECT_GT(seam.at(0).at("bundle").at("fixed_keyframes"), 1);
  ASSERT_EQ(full.size(), 2U);
  for (const json& round : full)
    EXPECT_LT(round.at("bundle").at("after").at("cost"), round.at("bundle").at("before").at("cost"));
}

TEST_F(Align, MergeSaysWhatTighteningDid) {
  if (!CanOptimize()) GTEST_SKIP() << "needs Ceres";
  const ProcessResult result = RunSlamdb({"merge", kFirst, kSecond, "-o", At("ab.osa"), "--align"});
  EXPECT_THAT(result.out, HasSubstr("  pose graph "));
  EXPECT_THAT(result.out, HasSubstr("  reprojection "));
  EXPECT_THAT(result.out, HasSubstr("observations of points of other maps added"));
}

TEST_F(Align, MergeTightensOnlyWhatItAligned) {
  EXPECT_EQ(RunSlamdb({"merge", kFirst, kSecond, "-o", At("ab.osa"), "--optimize", "full"}).exit_code, 2);
  EXPECT_EQ(RunSlamdb({"merge", kFirst, kSecond, "-o", At("ab.osa"), "--align", "--optimize", "best"}).exit_code, 2);
}

TEST_F(Align, MergeWithoutCeresNamesIt) {
  if (CanOptimize()) GTEST_SKIP() << "Ceres is there";
  const ProcessResult asked = RunSlamdb({"merge", kFirst, kSecond, "-o", At("a.osa"), "--align", "--optimize", "seam"});
  EXPECT_EQ(asked.exit_code, 1);
  EXPECT_THAT(asked.err, HasSubstr("libceres-dev"));
  const ProcessResult usual = RunSlamdb({"merge", kFirst, kSecond, "-o", At("b.osa"), "--align"});
  EXPECT_EQ(usual.exit_code, 0);
  EXPECT_THAT(usual.err, HasSubstr("libceres-dev"));
}

TEST_F(Align, MergeWritesNothingWhereItIsNotSure) {
  const ProcessResult result = RunSlamdb({"merge", kFirst, Stranger(), "-o", At("ab.osa"), "--align", "--force"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("nothing was written"));
  EXPECT_FALSE(std::filesystem::exists(At("ab.osa")));
}

TEST_F(Align, MergeNamesWhatStaysApart) {
  const ProcessResult result =
      RunSlamdb({"merge", kFirst, Stranger(), kSecond, "-o", At("abc.osa"), "--align", "--force"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("other.osa map 0 stays a map of its own"));
  const json info = json::parse(RunSlamdb({"info", "--json", At("abc.osa")}).out);
  EXPECT_EQ(info.at("maps").size(), 2U);
}

}  // namespace
}  // namespace slamdb::testing
