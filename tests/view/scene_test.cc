// SPDX-License-Identifier: BSD-3-Clause
// What stands in the columns of a page is what the atlas holds.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "slamdb/formats/formats.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/reprojection.h"
#include "tests/support/corrupt.h"
#include "tests/view/page_data.h"

namespace slamdb::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::Pair;

class ViewScene : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!HasViewPage()) GTEST_SKIP() << "built without esbuild";
  }
};

// The row of a keyframe of the only map, or -1.
std::int64_t RowOf(const Map& map, KeyFrameId id) {
  const auto found = std::ranges::find(map.keyframes, id, &KeyFrame::id);
  return !id || found == map.keyframes.end() ? -1 : found - map.keyframes.begin();
}

void ExpectPoints(const Atlas& atlas, const PageData& page) {
  std::vector<Eigen::Vector3d> steps;
  const std::vector<Eigen::Vector3d> positions = page.Positions(&steps);
  const std::vector<std::uint64_t> ids = page.PointIds();
  const std::vector<std::vector<std::int64_t>> seen = page.Seen();
  const std::vector<std::int64_t> references = page.References();
  const std::vector<double> errors = page.Errors();
  std::size_t row = 0;
  std::int64_t first_keyframe = 0;
  for (const Map& map : atlas.maps) {
    const Reprojection reprojection(atlas, map);
    const auto scene_row = [&](KeyFrameId id) {
      const std::int64_t own = RowOf(map, id);
      return own < 0 ? own : own + first_keyframe;
    };
    for (const MapPoint& point : map.points) {
      ASSERT_LT(row, ids.size());
      EXPECT_EQ(ids[row], point.id.value());
      for (int axis = 0; axis < 3; ++axis)
        ASSERT_NEAR(positions[row][axis], point.position[axis],
                    steps[row][axis] * 0.5 + 1e-6 * std::abs(point.position[axis]))
            << ToString(point.id);
      std::vector<std::int64_t> observers;
      for (const Observation& observation : point.observations)
        if (const std::int64_t observer = scene_row(observation.keyframe); observer >= 0) observers.push_back(observer);
      std::ranges::sort(observers);
      ASSERT_EQ(seen[row], observers) << ToString(point.id);
      ASSERT_EQ(references[row], scene_row(point.reference));
      const double error = reprojection.Mean(point), most = page.header.at("error_max");
      if (!std::isnan(error)) {
        // v is the root of the error in 127 steps: half a step in the root is that much in the error.
        const double root = std::sqrt(std::min(error, most) / most);
        ASSERT_NEAR(errors[row], std::min(error, most), most * (2 * root * 0.5 / 127 + 0.25 / 127 / 127) + 1e-6);
      }
      ++row;
    }
    first_keyframe += static_cast<std::int64_t>(map.keyframes.size());
  }
  EXPECT_EQ(row, ids.size());
  EXPECT_EQ(seen.size(), row);
}

void ExpectKeyFrames(const Atlas& atlas, const PageData& page) {
  const std::vector<std::array<float, 7>> poses = page.Poses();
  const std::vector<double> times = page.Times();
  const std::vector<std::uint64_t> ids = page.KeyFrameIds(), cameras = page.Varints("keyframes/camera");
  const std::vector<std::int64_t> parents = page.Parents();
  const double origin = std::stod(page.header.at("origin_of_time").get<std::string>());
  std::size_t row = 0;
  for (const Map& map : atlas.maps) {
    const auto first = static_cast<std::int64_t>(row);
    for (const KeyFrame& keyframe : map.keyframes) {
      EXPECT_EQ(ids.at(row), keyframe.id.value());
      EXPECT_NEAR(times[row] + origin, keyframe.timestamp, 1e-6);
      const Eigen::Vector3f center = CameraCenter(keyframe);
      EXPECT_TRUE(Eigen::Vector3f(poses[row].data()).isApprox(center, 1e-6F) || center.norm() < 1e-6F);
      const Quaternionf rotation(poses[row][6], poses[row][3], poses[row][4], poses[row][5]);
      EXPECT_LT((rotation * keyframe.camera_from_world.rotation).vec().norm(), 1e-5F);
      const std::int64_t parent = RowOf(map, keyframe.parent);
      EXPECT_EQ(parents[row], parent < 0 ? -1 : parent + first);
      ASSERT_GT(cameras[row], 0U);
      EXPECT_EQ(page.header.at("cameras").at(cameras[row] - 1).at("id"), keyframe.camera.value());
      ++row;
    }
  }
  EXPECT_EQ(row, ids.size());
}

void ExpectEdges(const Atlas& atlas, const PageData& page) {
  std::vector<CovisibilityOfPage> edges;
  std::int64_t first = 0;
  for (const Map& map : atlas.maps) {
    for (std::size_t i = 0; i < map.keyframes.size(); ++i)
      for (const Connection& connection : map.keyframes[i].connections) {
        const std::int64_t other = RowOf(map, connection.keyframe);
        if (other > static_cast<std::int64_t>(i))
          edges.push_back(
              {first + static_cast<std::int64_t>(i), first + other, static_cast<std::uint64_t>(connection.weight)});
      }
    first += static_cast<std::int64_t>(map.keyframes.size());
  }
  std::ranges::sort(edges, {}, [](const CovisibilityOfPage& edge) { return std::pair(edge.first, edge.second); });
  EXPECT_EQ(page.Covisibility(), edges);
}

TEST_F(ViewScene, HoldsPointsKeyFramesAndEdges) {
  for (const Base base : {Base::kMonocular, Base::kRgbd, Base::kFisheyeStereo, Base::kInertial, Base::kTwoMaps}) {
    const Atlas& atlas = SoundAtlas(base);
    const PageData page = DataOf(atlas);
    ExpectPoints(atlas, page);
    ExpectKeyFrames(atlas, page);
    ExpectEdges(atlas, page);
  }
}

TEST_F(ViewScene, HoldsARealAtlas) {
  const char* folder = std::getenv("SLAMDB_ATLASES");
  if (folder == nullptr) GTEST_SKIP() << "SLAMDB_ATLASES names no folder";
  for (const char* name : {"session_a.osa", "multimap_rgbd.osa", "stereo_inertial.osa"}) {
    const Atlas atlas = ReadAtlas((std::filesystem::path(folder) / name).string());
    const PageData page = DataOf(atlas);
    ExpectPoints(atlas, page);
    ExpectKeyFrames(atlas, page);
  }
}

TEST_F(ViewScene, KeypointsAreThoseOfTheImage) {
  const Atlas& atlas = SoundAtlas(Base::kMonocular);
  const Map& map = atlas.maps[0];
  const auto keypoints = DataOf(atlas, {.keypoints = ViewKeypoints::kAll}).Keypoints();
  const auto matched = DataOf(atlas, {.keypoints = ViewKeypoints::kMatched}).Keypoints();
  ASSERT_EQ(keypoints.size(), map.keyframes.size());
  for (std::size_t k = 0; k < keypoints.size(); ++k) {
    const KeyFrame& keyframe = map.keyframes[k];
    ASSERT_EQ(keypoints[k].size(), keyframe.features.undistorted.size());
    std::size_t with_point = 0;
    for (std::size_t i = 0; i < keypoints[k].size(); ++i) {
      const double x = double{keyframe.features.undistorted[i].x} - keyframe.bounds.min_x;
      EXPECT_NEAR(keypoints[k][i].x, std::max(x, 0.0), 1.0 / 16);
      const auto point = std::ranges::find(map.points, keyframe.features.map_points[i], &MapPoint::id);
      const bool none = !keyframe.features.map_points[i] || point == map.points.end();
      EXPECT_EQ(keypoints[k][i].point, none ? -1 : point - map.points.begin());
      with_point += none ? 0 : 1;
    }
    EXPECT_EQ(matched[k].size(), with_point);
  }
  EXPECT_TRUE(DataOf(atlas, {.keypoints = ViewKeypoints::kNone}).Keypoints().empty());
}

TEST_F(ViewScene, StrayPointsCoarsenNoOther) {
  Atlas atlas = SoundAtlas(Base::kMonocular);
  std::vector<Eigen::Vector3d> steps;
  DataOf(atlas).Positions(&steps);
  const double before = steps[1].maxCoeff();
  atlas.maps[0].points[0].position = Eigen::Vector3f(1e6F, -3, 5);
  const PageData page = DataOf(atlas);
  const Eigen::Vector3d stray = page.Positions(&steps)[0];
  EXPECT_EQ(stray, Eigen::Vector3d(1e6, -3, 5));
  EXPECT_LT(steps[1].maxCoeff(), 1.1 * before);
  EXPECT_TRUE(page.Hidden().empty()) << "it is where it is";
}

TEST_F(ViewScene, LoopAndMergeEdgesOnceEach) {
  Atlas atlas = SoundAtlas(Base::kMonocular);
  Map& map = atlas.maps[0];
  for (KeyFrame& keyframe : map.keyframes) keyframe.loop_edges.clear();
  map.keyframes[1].loop_edges = {map.keyframes[5].id};
  map.keyframes[5].loop_edges = {map.keyframes[1].id};
  map.keyframes[4].loop_edges = {map.keyframes[2].id};  // one side alone
  map.keyframes[0].merge_edges = {map.keyframes[3].id, KeyFrameId(4711), map.keyframes[0].id};
  const PageData page = DataOf(atlas);
  EXPECT_THAT(page.Pairs("edges/loop"), ElementsAre(Pair(1, 5), Pair(2, 4)));
  EXPECT_THAT(page.Pairs("edges/merge"), ElementsAre(Pair(0, 3)));
}

TEST_F(ViewScene, NormalsAreUnitVectors) {
  Atlas atlas = SoundAtlas(Base::kMonocular);
  atlas.maps[0].points[0].normal = Eigen::Vector3f(0, 0, 0.5F);
  atlas.maps[0].points[1].normal = Eigen::Vector3f(-1, 0, 0);
  atlas.maps[0].points[2].normal = Eigen::Vector3f(0, 0, -1);
  atlas.maps[0].points[3].normal.setConstant(std::nanf(""));
  EXPECT_FALSE(DataOf(atlas).Has("points/normal"));
  const std::vector<std::uint8_t> normals = DataOf(atlas, {.normals = true}).OneByte("points/normal");
  ASSERT_EQ(normals.size(), 2 * atlas.maps[0].points.size());
  EXPECT_THAT((std::vector<int>(normals.begin(), normals.begin() + 8)), ElementsAre(0, 0, 129, 0, 127, 127, 0, 0));
}

TEST_F(ViewScene, SeveralAtlasesLieBehindEachOther) {
  const Atlas &first = SoundAtlas(Base::kTwoMaps), &second = SoundAtlas(Base::kMonocular);
  const PageData page = DataOf({&first, &second}, {.layout = ViewLayout::kSideBySide});
  EXPECT_EQ(page.header.at("layout"), "side-by-side");
  std::size_t point = 0, keyframe = 0;
  for (const auto& atlas : page.header.at("atlases"))
    for (const auto& map : atlas.at("maps")) {
      EXPECT_EQ(map.at("first_point"), point);
      EXPECT_EQ(map.at("first_keyframe"), keyframe);
      point += map.at("points").get<std::size_t>();
      keyframe += map.at("keyframes").get<std::size_t>();
    }
  EXPECT_EQ(page.points(), point);
  EXPECT_EQ(page.keyframes(), keyframe);
  EXPECT_EQ(page.header.at("cameras").size(), first.cameras.size() + second.cameras.size());
  EXPECT_EQ(page.Varints("keyframes/camera").back(), first.cameras.size() + 1);
}

TEST_F(ViewScene, SaysWhichMapsAreMetric) {
  const auto metric = "/atlases/0/maps/0/metric"_json_pointer;
  EXPECT_EQ(DataOf(SoundAtlas(Base::kMonocular)).header.at(metric), false);
  EXPECT_EQ(DataOf(SoundAtlas(Base::kRgbd)).header.at(metric), true);
  Atlas initialised = SoundAtlas(Base::kMonocular);
  initialised.maps[0].imu_initialized = true;
  EXPECT_EQ(DataOf(initialised).header.at(metric), true);
}

TEST_F(ViewScene, SaysWhichWayIsUp) {
  const auto inertial = DataOf(SoundAtlas(Base::kInertial)).header.at("/atlases/0/maps/0"_json_pointer);
  EXPECT_NEAR(inertial["up"][2].get<double>(), 1, 0.01);
  EXPECT_EQ(inertial["up_method"], "inertia");
  const auto monocular = DataOf(SoundAtlas(Base::kMonocular)).header.at("/atlases/0/maps/0"_json_pointer);
  EXPECT_NEAR(monocular["up"][1].get<double>(), -1, 0.02);
  EXPECT_EQ(monocular["up_method"], "cameras");
  EXPECT_NEAR(monocular["upright"][0].get<double>(), -std::sqrt(0.5), 0.01) << "a quarter of a turn about x";
  EXPECT_NEAR(monocular["upright"][3].get<double>(), std::sqrt(0.5), 0.01);
}

}  // namespace
}  // namespace slamdb::testing
