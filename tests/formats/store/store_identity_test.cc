// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <fstream>

#include "slamdb/formats/store/detail/store_format.h"
#include "tests/formats/store/atlases.h"

namespace slamdb::store_test {
namespace {

using ::testing::HasSubstr;

class StoreIdentity : public ::testing::Test {
 protected:
  std::string OpenError() {
    return ErrorOf([this] { Store::Open(path_); });
  }
  std::string WriteError() {
    return ErrorOf([this] { Store::OpenForWriting(path_); });
  }

  TemporaryFolder folder_;
  std::string path_ = folder_ / "s.db";
};

TEST_F(StoreIdentity, ReadingNeverMakesAFile) {
  EXPECT_EQ(OpenError(), path_ + ": no such file");
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

TEST_F(StoreIdentity, Folder) {
  std::filesystem::create_directory(path_);
  EXPECT_THAT(OpenError(), HasSubstr("is a directory"));
  EXPECT_THAT(WriteError(), HasSubstr("is a directory"));
}

TEST_F(StoreIdentity, StandardStream) {
  EXPECT_THAT(ErrorOf([] { Store::Open("-"); }), HasSubstr("cannot be standard input"));
}

TEST_F(StoreIdentity, SomethingElseThanSqlite) {
  std::ofstream(path_)
      << "22 serialization::archive 12 and so on, long enough to be a page of a database or more than that, "
         "to be certain that it is not taken for an empty file, which SQLite would accept";
  const std::string before = FileBytes(path_);
  EXPECT_THAT(OpenError(), HasSubstr("not a store: this is an atlas of ORB-SLAM3"));
  EXPECT_THAT(WriteError(), HasSubstr("not a store: this is an atlas of ORB-SLAM3"));
  EXPECT_EQ(FileBytes(path_), before);
}

TEST_F(StoreIdentity, WhatNobodyKnowsIsNoDatabase) {
  std::ofstream(path_) << std::string(5000, 'x');
  EXPECT_THAT(OpenError(), HasSubstr("not a SQLite database"));
}

TEST_F(StoreIdentity, EmptyFileIsNoStoreButMayBecomeOne) {
  std::ofstream{path_};
  EXPECT_THAT(OpenError(), HasSubstr("an empty database"));
  EXPECT_EQ(WriteError(), "");
  EXPECT_EQ(OpenError(), "");
}

TEST_F(StoreIdentity, DatabasesOfOthersAreNamedAndLeftAlone) {
  const std::pair<const char*, const char*> others[] = {
      {"CREATE TABLE two_view_geometries(a); CREATE TABLE keypoints(a)", "a COLMAP database"},
      {"CREATE TABLE Node(a); CREATE TABLE Link(a)", "an RTAB-Map database"},
      {"CREATE TABLE keyframes(a); CREATE TABLE landmarks(a)", "a stella_vslam map"},
      {"CREATE TABLE topics(a); CREATE TABLE messages(a)", "a ROS 2 bag"},
      {"CREATE TABLE recipes(a)", "the SQLite database of another program"},
      {"PRAGMA application_id=252006674; CREATE TABLE x(a)", "application id 252006674"},
  };
  for (const auto& [sql, owner] : others) {
    std::filesystem::remove(path_);
    Sql(path_, sql);
    const std::string before = FileBytes(path_);
    EXPECT_THAT(OpenError(), HasSubstr(owner));
    EXPECT_THAT(WriteError(), HasSubstr(owner));
    EXPECT_EQ(FileBytes(path_), before);
  }
}

TEST_F(StoreIdentity, NewerStoreIsRefusedWithBothVersions) {
  SaveIn(path_, Atlas());
  Sql(path_, "PRAGMA user_version=8");
  EXPECT_THAT(OpenError(), HasSubstr("store version 8, newest known to this program is 7"));
  EXPECT_THAT(WriteError(), HasSubstr("store version 8, newest known to this program is 7"));
  EXPECT_THAT(ErrorOf([this] { MigrateStore(path_); }),
              HasSubstr("store version 8, newest known to this program is 7"));
}

TEST_F(StoreIdentity, MissingTable) {
  SaveIn(path_, SoundAtlas());
  Sql(path_,
      "DROP TABLE observation; CREATE VIEW observation AS WITH RECURSIVE t(x) AS (SELECT 1 UNION ALL SELECT x FROM t) "
      "SELECT x AS point FROM t");
  EXPECT_THAT(OpenError(), HasSubstr("table observation: missing"));
}

TEST_F(StoreIdentity, Sniffing) {
  SaveIn(path_, Atlas());
  Sql(folder_ / "other.db", "CREATE TABLE x(a)");
  std::ofstream(folder_ / "short.db") << "SQLite format 3";
  EXPECT_TRUE(detail::kStoreFormat.sniff(Probe::Of(path_)));
  EXPECT_FALSE(detail::kStoreFormat.sniff(Probe::Of(folder_ / "other.db")));
  EXPECT_FALSE(detail::kStoreFormat.sniff(Probe::Of(folder_ / "short.db")));
}

TEST_F(StoreIdentity, FormatUsesTheOnlyAtlasOrAsksWhich) {
  Notices notices;
  const std::string unnamed = path_;
  detail::kStoreFormat.write(OddAtlas(), unnamed, {}, notices);
  EXPECT_EQ(FirstDifference(detail::kStoreFormat.read(unnamed, {}, notices), OddAtlas()), "");
  EXPECT_EQ(Store::Open(path_).OnlyName(), "atlas");
  EXPECT_THAT(ErrorOf([&] { detail::kStoreFormat.write(Atlas(), unnamed, {}, notices); }),
              HasSubstr("holds atlases already; name the new one"));
  WriteOptions overwrite;
  overwrite.overwrite = true;
  EXPECT_TRUE(notices.items().empty());
  detail::kStoreFormat.write(OddAtlas(), unnamed, overwrite, notices);
  ASSERT_EQ(notices.items().size(), 1U);
  EXPECT_THAT(notices.items()[0].text, HasSubstr("is there as it is: no new revision"));
  detail::kStoreFormat.write(Atlas(), {path_, "second"}, {}, notices);
  EXPECT_THAT(ErrorOf([&] { detail::kStoreFormat.read(unnamed, {}, notices); }), HasSubstr("it holds atlas, second"));
  EXPECT_THAT(ErrorOf([&] {
                detail::kStoreFormat.read({path_, "third"}, {}, notices);
              }),
              HasSubstr("no atlas named 'third'"));
}

}  // namespace
}  // namespace slamdb::store_test
