// SPDX-License-Identifier: BSD-3-Clause
// What a person with `sqlite3` sees.
#include <gmock/gmock.h>

#include <sstream>

#include "slamdb/model/derive.h"
#include "tests/formats/store/atlases.h"

namespace slamdb::store_test {
namespace {

class StoreSql : public ::testing::Test {
 protected:
  std::string Query(const std::string& sql) { return Sql(path_, sql); }

  TemporaryFolder folder_;
  std::string path_ = folder_ / "s.db";
};

TEST_F(StoreSql, MarksOfTheFile) {
  SaveIn(path_, Atlas());
  EXPECT_EQ(Query("PRAGMA application_id"), std::to_string(0x534C4442));
  EXPECT_EQ(Query("PRAGMA user_version"), "7");
}

TEST_F(StoreSql, CameraCentresAndWorldFromCamera) {
  const Atlas atlas = SoundAtlas();
  SaveIn(path_, atlas);
  for (const KeyFrame& keyframe : atlas.maps[1].keyframes) {
    std::istringstream row(
        Query("SELECT printf('%.9g %.9g %.9g %.9g %.9g %.9g %.9g', x, y, z, wc_qw, wc_qx, wc_qy, wc_qz) "
              "FROM v_keyframe_pose WHERE map = " +
              std::to_string(atlas.maps[1].id.value()) + " AND keyframe = " + std::to_string(keyframe.id.value())));
    Eigen::Vector3f centre;
    float w, x, y, z;
    ASSERT_TRUE(row >> centre.x() >> centre.y() >> centre.z() >> w >> x >> y >> z);
    EXPECT_TRUE(centre.isApprox(CameraCenter(keyframe), 1e-4F)) << centre.transpose();
    const Quaternionf inverse = keyframe.camera_from_world.rotation.conjugate();
    EXPECT_TRUE(Quaternionf(w, x, y, z).isApprox(inverse, 1e-5F));
  }
}

TEST_F(StoreSql, PointsAndObservations) {
  const Atlas atlas = SoundAtlas();
  SaveIn(path_, atlas);
  std::size_t observations = 0;
  for (const Map& map : atlas.maps) {
    for (const MapPoint& point : map.points) observations += point.observations.size();
  }
  EXPECT_EQ(Query("SELECT count(*) FROM v_observation"), std::to_string(observations));
  EXPECT_EQ(Query("SELECT sum(observations) FROM v_map_point"), std::to_string(observations));
  const MapPoint& point = atlas.maps[0].points[3];
  const Observation& first = point.observations[0];
  EXPECT_EQ(
      Query("SELECT keyframe, left_keypoint, right_keypoint FROM v_observation WHERE map = " +
            std::to_string(atlas.maps[0].id.value()) + " AND point = " + std::to_string(point.id.value()) + " LIMIT 1"),
      std::to_string(first.keyframe.value()) + "|" + std::to_string(first.left) + "|" + std::to_string(first.right));
}

TEST_F(StoreSql, SoundAtlasHasNoForeignKeyViolations) {
  SaveIn(path_, SoundAtlas());
  EXPECT_EQ(Query("PRAGMA foreign_key_check"), "");
  EXPECT_EQ(Query("PRAGMA integrity_check"), "ok");
}

TEST_F(StoreSql, ForeignKeyCheckShowsWhatDangles) {
  Atlas atlas = SoundAtlas();
  atlas.maps[0].points[2].observations[1].keyframe = KeyFrameId(4711);
  atlas.maps[0].points[4].replaced_by = MapPointId(4712);
  atlas.maps[1].keyframes[3].parent = KeyFrameId(4713);
  SaveIn(path_, atlas);
  const std::string findings = Query("PRAGMA foreign_key_check");
  EXPECT_EQ(std::count(findings.begin(), findings.end(), ';'), 2) << findings;
  EXPECT_THAT(findings, ::testing::HasSubstr("observation|NULL|keyframe"));
  EXPECT_THAT(findings, ::testing::HasSubstr("|map_point|"));
  EXPECT_THAT(findings, ::testing::HasSubstr("|keyframe|"));
  EXPECT_EQ(FirstDifference(LoadFrom(path_), atlas), "");
}

TEST_F(StoreSql, RepeatedIdsAreStoredAndSeen) {
  SaveIn(path_, OddAtlas());
  EXPECT_EQ(Query("SELECT count(*), count(unique_id) FROM keyframe WHERE id = 2"), "4|2");  // two maps
  EXPECT_EQ(Query("SELECT x IS NULL, y, exact IS NOT NULL FROM map_point WHERE id = 3 LIMIT 1"), "1|0.0|1");
}

TEST_F(StoreSql, EveryViewCanBeRead) {
  SaveIn(path_, OddAtlas());
  for (const char* view : {"v_atlas", "v_camera", "v_map", "v_keyframe", "v_keyframe_pose", "v_keyframe_link",
                           "v_map_point", "v_landmark", "v_observation"}) {
    EXPECT_NE(Query(std::string("SELECT count(*) FROM ") + view), "0") << view;
  }
}

}  // namespace
}  // namespace slamdb::store_test
