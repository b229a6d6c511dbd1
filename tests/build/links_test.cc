// SPDX-License-Identifier: BSD-3-Clause
// Links are set on both sides, and what follows from observations is what an independent computation says.
#include "slamdb/build/links.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <random>

#include "slamdb/base/error.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/build/taken_apart.h"

namespace slamdb {
namespace {

using ::testing::Contains;

class Links : public ::testing::TestWithParam<Sensor> {
 protected:
  const KeyFrame& KeyFrameOf(KeyFrameId id) const { return *std::ranges::find(map_.keyframes, id, &KeyFrame::id); }

  Atlas atlas_ =
      SynthesizeAtlas({.sensor = GetParam(), .keyframes = 14, .points = 300, .features = 220, .loops = false});
  Map& map_ = atlas_.maps[0];
  std::mt19937 random_{3};
};

TEST_P(Links, ParentsStayATree) {
  for (int i = 0; i < 200; ++i) {
    const KeyFrame& child = map_.keyframes[random_() % map_.keyframes.size()];
    const KeyFrame& parent = map_.keyframes[random_() % map_.keyframes.size()];
    bool is_ancestor = child.id == map_.first_keyframe;  // of itself, by way of the child
    for (KeyFrameId at = parent.id; at; at = KeyFrameOf(at).parent) is_ancestor = is_ancestor || at == child.id;
    try {
      SetParents(map_, std::array{KeyFrameEdge(child.id, parent.id)});
      EXPECT_FALSE(is_ancestor);
      EXPECT_EQ(child.parent, parent.id);
      EXPECT_THAT(parent.children, Contains(child.id));
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kUsage);
      EXPECT_TRUE(is_ancestor) << error.what();
    }
  }
  EXPECT_EQ(TroublesOf(atlas_), "") << "one tree, both sides";
}

TEST_P(Links, EdgesAreOnBothSidesAndKept) {
  for (const auto& [kind, list] :
       {std::pair(EdgeKind::kLoop, &KeyFrame::loop_edges), std::pair(EdgeKind::kMerge, &KeyFrame::merge_edges)}) {
    const KeyFrameId one = map_.keyframes[1].id, other = map_.keyframes[11].id;
    EXPECT_EQ(AddEdges(map_, kind, std::array{KeyFrameEdge(other, one), KeyFrameEdge(one, other)}), 1U);
    EXPECT_THAT(KeyFrameOf(one).*list, ::testing::ElementsAre(other));
    EXPECT_THAT(KeyFrameOf(other).*list, ::testing::ElementsAre(one));
    EXPECT_TRUE(KeyFrameOf(one).not_erase && KeyFrameOf(other).not_erase);
    EXPECT_THAT(EdgesOf(map_, kind), ::testing::ElementsAre(KeyFrameEdge(one, other)));
  }
  EXPECT_EQ(TroublesOf(atlas_), "");
}

TEST_P(Links, ReferencesSetRanges) {
  MapPoint& point = *std::ranges::max_element(map_.points, {}, [](const MapPoint& p) { return p.observations.size(); });
  for (const Observation& seen : point.observations) {
    SetReferences(map_, std::array{std::pair(point.id, seen.keyframe)});
    EXPECT_EQ(point.reference, seen.keyframe);
    const KeyFrame& keyframe = KeyFrameOf(seen.keyframe);
    const double distance = (point.position - keyframe.camera_from_world.Normalized().Center()).cast<double>().norm();
    EXPECT_NEAR(static_cast<double>(point.max_distance / point.min_distance), std::pow(1.2, 7), 1e-3);
    const double octave = std::log(static_cast<double>(point.max_distance) / distance) / std::log(1.2);
    EXPECT_NEAR(octave, std::round(octave), 1e-3);
    EXPECT_GE(octave, -1e-3);
  }
}

// From poses, keypoints and descriptors alone.
class Expected {
 public:
  Expected(const Map& map, const MapPoint& point) {
    std::map<std::uint64_t, const KeyFrame*> keyframes;
    for (const KeyFrame& keyframe : map.keyframes) keyframes[keyframe.id.value()] = &keyframe;
    for (const Observation& seen : point.observations) {
      const KeyFrame& keyframe = *keyframes.at(seen.keyframe.value());
      const Eigen::Isometry3d pose = WorldFromLeft(keyframe);
      if (seen.left >= 0) See(point, keyframe, seen.left, pose.translation());
      if (seen.right >= 0) See(point, keyframe, seen.right, pose * Isometry(keyframe.left_from_right).translation());
    }
    normal /= static_cast<double>(descriptors_.size());
  }

  // How far the descriptor is from the others in the median; the least of all.
  int MedianOf(const Descriptor& descriptor) const {
    std::vector<int> distances;
    for (const Descriptor& other : descriptors_) {
      int bits = 0;
      for (std::size_t i = 0; i < other.size(); ++i)
        bits += std::popcount(static_cast<unsigned>(descriptor[i] ^ other[i]));
      distances.push_back(bits);
    }
    std::ranges::sort(distances);
    return distances[(distances.size() - 1) / 2];
  }
  int LeastMedian() const {
    int least = 256;
    for (const Descriptor& each : descriptors_) least = std::min(least, MedianOf(each));
    return least;
  }
  bool Has(const Descriptor& descriptor) const { return std::ranges::count(descriptors_, descriptor) > 0; }

  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  int weight = 0;

 private:
  static Eigen::Isometry3d Isometry(const Rigid3f& transform) {
    Eigen::Isometry3d isometry(transform.rotation.cast<double>().normalized());
    isometry.pretranslate(transform.translation.cast<double>());
    return isometry;
  }
  static Eigen::Isometry3d WorldFromLeft(const KeyFrame& keyframe) {
    return Isometry(keyframe.camera_from_world).inverse();
  }

  void See(const MapPoint& point, const KeyFrame& keyframe, std::int32_t row, const Eigen::Vector3d& center) {
    const auto at = static_cast<std::size_t>(row);
    normal += (point.position.cast<double>() - center).normalized();
    descriptors_.push_back(keyframe.features.descriptors[at]);
    weight += keyframe.features.left_count < 0 && keyframe.features.right_x[at] >= 0 ? 2 : 1;
  }

  std::vector<Descriptor> descriptors_;
};

TEST_P(Links, UpdatedPointsAreWhatTheirObserversSay) {
  std::vector<std::uint32_t> rows;
  for (std::uint32_t row = 0; row < map_.points.size(); row += 2) {
    MapPoint& point = map_.points[row];
    point.position += Eigen::Vector3f(0.1F, -0.2F, 0.05F);
    point.normal.setZero();
    point.descriptor = {};
    point.observation_count = 99;
    rows.push_back(row);
  }
  const Map before = map_;
  UpdatePoints(map_, rows);
  for (std::uint32_t row = 0; row < map_.points.size(); ++row) {
    const MapPoint& point = map_.points[row];
    if (row % 2 == 1) {
      EXPECT_EQ(point.normal, before.points[row].normal);
      EXPECT_EQ(point.max_distance, before.points[row].max_distance);
      continue;
    }
    const Expected expected(map_, point);
    EXPECT_LE((point.normal.cast<double>() - expected.normal).norm(), 1e-5);
    EXPECT_EQ(point.observation_count, expected.weight);
    EXPECT_TRUE(expected.Has(point.descriptor));
    EXPECT_EQ(expected.MedianOf(point.descriptor), expected.LeastMedian());
  }
}

TEST_P(Links, CovisibilityIsWhatKeyFramesShare) {
  for (KeyFrame& keyframe : map_.keyframes) keyframe.connections.clear();
  UpdateConnections(map_);
  for (const KeyFrame& one : map_.keyframes) {
    std::map<std::uint64_t, int> shared;
    for (const MapPoint& point : map_.points) {
      const auto by = [](KeyFrameId id) { return [id](const Observation& o) { return o.keyframe == id; }; };
      const auto seen = std::ranges::count_if(point.observations, by(one.id));
      if (seen == 0) continue;
      // A point that is a keypoint of both pictures of a pair counts twice, as in ORB-SLAM3.
      const auto slots = std::ranges::count(one.features.map_points, point.id);
      for (const Observation& other : point.observations)
        if (other.keyframe != one.id) shared[other.keyframe.value()] += static_cast<int>(slots);
    }
    for (const Connection& connection : one.connections)
      EXPECT_THAT(shared, Contains(::testing::Key(connection.keyframe.value())));
    for (const auto& [id, count] : shared) {
      const auto found = std::ranges::find(one.connections, KeyFrameId(id), &Connection::keyframe);
      ASSERT_NE(found, one.connections.end());
      if (GetParam() == Sensor::kFisheyeStereo) continue;
      EXPECT_EQ(found->weight, count);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Sensors, Links,
                         ::testing::Values(Sensor::kMonocular, Sensor::kStereo, Sensor::kRgbd, Sensor::kFisheyeStereo));

}  // namespace
}  // namespace slamdb
