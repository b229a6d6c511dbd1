// SPDX-License-Identifier: BSD-3-Clause
// SQLite's own check of the R*Tree that box_tree.cc builds without SQLite.
#include <gmock/gmock.h>

#include <cmath>

#include "tests/formats/store/atlases.h"

namespace slamdb::store_test {
namespace {

constexpr const char* kCheck = "SELECT rtreecheck('map_point_box')";
constexpr std::size_t kCellsPerNode = 51;  // SQLite's limit

Atlas PointsOf(std::size_t count) {
  Atlas atlas;
  Map& map = atlas.maps.emplace_back();
  map.id = MapId(0);
  for (std::size_t i = 0; i < count; ++i) {
    MapPoint& point = map.points.emplace_back();
    point.id = MapPointId(i);
    const auto t = static_cast<float>(i);
    point.position = {std::cos(t) * t, std::sin(t) * t, std::fmod(t, 7.0F)};
  }
  return atlas;
}

class BoxTree : public ::testing::TestWithParam<std::size_t> {
 protected:
  // The tree is sound, and finds the points of a box.
  void ExpectSound(const Atlas& atlas) {
    EXPECT_EQ(Sql(path_, kCheck), "ok");
    ReadOptions options;
    options.selection.box = Eigen::AlignedBox3f(Eigen::Vector3f(-20, -20, 1.5F), Eigen::Vector3f(30, 40, 4.5F));
    std::vector<std::uint64_t> expected, found;
    for (const MapPoint& point : atlas.maps[0].points)
      if (options.selection.box->contains(point.position)) expected.push_back(point.id.value());
    const Atlas part = LoadFrom(path_, "a", options);
    for (const MapPoint& point : part.maps[0].points) found.push_back(point.id.value());
    EXPECT_EQ(found, expected);
  }

  TemporaryFolder folder_;
  std::string path_ = folder_ / "s.db";
};

TEST_P(BoxTree, IsSoundWhenItIsBuiltAndAfterItWasChanged) {
  Atlas atlas = PointsOf(GetParam());
  SaveIn(path_, atlas);
  ExpectSound(atlas);
  Column<MapPoint>& points = atlas.maps[0].points;
  for (std::size_t i = 0; i < points.size(); i += 20) points[i].position.x() += 3;  // one by one
  SaveIn(path_, atlas);
  ExpectSound(atlas);
  for (MapPoint& point : points) point.position.y() -= 5;  // anew
  points.pop_back();
  SaveIn(path_, atlas);
  ExpectSound(atlas);
}

// Around the sizes at which a level is full.
INSTANTIATE_TEST_SUITE_P(Sizes, BoxTree,
                         ::testing::Values(1, 2, kCellsPerNode, kCellsPerNode + 1, 2 * kCellsPerNode + 1,
                                           kCellsPerNode* kCellsPerNode, kCellsPerNode* kCellsPerNode + 1, 9000));

TEST(BoxTreeOfOddPoints, IsSound) {
  const TemporaryFolder folder;
  Atlas atlas = PointsOf(500);
  Column<MapPoint>& points = atlas.maps[0].points;
  points[3].position.x() = std::numeric_limits<float>::infinity();
  points[4].position.y() = -std::numeric_limits<float>::infinity();
  points[5].position.z() = std::nanf("");
  points[6].position = points[7].position = points[8].position = {1, 2, 3};
  points[9].position.x() = 1e38F;
  SaveIn(folder / "s.db", atlas);
  EXPECT_EQ(Sql(folder / "s.db", kCheck), "ok");
  EXPECT_EQ(Sql(folder / "s.db", "SELECT count(*) FROM map_point_box"), "499");
}

}  // namespace
}  // namespace slamdb::store_test
