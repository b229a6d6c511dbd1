// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <filesystem>

#include "tests/cli/json_schema.h"
#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string kTwice = SLAMDB_FIXTURES "/mono_small_twice/mono_small_twice.osa";
const std::string kSmall = SLAMDB_FIXTURES "/session_small_a/session_small_a.osa";

class Repair : public ::testing::Test {
 protected:
  std::string In(const std::string& name) const { return folder_ / name; }
  static bool Exists(const std::string& path) { return std::filesystem::exists(path); }

  TemporaryFolder folder_;
};

TEST_F(Repair, MakesAnAtlasSound) {
  EXPECT_EQ(RunSlamdb({"check", kTwice}).exit_code, 1);
  const ProcessResult result = RunSlamdb({"repair", kTwice, In("good.osa")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("map-listed-once"));
  EXPECT_THAT(result.out, HasSubstr("wrote " + In("good.osa")));
  EXPECT_EQ(RunSlamdb({"check", In("good.osa")}).exit_code, 0);
}

TEST_F(Repair, TakesBackByJournalToTheByte) {
  for (const std::string& file : {kTwice, kSmall}) {
    ASSERT_EQ(RunSlamdb({"repair", file, In("good.osa"), "-O", "--journal", In("fix.json")}).exit_code, 0);
    EXPECT_NE(ReadWholeFile(In("good.osa")), ReadWholeFile(file));
    const ProcessResult undone = RunSlamdb({"repair", "--undo", In("fix.json"), In("good.osa"), In("again.osa"), "-O"});
    EXPECT_EQ(undone.exit_code, 0) << undone.err;
    const ProcessResult planned =
        RunSlamdb({"repair", "--undo", In("fix.json"), In("good.osa"), "--dry-run", "--json"});
    EXPECT_EQ(BreachOf(json::parse(planned.out), "undo.schema.json"), "");
    EXPECT_TRUE(json::parse(planned.out).at("output").is_null());
    EXPECT_TRUE(ReadWholeFile(In("again.osa")) == ReadWholeFile(file));
    std::filesystem::remove(In("fix.json"));
  }
}

TEST_F(Repair, JournalRefusesAnotherFile) {
  ASSERT_EQ(RunSlamdb({"repair", kTwice, In("good.osa"), "--journal", In("fix.json")}).exit_code, 0);
  EXPECT_EQ(BreachOf(json::parse(ReadWholeFile(In("fix.json"))), "journal.schema.json"), "");
  const ProcessResult result = RunSlamdb({"repair", "--undo", In("fix.json"), kSmall, In("again.osa")});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("is not the atlas that"));
  EXPECT_FALSE(Exists(In("again.osa")));
  EXPECT_EQ(RunSlamdb({"repair", "--undo", kSmall, In("good.osa"), In("again.osa")}).exit_code, 1);
}

TEST_F(Repair, DryRunWritesNothing) {
  const ProcessResult result = RunSlamdb({"repair", kTwice, "--dry-run", "--journal", In("fix.json")});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out, HasSubstr("would repair"));
  EXPECT_THAT(result.out, Not(HasSubstr("wrote")));
  EXPECT_FALSE(Exists(In("fix.json")));
}

TEST_F(Repair, PicksRules) {
  const ProcessResult result = RunSlamdb({"repair", kTwice, In("good.osa"), "--rule", "map-listed-once", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json report = json::parse(result.out);
  EXPECT_EQ(BreachOf(report, "repair.schema.json"), "");
  ASSERT_EQ(report.at("repairs").size(), 1u);
  EXPECT_EQ(report.at("repairs")[0].at("fix"), "DropRepeatedMaps");
  const ProcessResult unknown = RunSlamdb({"repair", kTwice, In("x.osa"), "--rule", "map-listed-onse"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("did you mean 'map-listed-once'"));
  const ProcessResult none = RunSlamdb({"repair", kTwice, In("x.osa"), "--rule", "pose-finite"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, HasSubstr("has no repair"));
}

TEST_F(Repair, RefusesWhatWouldFailAtTheEnd) {
  WriteWholeFile(In("fix.json"), "mine");
  const ProcessResult result = RunSlamdb({"repair", kTwice, In("good.osa"), "--journal", In("fix.json")});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(ReadWholeFile(In("fix.json")), "mine");
  EXPECT_FALSE(Exists(In("good.osa")));
  EXPECT_EQ(RunSlamdb({"repair", kTwice, kTwice, "-O"}).exit_code, 1);
  EXPECT_EQ(RunSlamdb({"repair", kTwice}).exit_code, 2);
}

}  // namespace
}  // namespace slamdb::testing
