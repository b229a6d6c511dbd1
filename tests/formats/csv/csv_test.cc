// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/csv/detail/csv.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/formats/formats/in_memory.h"
#include "tests/formats/formats/small_atlas.h"

namespace slamdb {
namespace {

std::string Write(const Format& format, const Atlas& atlas, Notices& notices) {
  return Encoded(format, atlas, {}, notices);
}

TEST(Csv, WritesPoints) {
  Notices notices;
  EXPECT_EQ(Write(detail::kCsvFormat, SmallAtlas(), notices),
            "x,y,z,nx,ny,nz,observations,reprojection_error,map,id,reference_keyframe,min_distance,max_distance\n"
            "0,0,2,0,0,1,2,2.5,0,10,1,0.5,4\n"
            "0.25,-1.5,1e-05,0,0,1,0,nan,0,12,1,0.5,4\n"
            "0,1,0,0,0,1,1,0,1,20,7,0.5,4\n");
}

TEST(Csv, WritesKeyFrames) {
  Atlas atlas = InertialAtlas();
  atlas.maps[0].keyframes[1].has_velocity = false;
  Notices notices;
  EXPECT_EQ(Write(detail::kCsvKeyFramesFormat, atlas, notices),
            "map,id,timestamp,frame_id,x,y,z,qx,qy,qz,qw,camera,parent,children,connections,loop_edges,merge_edges,"
            "keypoints,map_points,vx,vy,vz\n"
            "0,3,1.5,30,1,0,0,0,0,0,1,0,1,0,1,0,0,1,1,0.5,0,3\n"
            "0,1,0.5,10,0,0,0,0,0,0,1,0,,1,1,0,0,1,1,,,\n");
}

TEST(Csv, LeavesBadKeyFramesOut) {
  Atlas atlas = OneMapAtlas();
  atlas.maps[0].keyframes[0].bad = true;
  Notices notices;
  const std::string text = Write(detail::kCsvKeyFramesFormat, atlas, notices);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2);
  EXPECT_TRUE(notices.items().empty());
  EXPECT_TRUE(notices.written().ends_with(", 1 bad one left out")) << notices.written();
}

TEST(Csv, NamesKeyFramesWithoutPose) {
  Atlas atlas = OneMapAtlas();
  atlas.maps[0].keyframes[0].camera_from_world.rotation.coeffs().setZero();
  Notices notices;
  Write(detail::kCsvKeyFramesFormat, atlas, notices);
  ASSERT_EQ(notices.items().size(), 1U);
  EXPECT_NE(notices.items()[0].text.find("though their pose is none, or not finite: 1 keyframe"), std::string::npos);
}

TEST(Csv, WritesObservations) {
  Atlas atlas = OneMapAtlas();
  atlas.maps[0].points[2].observations = {{.keyframe = KeyFrameId(99), .left = 4, .right = Observation::kAbsent},
                                          {.keyframe = KeyFrameId(1), .left = 77}};
  Notices notices;
  EXPECT_EQ(Write(detail::kCsvObservationsFormat, atlas, notices),
            "map,point,keyframe,left,x,y,octave,error,right,right_x,right_y,right_octave,right_error\n"
            "0,10,1,0,64,48,1,0,,,,,\n"
            "0,10,3,0,17,52,1,5,,,,,\n"
            "0,12,99,4,,,,,,,,,\n"
            "0,12,1,77,,,,,,,,,\n");
}

// What has a row: in every map for itself, whose keyframes may have the ids of another's.
TEST(Csv, CountsWhatIsObserved) {
  Atlas atlas = OneMapAtlas();
  atlas.maps[0].points[2].observations.clear();
  atlas.maps.push_back(atlas.maps[0]);
  atlas.maps[1].id = MapId(5);
  Notices notices;
  const std::string text = Write(detail::kCsvObservationsFormat, atlas, notices);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1 + 4);
  EXPECT_TRUE(notices.written().starts_with("4 observations by 4 keyframes of 2 points, ")) << notices.written();
  ASSERT_TRUE(notices.counts());
  EXPECT_EQ(notices.counts()->keyframes, 4U);
  EXPECT_EQ(notices.counts()->points, 2U);
}

}  // namespace
}  // namespace slamdb
