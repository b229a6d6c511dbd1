// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/cli/json_schema.h"
#include "tests/support/cli.h"
#include "tests/support/postgresql_server.h"

namespace slamdb::testing {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kTiny = SLAMDB_FIXTURES "/tiny/tiny.osa";

// Every server of it is another database of one.
TEST(Fleet, IsMadeShownAndMoved) {
  if (!PostgresqlServer::IsInstalled()) GTEST_SKIP() << "postgresql is not installed";
  PostgresqlServer& server = PostgresqlServer::Shared();
  const std::string store = server.Uri(server.MakeDatabase()), one = server.TcpUri(server.MakeDatabase()),
                    two = server.Uri(server.MakeDatabase());
  const ProcessResult made = RunSlamdb({"fleet", "init", store, "--partitions", "2", "--server", one});
  EXPECT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out, AllOf(HasSubstr("PARTITION  SERVER"), HasSubstr("127.0.0.1:"), Not(HasSubstr("S3cret"))));
  EXPECT_EQ(RunSlamdb({"convert", kTiny, store + "#a", "-q"}).exit_code, 0);
  const ProcessResult moved = RunSlamdb({"fleet", "move", store, "--partition", "1", "--to", two, "--json"});
  EXPECT_EQ(moved.exit_code, 0) << moved.err;
  const json report = json::parse(moved.out);
  EXPECT_EQ(BreachOf(report, "fleet.schema.json"), "");
  EXPECT_TRUE(report["partitions"][1]["failure"].is_null());
  EXPECT_THAT(report["partitions"][1]["server"].get<std::string>(), HasSubstr(server.folder()));
  const ProcessResult repaired = RunSlamdb({"fleet", "status", store, "--repair"});
  EXPECT_EQ(repaired.exit_code, 0) << repaired.err;
  EXPECT_THAT(repaired.out, HasSubstr("nothing was left by interrupted writers"));
  EXPECT_EQ(RunSlamdb({"diff", kTiny, store + "#a"}).exit_code, 0);
}

TEST(Fleet, SaysWhatIsMissing) {
  EXPECT_EQ(RunSlamdb({"fleet"}).exit_code, 2);
  EXPECT_EQ(RunSlamdb({"fleet", "init", "postgresql://127.0.0.1:1/db"}).exit_code, 2);
  EXPECT_EQ(RunSlamdb({"fleet", "init", "postgresql://127.0.0.1:1/db", "--partitions", "0"}).exit_code, 2);
  EXPECT_THAT(RunSlamdb({"fleet", "status", "m.db"}).err, HasSubstr("postgresql://"));
}

}  // namespace
}  // namespace slamdb::testing
