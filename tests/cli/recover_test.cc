// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <filesystem>

#include "tests/cli/json_schema.h"
#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

const std::string kSmall = SLAMDB_FIXTURES "/session_small_a/session_small_a.osa";

class RecoverVerb : public ::testing::Test {
 protected:
  std::string In(const std::string& name) const { return folder_ / name; }
  // The first `percent` of the fixture.
  std::string Cut(int percent) const {
    const std::string bytes = ReadWholeFile(kSmall);
    WriteWholeFile(In("cut.osa"), bytes.substr(0, bytes.size() * static_cast<std::size_t>(percent) / 100));
    return In("cut.osa");
  }

  // False: there is no sqlite3 to do it.
  static bool EditInSql(const std::string& store, const std::string& sql) {
    return RunProgram({"sqlite3", store, sql}).exit_code != 127;
  }

  TemporaryFolder folder_;
};

TEST_F(RecoverVerb, SavesWhatIsWholeOfACutFile) {
  const std::string cut = Cut(90);
  EXPECT_EQ(RunSlamdb({"check", cut}).exit_code, 1);
  const ProcessResult result = RunSlamdb({"recover", cut, In("saved.osa"), "--json"});
  EXPECT_EQ(result.exit_code, 3) << result.err;
  const json report = json::parse(result.out);
  EXPECT_EQ(BreachOf(report, "recover.schema.json"), "");
  EXPECT_EQ(report.at("keyframes").at("recovered"), report.at("keyframes").at("listed"));
  EXPECT_LT(report.at("points").at("recovered"), report.at("points").at("listed"));
  EXPECT_GT(report.at("points").at("recovered"), 0);
  EXPECT_EQ(RunSlamdb({"check", In("saved.osa")}).exit_code, 0);
}

TEST_F(RecoverVerb, SaysWhatIsLost) {
  const ProcessResult result = RunSlamdb({"recover", Cut(50), In("saved.osa")});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.out, HasSubstr("keyframes lost"));
  EXPECT_THAT(result.out, HasSubstr("camera 0 lost, and rebuilt"));
  EXPECT_THAT(result.out, HasSubstr("the file is truncated"));
}

// Poses and features are worth saving, but nobody calls them sound.
TEST_F(RecoverVerb, SavesKeyFramesOfWhichNoPointIsLeft) {
  const std::vector<std::string> recover = {"recover", Cut(50), In("saved.osa"), "-O", "--no-triangulate"};
  const ProcessResult text = RunSlamdb(recover);
  EXPECT_EQ(text.exit_code, 3);
  EXPECT_THAT(text.out, HasSubstr("no keyframe sees a point any more, which `slamdb check` finds not sound"));
  std::vector<std::string> with_json = recover;
  with_json.emplace_back("--json");
  const ProcessResult result = RunSlamdb(with_json);
  EXPECT_EQ(result.exit_code, 3);
  const json report = json::parse(result.out);
  EXPECT_EQ(BreachOf(report, "recover.schema.json"), "");
  EXPECT_EQ(report.at("sound"), false);
  EXPECT_EQ(report.at("left").at(0).at("rule"), "atlas-not-empty");
  EXPECT_GT(report.at("keyframes").at("recovered"), 0);
  EXPECT_EQ(RunSlamdb({"check", In("saved.osa")}).exit_code, 1);
}

TEST_F(RecoverVerb, CopiesAWholeFile) {
  const ProcessResult result = RunSlamdb({"recover", kSmall, In("copy.osa")});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out, HasSubstr("the file is whole"));
  EXPECT_TRUE(ReadWholeFile(In("copy.osa")) == ReadWholeFile(kSmall));
}

TEST_F(RecoverVerb, WritesNothingWhereNothingIsLeft) {
  const ProcessResult result = RunSlamdb({"recover", Cut(2), In("saved.osa")});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("no keyframe"));
  EXPECT_FALSE(std::filesystem::exists(In("saved.osa")));
  EXPECT_EQ(RunSlamdb({"recover", Cut(50), "--dry-run"}).exit_code, 3);
  EXPECT_EQ(RunSlamdb({"recover", Cut(50), In("cut.osa"), "-O"}).exit_code, 1);
}

TEST_F(RecoverVerb, ReadsFilesWithoutTheirBeginning) {
  std::string bytes = ReadWholeFile(kSmall);
  bytes.replace(0, 5000, 5000, '\0');
  WriteWholeFile(In("zeros.osa"), bytes);
  EXPECT_THAT(RunSlamdb({"info", In("zeros.osa")}).err, HasSubstr("slamdb recover"));
  const ProcessResult bare = RunSlamdb({"recover", In("zeros.osa"), In("bare.osa")});
  EXPECT_EQ(bare.exit_code, 1) << "the vocabulary is an error that is left";
  EXPECT_THAT(bare.out, HasSubstr("recovered 1 of 1 map, 13 of 14 keyframes, 3,162 of 3,162 points"));
  EXPECT_THAT(bare.out, HasSubstr("the vocabulary's name and checksum lost; `slamdb vocabulary set` stamps them"));
  EXPECT_THAT(bare.out, HasSubstr("map 0: its id and its initial keyframe lost"));
  const ProcessResult taken = RunSlamdb({"recover", In("zeros.osa"), In("taken.osa"), "--cameras", kSmall});
  EXPECT_EQ(taken.exit_code, 3) << taken.err;
  EXPECT_THAT(taken.out, HasSubstr("taken from --cameras"));
  EXPECT_EQ(RunSlamdb({"check", In("taken.osa")}).exit_code, 0);
}

// Pages of a store overwritten in the middle of the file.
TEST_F(RecoverVerb, ReadsWhatADamagedStoreStillHolds) {
  ASSERT_EQ(RunSlamdb({"convert", kSmall, In("lab.db#a")}).exit_code, 0);
  ASSERT_EQ(RunSlamdb({"vacuum", In("lab.db")}).exit_code, 0);
  std::string bytes = ReadWholeFile(In("lab.db"));
  for (std::size_t at = bytes.size() / 3; at < bytes.size() / 3 + 3 * 4096; ++at) bytes[at] = 'x';
  WriteWholeFile(In("lab.db"), bytes);
  EXPECT_EQ(RunSlamdb({"check", In("lab.db#a")}).exit_code, 1);
  const ProcessResult result = RunSlamdb({"recover", In("lab.db#a"), In("saved.osa"), "--json"});
  EXPECT_EQ(result.exit_code, 3) << result.err;
  const json report = json::parse(result.out);
  EXPECT_GT(report.at("keyframes").at("recovered"), 8);
  EXPECT_EQ(RunSlamdb({"check", In("saved.osa")}).exit_code, 0);
}

// What a store holds for which no single row has a hash.
TEST_F(RecoverVerb, SaysWhenCamerasOfAStoreWereEdited) {
  ASSERT_EQ(RunSlamdb({"convert", kSmall, In("lab.db#a")}).exit_code, 0);
  if (!EditInSql(In("lab.db"), "UPDATE camera SET parameters = '[500,500,320,240]'")) GTEST_SKIP() << "no sqlite3";
  const ProcessResult found = RunSlamdb({"recover", In("lab.db#a"), In("saved.osa")});
  EXPECT_EQ(found.exit_code, 3) << found.out;
  EXPECT_THAT(found.out, HasSubstr("table camera"));
  const ProcessResult accepted = RunSlamdb({"recover", In("lab.db#a"), In("accepted.osa"), "--accept-edits"});
  EXPECT_EQ(accepted.exit_code, 0) << accepted.out;
  EXPECT_THAT(accepted.out,
              HasSubstr("accepted as they are, edited outside slamdb\n  the row of table atlas, or some"));
  EXPECT_THAT(RunSlamdb({"check", In("lab.db#a")}).err, HasSubstr("--accept-edits"));
}

TEST_F(RecoverVerb, CountsLostLinksOfAStoreAnew) {
  ASSERT_EQ(RunSlamdb({"convert", kSmall, In("lab.db#a")}).exit_code, 0);
  if (!EditInSql(In("lab.db"), "DELETE FROM keyframe_link WHERE kind = 'covisible'")) GTEST_SKIP() << "no sqlite3";
  const ProcessResult result = RunSlamdb({"recover", In("lab.db#a"), In("saved.osa"), "--json"});
  EXPECT_EQ(result.exit_code, 3) << result.err;
  const json report = json::parse(result.out);
  EXPECT_EQ(report.at("keyframes").at("recovered"), report.at("keyframes").at("listed"));
  const ProcessResult check = RunSlamdb({"check", "-v", In("saved.osa")});
  EXPECT_EQ(check.exit_code, 0);
  EXPECT_THAT(check.out, HasSubstr("note connection-weight (8)")) << "slots and observations differ in eight places";
  EXPECT_THAT(RunSlamdb({"recover", In("lab.db#a"), In("again.osa")}).out,
              HasSubstr("the links of 14 keyframes lost: covisibility counted anew from shared points"));
}

// Who deletes a point wants it gone.
TEST_F(RecoverVerb, MakesNothingAnewWhereEditsAreAccepted) {
  ASSERT_EQ(RunSlamdb({"convert", kSmall, In("lab.db#a")}).exit_code, 0);
  if (!EditInSql(In("lab.db"), "DELETE FROM map_point WHERE row = (SELECT max(row) - 5 FROM map_point)"))
    GTEST_SKIP() << "no sqlite3";
  EXPECT_THAT(RunSlamdb({"recover", In("lab.db#a"), In("anew.osa")}).out, HasSubstr("triangulated anew"));
  const ProcessResult accepted = RunSlamdb({"recover", In("lab.db#a"), In("saved.osa"), "--accept-edits"});
  EXPECT_THAT(accepted.out, HasSubstr("1 point deleted"));
  EXPECT_THAT(accepted.out, ::testing::Not(HasSubstr("triangulated")));
}

}  // namespace
}  // namespace slamdb::testing
