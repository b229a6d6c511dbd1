// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <filesystem>

#include "tests/cli/json_schema.h"
#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

using nlohmann::json;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string kSession = SLAMDB_FIXTURES "/session_small_a/session_small_a.osa";
const std::string kMrpt = SLAMDB_FIXTURES "/mrpt/landmarks.bin";

TEST(Landmarks, AreMadeOfPoints) {
  const TemporaryFolder folder;
  const std::string store = folder / "maps.db";
  const ProcessResult made = RunSlamdb({"landmarks", "from-points", kSession, store, "--json"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const json report = json::parse(made.out);
  EXPECT_EQ(BreachOf(report, "landmarks.schema.json"), "");
  EXPECT_EQ(report["from_points"]["landmarks"], 3162);
  const ProcessResult exported = RunSlamdb({"convert", store, folder / "a.mrpt.gz"});
  EXPECT_EQ(exported.exit_code, 3);
  EXPECT_THAT(exported.err, HasSubstr("mrpt cannot hold keyframe poses"));
  EXPECT_THAT(exported.err, Not(HasSubstr("landmarks")));
  const ProcessResult back = RunSlamdb({"landmarks", "to-points", store, "--dry-run"});
  EXPECT_EQ(back.exit_code, 0) << back.err;
  EXPECT_EQ(back.out, "moved 3,162 points, added 0\n");
}

// They are what was asked for: what the atlas has beside them is no loss.
TEST(Landmarks, OfPointsAloneAreAllThatAFileOfThemIsFor) {
  const TemporaryFolder folder;
  const std::string file = folder / "lab.mrpt";
  const ProcessResult made = RunSlamdb({"landmarks", "from-points", kSession, file});
  EXPECT_EQ(made.exit_code, 0);
  EXPECT_EQ(made.err, "");
  EXPECT_EQ(made.out, "made 3,162 landmarks of points\nwrote " + file + ": 3,162 landmarks\n");
  const ProcessResult less = RunSlamdb({"landmarks", "from-points", kSession, folder / "lab.mrpt3"});
  EXPECT_EQ(less.exit_code, 3);
  EXPECT_THAT(less.err, HasSubstr("mrpt3 cannot hold features of landmarks (3,162)"));
  EXPECT_THAT(less.err, Not(HasSubstr("keyframe")));
}

// What the file could hold is judged, not what the atlas has.
TEST(Landmarks, NoVerbWritesAFileThatHoldsNothingOfTheAtlas) {
  const TemporaryFolder folder;
  const std::string empty = folder / "e.mrpt", archive = folder / "e.osa";
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"convert", kSession, empty},
           {"repair", kSession, empty},
           {"shrink", kSession, empty, "--target-keyframes", "5"},
           {"extract", kSession, empty, "--keyframe", "1,2,3"},
           {"merge", kSession, kSession, "-o", empty, "--on-conflict", "keep-first"}}) {
    const ProcessResult refused = RunSlamdb(words);
    EXPECT_EQ(refused.exit_code, 1) << words[0];
    EXPECT_THAT(refused.err, HasSubstr("which has no landmarks; nothing was written; `slamdb landmarks from-points`"));
    EXPECT_FALSE(std::filesystem::exists(empty)) << words[0];
  }
  for (const std::string& output : {archive, folder / "e.ply", folder / "e.txt"}) {
    const ProcessResult refused = RunSlamdb({"convert", kMrpt, output, "--to",
                                             output == archive         ? "orbslam3"
                                             : output.ends_with("ply") ? "ply"
                                                                       : "tum"});
    EXPECT_EQ(refused.exit_code, 1) << output;
    EXPECT_THAT(refused.err, HasSubstr("would hold nothing of the atlas"));
    EXPECT_FALSE(std::filesystem::exists(output));
  }
}

TEST(Landmarks, ThatAreNotThereAreNoSuccess) {
  const TemporaryFolder folder;
  const std::string none = "has no landmarks; `slamdb landmarks from-points` makes them";
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{folder / "o.osa"}, {folder / "o.osa", "--into", kSession}, {"--dry-run"}}) {
    std::vector<std::string> words = {"landmarks", "to-points", kSession};
    words.insert(words.end(), more.begin(), more.end());
    const ProcessResult refused = RunSlamdb(words);
    EXPECT_EQ(refused.exit_code, 1);
    EXPECT_THAT(refused.err, HasSubstr(none));
  }
  const ProcessResult pointless = RunSlamdb({"landmarks", "from-points", kMrpt, folder / "o.mrpt"});
  EXPECT_EQ(pointless.exit_code, 1);
  EXPECT_FALSE(std::filesystem::exists(folder / "o.mrpt"));
}

TEST(Landmarks, BecomePoints) {
  const TemporaryFolder folder;
  const ProcessResult made = RunSlamdb({"landmarks", "to-points", kMrpt, folder / "a.osa", "--json"});
  EXPECT_EQ(made.exit_code, 3) << made.err;
  EXPECT_THAT(made.err, HasSubstr("orbslam3 cannot hold landmarks (2)"));
  const json report = json::parse(made.out);
  EXPECT_EQ(BreachOf(report, "landmarks.schema.json"), "");
  EXPECT_EQ(report["to_points"]["added"], 2);
}

TEST(Landmarks, OfMrptComeBackByteForByte) {
  const TemporaryFolder folder;
  ASSERT_EQ(RunSlamdb({"convert", kMrpt, folder / "maps.db"}).exit_code, 0);
  ASSERT_EQ(RunSlamdb({"convert", folder / "maps.db", folder / "a.mrpt", "--mrpt-own-slots"}).exit_code, 0);
  EXPECT_EQ(ReadWholeFile(folder / "a.mrpt"), ReadWholeFile(kMrpt));
}

TEST(Landmarks, AloneAreSound) {
  const ProcessResult checked = RunSlamdb({"check", "--strict", kMrpt});
  EXPECT_EQ(checked.exit_code, 0) << checked.out;
  const std::string empty = "\x99mrpt::maps::CLandmarksMap" + std::string(5, '\0') + "\x88";
  EXPECT_THAT(RunSlamdb({"check", "-", "--from", "mrpt3"}, empty).out, Not(HasSubstr("vocabulary")));
}

// A store with the atlas of kSession, a landmark for each of its points, and the map of kMrpt.
std::string StoreOfBoth(const TemporaryFolder& folder) {
  const std::string points = (folder / "both.db") + "#points", both = (folder / "both.db") + "#both";
  EXPECT_EQ(RunSlamdb({"landmarks", "from-points", kSession, points}).exit_code, 0);
  const ProcessResult merged = RunSlamdb({"merge", kMrpt, points, "-o", both});
  EXPECT_EQ(merged.exit_code, 0) << merged.err;
  EXPECT_EQ(merged.err, "") << "landmarks have no vocabulary to differ in";
  return both;
}

std::uint64_t LandmarksIn(const std::string& atlas) {
  const ProcessResult dumped = RunSlamdb({"dump", atlas});
  EXPECT_EQ(dumped.exit_code, 0) << dumped.err;
  std::uint64_t count = 0;
  for (std::size_t at = 0; (at = dumped.out.find("\"type\":\"landmark\"", at)) != std::string::npos; ++at) ++count;
  return count;
}

TEST(Landmarks, SurviveEveryVerbThatKeepsTheirMap) {
  const TemporaryFolder folder;
  const std::string both = StoreOfBoth(folder), out = (folder / "out.db") + "#out";
  const auto kept = [&](std::vector<std::string> words) {
    words.insert(words.end(), {"--overwrite"});
    const ProcessResult result = RunSlamdb(words);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return LandmarksIn(out);
  };
  EXPECT_EQ(LandmarksIn(both), 3164U);
  EXPECT_EQ(RunSlamdb({"check", both}).exit_code, 0) << "the vocabulary is that of the keyframes";
  EXPECT_EQ(kept({"landmarks", "from-points", both, out}), 3164U);
  EXPECT_EQ(kept({"fragments", both, out}), 3164U);
  EXPECT_EQ(kept({"shrink", both, out, "--target-mb", "1"}), 3164U);
  EXPECT_EQ(kept({"cull", both, out}), 3164U);
}

TEST(Landmarks, AloneAreAPartOfTheirOwn) {
  const TemporaryFolder folder;
  const ProcessResult split = RunSlamdb({"split", StoreOfBoth(folder), (folder / "parts.db") + "#part", "--json"});
  ASSERT_EQ(split.exit_code, 0) << split.err;
  ASSERT_EQ(json::parse(split.out)["parts"].size(), 2U);
  EXPECT_EQ(LandmarksIn((folder / "parts.db") + "#part-map-0"), 2U);
}

TEST(Landmarks, AreComparedByDiff) {
  const TemporaryFolder folder;
  const std::string both = StoreOfBoth(folder), points = (folder / "both.db") + "#points";
  EXPECT_EQ(RunSlamdb({"diff", kMrpt, kMrpt}).exit_code, 0);
  const ProcessResult differ = RunSlamdb({"diff", kSession, points});
  EXPECT_EQ(differ.exit_code, 1) << differ.out;
  EXPECT_THAT(differ.out, HasSubstr("landmarks that the other has not"));
}

TEST(Landmarks, TheSameTwiceAreRecognised) {
  const TemporaryFolder folder;
  const ProcessResult merged =
      RunSlamdb({"merge", kMrpt, kMrpt, "-o", folder / "out.db", "--on-conflict", "keep-first"});
  ASSERT_EQ(merged.exit_code, 0) << merged.err;
  EXPECT_EQ(LandmarksIn(folder / "out.db"), 2U);
}

TEST(Landmarks, AreShownAndListed) {
  const TemporaryFolder folder;
  const std::string both = StoreOfBoth(folder);
  const ProcessResult shown = RunSlamdb({"show", kMrpt, "landmark/7", "--json"});
  ASSERT_EQ(shown.exit_code, 0) << shown.err;
  EXPECT_EQ(json::parse(shown.out)["seen_count"], 5);
  const ProcessResult listed = RunSlamdb({"list", folder / "both.db"});
  EXPECT_THAT(listed.out, ContainsRegex("both +2 +stereo or RGB-D +[0-9]+ +[0-9,]+ +3,164 "));
  const ProcessResult merged = RunSlamdb({"merge", kMrpt, both, "-o", folder / "out.db", "--dry-run"});
  EXPECT_THAT(merged.out, ContainsRegex("result .* 3,166"));
}

// What another program did to landmarks, back on the atlas.
TEST(Landmarks, GoBackOntoTheAtlasTheyCameFrom) {
  const TemporaryFolder folder;
  ASSERT_EQ(RunSlamdb({"landmarks", "from-points", kSession, folder / "lab.mrpt", "--quiet"}).exit_code, 0);
  const ProcessResult same =
      RunSlamdb({"landmarks", "to-points", folder / "lab.mrpt", "--into", kSession, folder / "same.osa"});
  EXPECT_EQ(same.exit_code, 0) << same.err;
  EXPECT_EQ(same.out, "moved 3,162 points to their landmarks, of which 3,162 were there already\nwrote " +
                          (folder / "same.osa") + "\n");
  EXPECT_EQ(ReadWholeFile(folder / "same.osa"), ReadWholeFile(kSession));
  ASSERT_EQ(RunSlamdb({"transform", folder / "lab.mrpt", folder / "moved.mrpt", "--by", "1 2 3 0 0 0 1"}).exit_code, 0);
  const ProcessResult moved = RunSlamdb(
      {"landmarks", "to-points", folder / "moved.mrpt", "--into", kSession, (folder / "a.db") + "#moved", "--json"});
  EXPECT_EQ(moved.exit_code, 0) << moved.err;
  const json report = json::parse(moved.out);
  EXPECT_EQ(BreachOf(report, "landmarks.schema.json"), "");
  EXPECT_EQ(report["into"]["moved"], 3162);
  EXPECT_EQ(report["into"]["same"], 0);
  EXPECT_EQ(LandmarksIn((folder / "a.db") + "#moved"), 3162U);
  EXPECT_THAT(RunSlamdb({"diff", kSession, (folder / "a.db") + "#moved"}).out, HasSubstr("changed: position 3,162"));
}

TEST(Landmarks, AreLaidOntoAnAtlasThatHasAName) {
  EXPECT_EQ(RunSlamdb({"landmarks", "to-points", "a.mrpt", "out.osa", "--into", ""}).exit_code, 2);
}

TEST(Landmarks, ThatTheAtlasDoesNotHaveAreNamed) {
  const TemporaryFolder folder;
  const ProcessResult laid = RunSlamdb({"landmarks", "to-points", kMrpt, "--into", kSession, folder / "a.osa"});
  EXPECT_THAT(laid.err, ContainsRegex("landmarks? left out, since .* has no point of the id: "));
  EXPECT_EQ(RunSlamdb({"landmarks", "to-points", kMrpt, "--into", kSession, kSession, "-O"}).exit_code, 1);
  EXPECT_EQ(RunSlamdb({"landmarks", "to-points", kMrpt, folder / "b.osa", "--add"}).exit_code, 2);
}

TEST(Landmarks, OfTwoMapsBecomeOne) {
  const TemporaryFolder folder;
  ASSERT_EQ(RunSlamdb({"landmarks", "from-points", kSession, folder / "lab.mrpt", "--quiet"}).exit_code, 0);
  const auto join = [&](std::vector<std::string> more) {
    std::vector<std::string> words{
        "merge", folder / "lab.mrpt", folder / "lab.mrpt", "-o", folder / "c.mrpt", "--join", "--json", "-O"};
    words.insert(words.end(), more.begin(), more.end());
    const ProcessResult joined = RunSlamdb(words);
    EXPECT_EQ(joined.exit_code, 0) << joined.err;
    const json report = json::parse(joined.out);
    EXPECT_EQ(BreachOf(report, "merge.schema.json"), "");
    return report["join"];
  };
  const json fused = join({});
  EXPECT_EQ(fused["landmarks"], 3162);
  const auto unplaced = fused["alike_landmarks"]["unplaced"].get<std::uint64_t>() / 2;
  EXPECT_EQ(fused["fused_landmarks"].get<std::uint64_t>() + unplaced, 3162U) << "each finds itself again";
  EXPECT_EQ(LandmarksIn(folder / "c.mrpt"), 3162 + unplaced);
  EXPECT_EQ(join({"--no-fuse"})["fused_landmarks"], 0);
  EXPECT_EQ(LandmarksIn(folder / "c.mrpt"), 6324U);
}

TEST(Landmarks, AreOfNoKeyFrame) {
  const TemporaryFolder folder;
  const ProcessResult converted = RunSlamdb({"convert", kMrpt, folder / "a.mrpt", "--keyframes", "3:"});
  EXPECT_EQ(converted.exit_code, 0) << converted.err;
  EXPECT_THAT(converted.err, HasSubstr("landmarks belong to no keyframe"));
}

TEST(Landmarks, InFrontOfACutAreRecovered) {
  const TemporaryFolder folder;
  ASSERT_EQ(RunSlamdb({"landmarks", "from-points", kSession, folder / "a.mrpt.gz", "--quiet"}).exit_code, 0);
  for (const std::string input : {"a.mrpt", "a.mrpt3", "a.mrpt.gz"}) {
    if (input != "a.mrpt.gz") RunSlamdb({"convert", folder / "a.mrpt.gz", folder / input});
    const std::string whole = ReadWholeFile(folder / input);
    WriteWholeFile(folder / ("cut_" + input), whole.substr(0, whole.size() / 2));
    const ProcessResult result = RunSlamdb({"recover", folder / ("cut_" + input), folder / ("got_" + input), "--json"});
    EXPECT_EQ(result.exit_code, 3) << result.err;
    const json landmarks = json::parse(result.out).at("landmarks");
    EXPECT_NEAR(landmarks.at("recovered").get<double>(), 1581, input == "a.mrpt.gz" ? 200 : 2) << input;
    EXPECT_EQ(landmarks.at("listed"), 3162);
    EXPECT_EQ(RunSlamdb({"check", folder / ("got_" + input)}).exit_code, 0);
  }
}

TEST(Landmarks, BadUseIsTold) {
  EXPECT_EQ(RunSlamdb({"landmarks"}).exit_code, 2);
  EXPECT_EQ(RunSlamdb({"landmarks", "from-points", kSession, "x.mrpt", "--sigma", "0"}).exit_code, 2);
  EXPECT_EQ(RunSlamdb({"landmarks", "from-points", kSession, "x.mrpt", "--sigma", "nan"}).exit_code, 2);
  const ProcessResult cut =
      RunSlamdb({"landmarks", "to-points", "-", "--from", "mrpt", "--dry-run"}, ReadWholeFile(kMrpt).substr(0, 700));
  EXPECT_EQ(cut.exit_code, 1);
  EXPECT_THAT(cut.err, HasSubstr("byte "));
}

}  // namespace
}  // namespace slamdb::testing
