// SPDX-License-Identifier: BSD-3-Clause
// One test for each kind of what is no database of RTAB-Map's.
#include <gmock/gmock.h>

#include <cstring>
#include <filesystem>
#include <limits>

#include "slamdb/formats/formats.h"
#include "slamdb/formats/rtabmap/detail/rtabmap.h"
#include "tests/formats/rtabmap/forge.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using ::testing::HasSubstr;

class RtabmapDamage : public ::testing::Test {
 protected:
  RtabmapDamage() : path_(folder_.Path("map.db")), forge_(path_, "0.21.4") { AddDrive(forge_, "0.21.4"); }

  Error ErrorOfRead() {
    return ErrorOf([&] { static_cast<void>(ReadAtlas(path_)); });
  }
  void SetBlob(const std::string& update, const Blob& blob) { forge_.Bind("UPDATE " + update, blob); }

  const TemporaryFolder folder_;
  const std::string path_;
  Forge forge_;
};

TEST_F(RtabmapDamage, VersionsMustBeKnown) {
  forge_.Execute("UPDATE Admin SET version = '0.10.9'");
  EXPECT_EQ(ErrorOfRead().kind(), ErrorKind::kUnsupported);
  for (const char* version : {"", "new", "1.2", "0.21.x", "0.-1.2", "0.99999999999.1"}) {
    forge_.Execute("UPDATE Admin SET version = '" + std::string(version) + "'");
    EXPECT_EQ(ErrorOfRead().kind(), ErrorKind::kDamaged) << version;
  }
  forge_.Execute("DELETE FROM Admin");
  EXPECT_EQ(ErrorOfRead().kind(), ErrorKind::kDamaged);
}

TEST_F(RtabmapDamage, PosesHave12Numbers) {
  SetBlob("Node SET pose = ? WHERE id = 3", Blob(47, 1));
  const Error error = ErrorOfRead();
  EXPECT_EQ(error.place(), "table Node, row 3");
  EXPECT_THAT(error.problem(), HasSubstr("a pose has 47 bytes, expected 48"));
}

TEST_F(RtabmapDamage, PosesThatAreNoneAreLeftOut) {
  SetBlob("Node SET pose = ? WHERE id = 3", Blob(48, 0));
  SetBlob("Node SET pose = ? WHERE id = 2", Blob(48, 0xff));
  EXPECT_EQ(ReadAtlas(path_).maps[0].keyframes.size(), 2U);
}

TEST_F(RtabmapDamage, CalibrationsHoldWhatTheyClaim) {
  const Blob sound = CalibrationBlob("0.21.4", {{}});
  const auto broken = [&](std::size_t at, int value) {
    Blob blob = sound;
    std::memcpy(blob.data() + 4 * at, &value, 4);
    SetBlob("Data SET calibration = ? WHERE id = 2", blob);
    return ErrorOfRead();
  };
  EXPECT_EQ(broken(6, 0x7fffffff).place(), "table Data, row 2");
  EXPECT_THAT(broken(6, 0x7fffffff).problem(), HasSubstr("claims 2147483647 numbers"));
  EXPECT_THAT(broken(9, -1).problem(), HasSubstr("claims -1 numbers"));
  EXPECT_THAT(broken(3, 5).problem(), HasSubstr("a camera is of type 5"));
  EXPECT_EQ(broken(10, 11).kind(), ErrorKind::kDamaged) << "4 bytes are left";
  for (std::size_t size = 1; size < sound.size(); size += 3) {
    SetBlob("Data SET calibration = ? WHERE id = 2",
            Blob(sound.begin(), sound.begin() + static_cast<std::ptrdiff_t>(size)));
    EXPECT_EQ(ErrorOfRead().kind(), ErrorKind::kDamaged) << size;
  }
}

TEST_F(RtabmapDamage, ANodeHasNotAnyNumberOfCameras) {
  SetBlob("Data SET calibration = ? WHERE id = 2", CalibrationBlob("0.21.4", std::vector<ForgedCamera>(65)));
  EXPECT_THAT(ErrorOfRead().problem(), HasSubstr("has 65 cameras, expected at most 64"));
}

TEST_F(RtabmapDamage, OptimisedPosesAreMatricesOfOneLength) {
  const std::vector<int> ids = {1, 2};
  const Blob two = MatrixBlob(ids.data(), 8, 1, 2, 4);
  SetBlob("Admin SET opt_ids = ?", two);
  EXPECT_THAT(ErrorOfRead().problem(), HasSubstr("has 0 numbers of poses for 2 nodes"));
  SetBlob("Admin SET opt_poses = ?", two);
  EXPECT_THAT(ErrorOfRead().problem(), HasSubstr("a matrix has OpenCV's type 4, expected 5"));
  SetBlob("Admin SET opt_ids = ?", Blob(11, 0));
  EXPECT_THAT(ErrorOfRead().problem(), HasSubstr("cut"));
  Blob bomb = two;
  const int many = 0x7fffffff;
  std::memcpy(bomb.data() + bomb.size() - 12, &many, 4);
  SetBlob("Admin SET opt_ids = ?", bomb);
  EXPECT_THAT(ErrorOfRead().problem(), HasSubstr("cannot hold"));
  Blob garbage = two;
  garbage[3] ^= 0xff;
  SetBlob("Admin SET opt_ids = ?", garbage);
  EXPECT_THAT(ErrorOfRead().problem(), HasSubstr("cannot be unpacked"));
  SetBlob("Admin SET opt_ids = ?", MatrixBlob(ids.data(), 8, 1, 3, 4));
  EXPECT_THAT(ErrorOfRead().problem(), HasSubstr("cannot be unpacked")) << "of another length";
}

TEST_F(RtabmapDamage, ReferencesToNothingAreCounted) {
  forge_.Execute("INSERT INTO Link(from_id, to_id, type) VALUES(1, 99, 1), (-5, 2, 8), (3, 3, 7), (1, 2, 77)");
  forge_.Execute("UPDATE Feature SET node_id = 99 WHERE node_id = 2");
  forge_.Execute("INSERT INTO Node(id, map_id) VALUES(-3, 0), (0, 0), (3000000000, 0)");
  forge_.Execute("UPDATE Feature SET word_id = -7 WHERE node_id = 3");
  Notices notices;
  const Atlas atlas = ReadAtlas(path_, {}, &notices);
  std::string told;
  for (const Notice& notice : notices.items()) told += notice.text + "\n";
  EXPECT_THAT(told, HasSubstr("12 features of nodes that are no keyframes"));
  EXPECT_THAT(told, HasSubstr("3 links that join no two nodes"));
  EXPECT_THAT(told, HasSubstr("3 nodes whose id no node can have"));
  EXPECT_EQ(atlas.maps[0].points[0].observations.size(), 2U);
}

TEST_F(RtabmapDamage, NumbersThatAreNoneAreRead) {
  forge_.Execute("UPDATE Feature SET pos_x = 9e999, octave = -123456789, size = -1, dir = 'north' WHERE node_id = 2");
  forge_.Execute("UPDATE Feature SET depth_x = 9e999, octave = 65791 WHERE node_id = 3");
  forge_.Execute("UPDATE Node SET stamp = NULL, map_id = -8 WHERE id = 4");
  EXPECT_EQ(ReadAtlas(path_).maps.size(), 1U);
}

// NaN and zeros are how RTAB-Map says that it has no pose.
TEST_F(RtabmapDamage, PosesThatCanBeNoneAreRefused) {
  const auto error_of = [&](float scale, float x) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation().x() = static_cast<double>(x);
    pose.linear() *= static_cast<double>(scale);
    SetBlob("Node SET pose = ? WHERE id = 3", PoseBlob(pose));
    return ErrorOfRead();
  };
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  EXPECT_EQ(error_of(1, 1).problem(), "no error");
  EXPECT_EQ(error_of(1, std::numeric_limits<float>::quiet_NaN()).problem(), "no error");
  EXPECT_EQ(error_of(0, 0).problem(), "no error");
  EXPECT_THAT(error_of(3, 0).problem(), HasSubstr("(row by row) is no rotation"));
  EXPECT_THAT(error_of(1, kInfinity).problem(), HasSubstr("the position inf 0 0 is not finite"));
  EXPECT_EQ(error_of(1, 1e30F).place(), "table Node, row 3");
}

TEST_F(RtabmapDamage, NumbersThatNoCameraHasAreRefused) {
  const auto error_of = [&](const ForgedCamera& camera) {
    SetBlob("Data SET calibration = ? WHERE id = 2", CalibrationBlob("0.21.4", {camera}));
    return ErrorOfRead();
  };
  EXPECT_EQ(error_of({}).problem(), "no error");
  EXPECT_EQ(error_of({.f = 0, .cx = 0, .cy = 0}).problem(), "no error") << "not calibrated";
  EXPECT_THAT(error_of({.f = 0}).problem(), HasSubstr("the focal lengths 0 0"));
  EXPECT_EQ(error_of({.width = 0, .height = 0}).problem(), "no error") << "not recorded";
  EXPECT_THAT(error_of({.f = -100}).problem(), HasSubstr("the focal lengths -100"));
  EXPECT_THAT(error_of({.f = std::numeric_limits<float>::quiet_NaN()}).problem(), HasSubstr("the focal lengths nan"));
  EXPECT_THAT(error_of({.cx = std::numeric_limits<float>::infinity()}).problem(),
              HasSubstr("the camera's numbers inf"));
  EXPECT_THAT(error_of({.width = 1 << 21}).problem(), HasSubstr("images of 2097152 x 96"));
  EXPECT_THAT(error_of({.height = -1}).problem(), HasSubstr("images of 128 x -1"));
}

// A word that is everywhere costs no more than one of a few places.
TEST_F(RtabmapDamage, AWordOfManyPlacesIsSoonGivenUp) {
  forge_.Execute(
      "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 100000) INSERT INTO "
      "Feature(node_id, word_id, pos_x, pos_y, size, dir, response, octave, depth_x, depth_y, depth_z) SELECT 1, "
      "1, i % 128, i % 96, 1, 0, 0, 0, 1 + i / 50.0, i % 37, i % 41 FROM n");
  EXPECT_GE(ReadAtlas(path_).maps[0].points.size(), static_cast<std::size_t>(kPoints) - 1);
}

TEST_F(RtabmapDamage, RunsNothingOfTheFile) {
  forge_.Execute(
      "ALTER TABLE Node RENAME TO Old; CREATE VIEW Node AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i "
      "+ 1 FROM n) SELECT i AS id, 0 AS map_id, 0 AS stamp, x'' AS pose FROM n");
  Notices ignored;
  const auto read = [&] { detail::kRtabmapFormat.read(Source(path_), {}, ignored); };
  EXPECT_EQ(ErrorOf(read).place(), "table Node");
}

TEST_F(RtabmapDamage, CutsAreErrors) {
  const std::string bytes = ReadFile(path_);
  for (std::size_t size = 0; size < bytes.size(); size += 1500) {
    Notices ignored;
    const std::string cut = folder_.Make("cut.db", bytes.substr(0, size));
    const std::string problem = ErrorOf([&] { detail::kRtabmapFormat.read(Source(cut), {}, ignored); }).problem();
    EXPECT_NE(problem, "no error") << size;
  }
}

TEST_F(RtabmapDamage, LacksNoTable) {
  forge_.Execute("DROP TABLE Feature");
  EXPECT_EQ(ErrorOfRead().place(), "table Map_Node_Word");
}

TEST_F(RtabmapDamage, AnEmptyOneIsAnEmptyAtlas) {
  forge_.Execute("DELETE FROM Node; DELETE FROM Data; DELETE FROM Feature; DELETE FROM Link");
  EXPECT_TRUE(ReadAtlas(path_).maps.empty());
}

}  // namespace
}  // namespace slamdb
