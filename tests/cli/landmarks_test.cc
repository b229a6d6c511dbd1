// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include "tests/cli/json_schema.h"
#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

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
  EXPECT_THAT(exported.err, ::testing::Not(HasSubstr("landmarks")));
  const ProcessResult back = RunSlamdb({"landmarks", "to-points", store, "--dry-run"});
  EXPECT_EQ(back.exit_code, 0) << back.err;
  EXPECT_EQ(back.out, "moved 3,162 points, added 0\n");
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
}

TEST(Landmarks, BadUseIsTold) {
  EXPECT_EQ(RunSlamdb({"landmarks"}).exit_code, 2);
  EXPECT_EQ(RunSlamdb({"landmarks", "from-points", kSession, "x.mrpt", "--sigma", "0"}).exit_code, 2);
  const ProcessResult cut =
      RunSlamdb({"landmarks", "to-points", "-", "--from", "mrpt", "--dry-run"}, ReadWholeFile(kMrpt).substr(0, 700));
  EXPECT_EQ(cut.exit_code, 1);
  EXPECT_THAT(cut.err, HasSubstr("byte "));
}

}  // namespace
}  // namespace slamdb::testing
