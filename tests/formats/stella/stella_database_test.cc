// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <sqlite3.h>

#include <filesystem>

#include "slamdb/formats/formats.h"
#include "slamdb/formats/stella/detail/pose_matrix.h"
#include "slamdb/formats/stella/detail/stella.h"
#include "tests/formats/formats/in_memory.h"
#include "tests/formats/formats/small_atlas.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::SizeIs;

// A database of a small atlas, which SQL changes.
class StellaDatabase : public ::testing::Test {
 protected:
  StellaDatabase() : path_(folder_.Path("map.db")) {
    WriteAtlas(OneMapAtlas(), path_, {.format = "stella-sqlite", .sync = false});
  }

  void Execute(const std::string& sql) {
    sqlite3* handle = nullptr;
    ASSERT_EQ(sqlite3_open(path_.c_str(), &handle), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(handle, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(handle);
    sqlite3_close(handle);
  }
  Atlas Read() { return ReadAtlas(path_, {}, &notices_); }
  Error ErrorOfRead() {
    return ErrorOf([&] { Read(); });
  }

  const TemporaryFolder folder_;
  const std::string path_;
  Notices notices_;
};

TEST_F(StellaDatabase, IsToldByItsTables) {
  EXPECT_EQ(FormatOfInput({path_, ""}).id, "stella-sqlite");
  EXPECT_FALSE(HoldsNamedAtlases(path_)) << "in spite of its suffix";
  EXPECT_TRUE(HoldsNamedAtlases(folder_.Path("new.db")));
}

TEST_F(StellaDatabase, IsReadAndLeftAsItIs) {
  const std::string before = ReadFile(path_);
  const Atlas atlas = Read();
  EXPECT_THAT(folder_.Names(), ElementsAre("map.db"));
  EXPECT_TRUE(ReadFile(path_) == before);
  ASSERT_THAT(atlas.maps, SizeIs(1));
  EXPECT_EQ(atlas.maps[0].keyframes[0].id, KeyFrameId(1));
  EXPECT_EQ(atlas.maps[0].keyframes[0].features.keypoints[0].response, 20);
  EXPECT_EQ(atlas.maps[0].points[0].observations.size(), 2U);
}

TEST_F(StellaDatabase, OfOldProgramsHasNoMarkers) {
  Execute(
      "ALTER TABLE keyframes DROP COLUMN markers; ALTER TABLE keyframes DROP COLUMN n_markers; DROP TABLE markers; "
      "UPDATE keyframes SET src_frm_id = 50 + id; UPDATE stats SET frame_next_id = 70");
  const Atlas atlas = Read();
  EXPECT_EQ(atlas.maps[0].keyframes[1].frame_id, 53U);
  EXPECT_EQ(atlas.next_ids.frame, 70U);
}

TEST_F(StellaDatabase, CountsMarkersThatItLeavesOut) {
  Execute("INSERT INTO markers(id) VALUES(5), (6); UPDATE keyframes SET n_markers = 2 WHERE id = 3");
  Read();
  EXPECT_THAT(notices_.items(), Contains(Field(&Notice::text, HasSubstr("2 markers, seen 2 times: left out"))));
}

TEST_F(StellaDatabase, IsTheSameOfBytesInMemoryAlsoWithALog) {
  std::string bytes = ReadFile(path_);
  EXPECT_THAT(DecodeAtlas(bytes).maps, SizeIs(1));
  bytes[18] = bytes[19] = 2;  // as a database that has, or had, a write-ahead log
  EXPECT_THAT(DecodeAtlas(bytes).maps, SizeIs(1));
}

TEST_F(StellaDatabase, SaysWhereItIsDamaged) {
  Execute("UPDATE keyframes SET pose_cw = x'00' WHERE id = 3");
  const Error error = ErrorOfRead();
  EXPECT_EQ(error.kind(), ErrorKind::kDamaged);
  EXPECT_EQ(error.place(), "table keyframes, row 3");
  EXPECT_THAT(error.problem(), HasSubstr("pose_cw has 1 bytes, expected 128"));
}

TEST_F(StellaDatabase, ClaimsTakeNoMemory) {
  Execute("UPDATE keyframes SET n_keypts = 2000000000");
  EXPECT_THAT(ErrorOfRead().problem(), HasSubstr("expected 56000000000"));
  Execute("UPDATE keyframes SET n_keypts = -1");
  EXPECT_THAT(ErrorOfRead().problem(), HasSubstr("claims -1 keypoints"));
}

TEST_F(StellaDatabase, IdsAreOf32Bits) {
  Execute("UPDATE landmarks SET id = -5 WHERE id = 10");
  EXPECT_THAT(ErrorOfRead().problem(), HasSubstr("the id is -5"));
}

TEST_F(StellaDatabase, NamesAreKnown) {
  Execute("UPDATE cameras SET model_type = 'Plenoptic'");
  EXPECT_EQ(ErrorOfRead().kind(), ErrorKind::kUnsupported);
}

TEST_F(StellaDatabase, LacksNoTable) {
  Execute("ALTER TABLE associations RENAME TO associations_of_old");
  EXPECT_EQ(ErrorOfRead().place(), "table associations");
}

// What a view would run, nobody wants to.
TEST_F(StellaDatabase, RunsNothingOfTheFile) {
  Execute(
      "ALTER TABLE landmarks RENAME TO points; CREATE VIEW landmarks AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL "
      "SELECT i + 1 FROM n) SELECT i AS id, 0 AS first_keyfrm, x'' AS pos_w FROM n");
  EXPECT_EQ(ErrorOfRead().place(), "table landmarks");
}

TEST_F(StellaDatabase, CutsAreErrors) {
  const std::string bytes = ReadFile(path_);
  for (std::size_t size = 0; size < bytes.size(); size += 512)
    EXPECT_NE(ErrorOf([&] { Decoded(detail::kStellaDatabaseFormat, bytes.substr(0, size)); }).problem(), "no error")
        << size;
}

TEST_F(StellaDatabase, AsIsIsNeverReplaced) {
  EXPECT_THROW(WriteAtlas(OneMapAtlas(), path_, {.format = "stella-sqlite", .overwrite = true}), Error);
}

// Every quaternion of single precision that was normalised in it, up to its sign.
TEST(PoseMatrix, GivesBackTheQuaternionItWasMadeOf) {
  std::uint32_t state = 1;
  const auto next = [&state] {
    state = state * 1664525 + 1013904223;
    return static_cast<float>(state >> 8) / (1 << 23) - 1;
  };
  for (int i = 0; i < 20'000; ++i) {
    Rigid3f pose;
    pose.rotation.coeffs() = Eigen::Vector4f(next(), next() * (i % 3 == 0 ? 1e-3F : 1.0F), next(), next()).normalized();
    if (i == 0) pose.rotation.coeffs() = Eigen::Vector4f(0, 1, 0, 0);
    if (pose.rotation.w() < 0) pose.rotation.coeffs() *= -1;
    Rigid3f back = stella::PoseOf(stella::PoseMatrix(pose));
    if (back.rotation.w() < 0) back.rotation.coeffs() *= -1;
    ASSERT_EQ(back.rotation.coeffs(), pose.rotation.coeffs()) << i;
  }
}

}  // namespace
}  // namespace slamdb
