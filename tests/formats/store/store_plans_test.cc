// SPDX-License-Identifier: BSD-3-Clause
// How a server goes about what is asked of a whole atlas. Its statistics know nothing of an atlas that is new: where
// two tables are joined it takes each side for a row or two, and holds all rows against all.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <span>

#include "slamdb/formats/postgresql/detail/connection.h"
#include "slamdb/formats/postgresql/fleet.h"
#include "slamdb/formats/store/store.h"
#include "slamdb/model/picture_features.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/formats/store/atlases.h"
#include "tests/support/postgresql_server.h"

namespace slamdb::store_test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

class StorePlans : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (PostgresqlServer::IsInstalled())
      server_ = std::make_unique<PostgresqlServer>(
          "session_preload_libraries = auto_explain\nauto_explain.log_min_duration = 0");
  }
  static void TearDownTestSuite() { server_.reset(); }
  void SetUp() override {
    if (!PostgresqlServer::IsInstalled()) GTEST_SKIP() << "postgresql is not installed";
    database_ = server_->MakeDatabase();
    begin_ = static_cast<std::streamoff>(std::filesystem::file_size(log()));
  }

  std::string log() const { return server_->folder() + "/log"; }
  std::string uri() const { return server_->Uri(database_); }
  static Atlas Made(std::uint64_t seed, std::size_t keyframes = 40) {
    return SynthesizeAtlas({.keyframes = keyframes, .points = 10 * keyframes, .features = 60, .seed = seed});
  }
  // Many atlases and what the server knows of them; what comes later it has never seen.
  void SaveOthers() const {
    Store store = Store::OpenForWriting(uri(), {.sync = false});
    for (std::uint64_t seed = 1; seed <= 8; ++seed) store.Save("other" + std::to_string(seed), Made(seed, 8));
  }
  void Analyze(const std::string& database) const { postgresql::Connection(server_->Uri(database)).Execute("ANALYZE"); }
  // All that reads and writes a whole atlas.
  void DoAll() const {
    const Atlas first = Made(20), second = Made(21);
    Store store = Store::OpenForWriting(uri(), {.sync = false});
    store.Save("new", first);
    store.Save("new", second, {.verify = true});
    ExpectEqual(store.Load("new@1"), first);
    ExpectEqual(store.LoadOnto(store.FindRevision("new"), first), second);
    ExpectEqual(store.Load("new", {.selection = {.map = second.maps[0].id}}), second);
    const std::vector<std::span<const Descriptor>> pictures = {second.maps[0].keyframes[3].features.descriptors};
    EXPECT_FALSE(store.PlacesLike(pictures).by_picture.at(0).empty());
    store.Save("new", first);
    EXPECT_EQ(store.GiveUp({.keep = 1}, "new").atlases.at(0).revisions.size(), 2U);
    ExpectEqual(store.Load("new"), first);
  }
  static void ExpectEqual(const Atlas& atlas, const Atlas& other) { EXPECT_EQ(FirstDifference(atlas, other), ""); }

  // The plans, of which there are some, that hold all rows of one side against all of the other.
  std::vector<std::string> QuadraticPlans() const {
    std::ifstream log(this->log());
    log.seekg(begin_);
    std::vector<std::string> plans;
    std::string line, plan;
    std::size_t lines = 0;
    while (std::getline(log, line)) {
      if (line.find("duration:") != std::string::npos) plan.clear();
      plan += line + "\n";
      ++lines;
      if (line.find("Join Filter:") != std::string::npos) plans.push_back(plan);
    }
    EXPECT_GT(lines, 1000U) << "plans are told of";
    return plans;
  }

  static std::unique_ptr<PostgresqlServer> server_;
  std::string database_;
  std::streamoff begin_ = 0;  // of the log of the test
};

std::unique_ptr<PostgresqlServer> StorePlans::server_;

TEST_F(StorePlans, HoldNoRowsAgainstAll) {
  SaveOthers();
  Analyze(database_);
  DoAll();
  EXPECT_THAT(QuadraticPlans(), IsEmpty());
}

TEST_F(StorePlans, HoldNoRowsAgainstAllOnOtherServersEither) {
  const std::string partitions = server_->MakeDatabase();
  InitFleet(uri(), 1, std::vector<std::string>{server_->Uri(partitions)});
  SaveOthers();
  Analyze(database_);
  Analyze(partitions);
  DoAll();
  EXPECT_THAT(QuadraticPlans(), IsEmpty());
}

}  // namespace
}  // namespace slamdb::store_test
