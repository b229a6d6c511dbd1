// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/synthetic/synthesize.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "slamdb/base/error.h"
#include "slamdb/model/derive.h"

namespace slamdb {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::Ge;
using ::testing::HasSubstr;
using ::testing::Lt;

struct Case {
  const char* name;
  Sensor sensor;
  bool inertial;
};

class SynthesizedAtlas : public ::testing::TestWithParam<Case> {
 protected:
  static SyntheticOptions Options() {
    SyntheticOptions options;
    options.sensor = GetParam().sensor;
    options.inertial = GetParam().inertial;
    options.maps = 2;
    options.keyframes = 24;
    options.points = 700;
    options.features = 400;
    return options;
  }

  static bool IsFisheye() { return GetParam().sensor == Sensor::kFisheyeStereo; }

  const Atlas atlas_ = SynthesizeAtlas(Options());

  const Camera& CameraOf(CameraId id) const {
    return *std::find_if(atlas_.cameras.begin(), atlas_.cameras.end(),
                         [&](const Camera& camera) { return camera.id == id; });
  }
};

const KeyFrame& Find(const Map& map, KeyFrameId id) {
  const auto found = std::find_if(map.keyframes.begin(), map.keyframes.end(),
                                  [&](const KeyFrame& keyframe) { return keyframe.id == id; });
  EXPECT_NE(found, map.keyframes.end()) << ToString(id);
  return *found;
}

// The keypoint rows of an observation, left and right.
std::vector<std::int32_t> Rows(const Observation& observation) {
  std::vector<std::int32_t> rows;
  if (observation.left >= 0) rows.push_back(observation.left);
  if (observation.right >= 0) rows.push_back(observation.right);
  return rows;
}

TEST_P(SynthesizedAtlas, HasTheNumbersThatWereAskedFor) {
  ASSERT_EQ(atlas_.maps.size(), 2U);
  for (const Map& map : atlas_.maps) {
    EXPECT_EQ(map.keyframes.size(), 24U);
    EXPECT_EQ(map.points.size(), 700U);
    for (const KeyFrame& keyframe : map.keyframes) {
      EXPECT_LE(keyframe.features.count, 400);
      EXPECT_GE(keyframe.features.count, 300);
    }
  }
}

TEST_P(SynthesizedAtlas, HasIdsBelowItsCountersAndUniqueAcrossMaps) {
  std::set<std::uint64_t> keyframes, points, frames;
  for (const Map& map : atlas_.maps) {
    EXPECT_LT(map.id.value(), atlas_.next_ids.map);
    for (const KeyFrame& keyframe : map.keyframes) {
      EXPECT_TRUE(keyframes.insert(keyframe.id.value()).second);
      EXPECT_TRUE(frames.insert(keyframe.frame_id).second);
      EXPECT_EQ(keyframe.origin_map, map.id.value());
    }
    for (const MapPoint& point : map.points) EXPECT_TRUE(points.insert(point.id.value()).second);
    EXPECT_EQ(map.initial_keyframe, map.keyframes.front().id);
    EXPECT_EQ(map.first_keyframe, map.initial_keyframe);
    EXPECT_EQ(map.lowest_keyframe, map.initial_keyframe);
    EXPECT_EQ(map.max_keyframe_id, map.keyframes.back().id.value());
    EXPECT_THAT(map.origins, ElementsAre(map.initial_keyframe));
  }
  EXPECT_LT(*keyframes.rbegin(), atlas_.next_ids.keyframe);
  EXPECT_LT(*points.rbegin(), atlas_.next_ids.map_point);
  EXPECT_LT(*frames.rbegin(), atlas_.next_ids.frame);
  EXPECT_EQ(atlas_.next_ids.camera, IsFisheye() ? 2U : 1U);
  EXPECT_EQ(atlas_.next_ids.initial_keyframe, *keyframes.rbegin() + 1);
}

TEST_P(SynthesizedAtlas, HasColumnsOfTheRightLengths) {
  for (const Map& map : atlas_.maps) {
    for (const KeyFrame& keyframe : map.keyframes) {
      const Features& f = keyframe.features;
      const auto count = static_cast<std::size_t>(f.count);
      const std::size_t left = IsFisheye() ? static_cast<std::size_t>(f.left_count) : count;
      EXPECT_EQ(f.is_fisheye_stereo(), IsFisheye());
      EXPECT_EQ(keyframe.right_camera.has_value(), IsFisheye());
      if (IsFisheye()) {
        EXPECT_EQ(f.left_count + f.right_count, f.count);
        EXPECT_GT(f.right_count, 0);
        EXPECT_EQ(f.right_keypoints.size(), count - left);
        EXPECT_TRUE(IsDerivedGrid(f.right_grid, f.right_keypoints, keyframe.bounds));
      } else {
        EXPECT_EQ(f.right_count, -1);
        EXPECT_TRUE(f.right_grid.empty());
      }
      EXPECT_EQ(f.keypoints.size(), left);
      EXPECT_EQ(f.undistorted.size(), left);
      EXPECT_EQ(f.right_x.size(), left);
      EXPECT_EQ(f.depth.size(), left);
      EXPECT_EQ(f.descriptors.size(), count);
      EXPECT_EQ(f.map_points.size(), count);
      EXPECT_EQ(f.right_of_left.size(), IsFisheye() ? left : 0);
      EXPECT_EQ(f.left_of_right.size(), IsFisheye() ? count - left : 0);
      EXPECT_TRUE(IsDerivedGrid(f.grid, f.undistorted, keyframe.bounds));
      EXPECT_EQ(f.grid.keypoints.size(), left);
    }
  }
}

TEST_P(SynthesizedAtlas, HasKeypointsAsTheOrbExtractorMakesThem) {
  for (const KeyFrame& keyframe : atlas_.maps[0].keyframes) {
    std::int32_t previous = 0;
    for (const Keypoint& keypoint : keyframe.features.keypoints) {
      EXPECT_EQ(keypoint.class_id, -1);
      EXPECT_THAT(keypoint.octave, AllOf(Ge(previous), Lt(8)));
      EXPECT_THAT(keypoint.angle, AllOf(Ge(0), Lt(360)));
      EXPECT_FLOAT_EQ(keypoint.size, 31 * keyframe.pyramid.factors[static_cast<std::size_t>(keypoint.octave)]);
      EXPECT_THAT(keypoint.x, AllOf(Ge(0), Lt(640)));
      EXPECT_THAT(keypoint.y, AllOf(Ge(0), Lt(480)));
      previous = keypoint.octave;
    }
  }
}

TEST_P(SynthesizedAtlas, HasObservationsOnBothSides) {
  for (const Map& map : atlas_.maps) {
    std::size_t filled = 0, observed = 0;
    for (const KeyFrame& keyframe : map.keyframes)
      filled += static_cast<std::size_t>(std::count_if(keyframe.features.map_points.begin(),
                                                       keyframe.features.map_points.end(),
                                                       [](MapPointId id) { return id.has_value(); }));
    for (const MapPoint& point : map.points) {
      EXPECT_GE(point.observations.size(), 2U) << ToString(point.id);
      KeyFrameId previous(0);
      std::int32_t weight = 0;
      for (const Observation& observation : point.observations) {
        EXPECT_GE(observation.keyframe, previous);
        previous = observation.keyframe;
        const KeyFrame& keyframe = Find(map, observation.keyframe);
        EXPECT_FALSE(Rows(observation).empty());
        weight += ObservationWeight(keyframe, observation);
        for (const std::int32_t row : Rows(observation)) {
          ++observed;
          EXPECT_EQ(keyframe.features.map_points.at(static_cast<std::size_t>(row)), point.id);
        }
        if (observation.right >= 0) {
          EXPECT_GE(observation.right, keyframe.features.left_count);
        }
      }
      EXPECT_EQ(point.observation_count, weight);
    }
    EXPECT_EQ(filled, observed);
  }
}

TEST_P(SynthesizedAtlas, ProjectsItsPointsOntoTheirKeypoints) {
  double squares = 0;
  std::size_t count = 0;
  for (const Map& map : atlas_.maps) {
    for (const MapPoint& point : map.points) {
      for (const Observation& observation : point.observations) {
        const KeyFrame& keyframe = Find(map, observation.keyframe);
        for (const std::int32_t row : Rows(observation)) {
          Eigen::Vector3f x = keyframe.camera_from_world * point.position;
          if (row == observation.right) x = keyframe.left_from_right.Inverse() * x;
          const Keypoint* keypoint = ObservedKeypoint(keyframe, row);
          ASSERT_NE(keypoint, nullptr);
          const auto pixel = Project(CameraOf(row == observation.right ? keyframe.right_camera : keyframe.camera), x);
          ASSERT_TRUE(pixel.has_value());
          const float scale = keyframe.pyramid.factors[static_cast<std::size_t>(keypoint->octave)];
          const Eigen::Vector2f error = (*pixel - Eigen::Vector2f(keypoint->x, keypoint->y)) / scale;
          EXPECT_LT(error.norm(), 0.5F * 6 * 1.5F);
          squares += error.squaredNorm();
          ++count;
        }
      }
    }
  }
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(2 * count)), 0.5, 0.02);
}

TEST_P(SynthesizedAtlas, MeasuresTheDepthOfItsPoints) {
  std::size_t measured = 0;
  const Map& map = atlas_.maps[0];
  for (const MapPoint& point : map.points) {
    for (const Observation& observation : point.observations) {
      if (observation.left < 0) continue;
      const KeyFrame& keyframe = Find(map, observation.keyframe);
      const auto row = static_cast<std::size_t>(observation.left);
      const float depth = keyframe.features.depth[row], right_x = keyframe.features.right_x[row];
      if (depth < 0) continue;
      ++measured;
      EXPECT_NEAR(depth, (keyframe.camera_from_world * point.position).z(), 1);
      if (!IsFisheye()) {
        EXPECT_NEAR(keyframe.features.undistorted[row].x - right_x, keyframe.intrinsics.baseline_fx / depth, 1e-2);
      }
    }
  }
  EXPECT_EQ(measured > 0, GetParam().sensor != Sensor::kMonocular);
}

TEST_P(SynthesizedAtlas, HasPointsAsOrbSlam3WouldUpdateThem) {
  for (const Map& map : atlas_.maps) {
    for (const MapPoint& point : map.points) {
      std::vector<Descriptor> descriptors;
      Eigen::Vector3f normal = Eigen::Vector3f::Zero();
      for (const Observation& observation : point.observations) {
        const KeyFrame& keyframe = Find(map, observation.keyframe);
        for (const std::int32_t row : Rows(observation)) {
          descriptors.push_back(keyframe.features.descriptors[static_cast<std::size_t>(row)]);
          const bool is_right = row == observation.right;
          normal += (point.position - (is_right ? RightCameraCenter(keyframe) : CameraCenter(keyframe))).normalized();
        }
      }
      normal /= static_cast<float>(descriptors.size());
      EXPECT_LT((point.normal - normal).norm(), 1e-4F);
      EXPECT_EQ(point.descriptor, descriptors[MostDistinctiveDescriptor(descriptors)]);

      EXPECT_EQ(point.reference, point.observations.front().keyframe);
      const KeyFrame& reference = Find(map, point.reference);
      const Keypoint* keypoint = ObservedKeypoint(reference, Rows(point.observations.front()).front());
      const DistanceRange range =
          DeriveDistanceRange((point.position - CameraCenter(reference)).norm(), keypoint->octave, reference.pyramid);
      EXPECT_NEAR(point.min_distance, range.min, 1e-4 * range.min);
      EXPECT_NEAR(point.max_distance, range.max, 1e-4 * range.max);
      for (const Observation& observation : point.observations) {
        const float distance = (point.position - CameraCenter(Find(map, observation.keyframe))).norm();
        EXPECT_GE(distance, 0.8F * point.min_distance);
        EXPECT_LE(distance, 1.2F * point.max_distance);
      }
      EXPECT_EQ(static_cast<std::uint64_t>(point.first_keyframe), reference.id.value());
      EXPECT_EQ(static_cast<std::uint64_t>(point.first_frame), reference.frame_id);
      EXPECT_FALSE(point.bad);
      EXPECT_FALSE(point.replaced_by);
    }
  }
}

TEST_P(SynthesizedAtlas, HasCovisibilityEqualToSharedPoints) {
  for (const Map& map : atlas_.maps) {
    std::map<KeyFrameId, std::map<KeyFrameId, std::int32_t>> shared;
    for (const MapPoint& point : map.points)
      for (const Observation& a : point.observations)
        for (const Observation& b : point.observations)
          if (a.keyframe != b.keyframe) ++shared[a.keyframe][b.keyframe];
    for (const KeyFrame& keyframe : map.keyframes) {
      std::map<KeyFrameId, std::int32_t> recorded;
      for (const Connection& connection : keyframe.connections) recorded[connection.keyframe] = connection.weight;
      EXPECT_EQ(recorded, shared[keyframe.id]);
      EXPECT_TRUE(std::is_sorted(keyframe.connections.begin(), keyframe.connections.end(),
                                 [](const Connection& a, const Connection& b) { return a.keyframe < b.keyframe; }));
    }
  }
}

TEST_P(SynthesizedAtlas, HasASpanningTree) {
  for (const Map& map : atlas_.maps) {
    for (const KeyFrame& keyframe : map.keyframes) {
      const bool is_root = keyframe.id == map.initial_keyframe;
      EXPECT_EQ(keyframe.parent.has_value(), !is_root);
      EXPECT_EQ(keyframe.first_connection, Flag(is_root));
      if (is_root) continue;
      EXPECT_LT(keyframe.parent, keyframe.id);  // so every way up ends at the root
      EXPECT_THAT(Find(map, keyframe.parent).children, ::testing::Contains(keyframe.id).Times(1));
      const auto edge = std::find_if(keyframe.connections.begin(), keyframe.connections.end(),
                                     [&](const Connection& c) { return c.keyframe == keyframe.parent; });
      ASSERT_NE(edge, keyframe.connections.end());
      EXPECT_GE(edge->weight, 15);
    }
    const std::size_t children =
        std::accumulate(map.keyframes.begin(), map.keyframes.end(), std::size_t{0},
                        [](std::size_t sum, const KeyFrame& keyframe) { return sum + keyframe.children.size(); });
    EXPECT_EQ(children, map.keyframes.size() - 1);
  }
}

TEST_P(SynthesizedAtlas, HasLoopEdgesWhereTheCameraComesBack) {
  for (const Map& map : atlas_.maps) {
    EXPECT_GT(map.big_change_index, 0);
    for (const KeyFrame& keyframe : map.keyframes) {
      EXPECT_EQ(keyframe.not_erase, Flag(!keyframe.loop_edges.empty()));
      for (const KeyFrameId other : keyframe.loop_edges) {
        const KeyFrame& match = Find(map, other);
        EXPECT_THAT(match.loop_edges, ::testing::Contains(keyframe.id).Times(1));
        EXPECT_GT(std::abs(static_cast<double>(keyframe.id.value()) - static_cast<double>(other.value())), 10);
        EXPECT_LT((CameraCenter(keyframe) - CameraCenter(match)).norm(), 1);
      }
    }
  }
}

TEST_P(SynthesizedAtlas, HasUnitBagsOfWordsAndEachFeatureUnderOneNode) {
  for (const KeyFrame& keyframe : atlas_.maps[1].keyframes) {
    const BagOfWords& bag = keyframe.features.bag_of_words;
    ASSERT_EQ(bag.words.size(), bag.weights.size());
    EXPECT_TRUE(std::is_sorted(bag.words.begin(), bag.words.end(), std::less_equal<>()));
    EXPECT_LT(bag.words.back(), 1'000'000U);
    EXPECT_NEAR(std::accumulate(bag.weights.begin(), bag.weights.end(), 0.0), 1, 1e-12);
    const FeatureVector& vector = keyframe.features.feature_vector;
    ASSERT_EQ(vector.nodes.size(), vector.sizes.size());
    EXPECT_TRUE(std::is_sorted(vector.nodes.begin(), vector.nodes.end(), std::less_equal<>()));
    std::vector<std::uint32_t> rows(vector.features.begin(), vector.features.end()), all(rows.size());
    std::sort(rows.begin(), rows.end());
    std::iota(all.begin(), all.end(), 0U);
    EXPECT_EQ(rows, all);
    EXPECT_EQ(rows.size(), static_cast<std::size_t>(keyframe.features.count));
    EXPECT_EQ(std::accumulate(vector.sizes.begin(), vector.sizes.end(), std::size_t{0}), rows.size());
  }
}

TEST_P(SynthesizedAtlas, HasUnitQuaternionsAndTimesInOrder) {
  double time = 0;
  for (const Map& map : atlas_.maps) {
    for (const KeyFrame& keyframe : map.keyframes) {
      EXPECT_NEAR(keyframe.camera_from_world.rotation.norm(), 1, 1e-6);
      EXPECT_GT(keyframe.timestamp, time);
      time = keyframe.timestamp;
      EXPECT_EQ(keyframe.previous.has_value(), GetParam().inertial && keyframe.id != map.keyframes.front().id);
      EXPECT_EQ(keyframe.next.has_value(), GetParam().inertial && keyframe.id != map.keyframes.back().id);
      if (keyframe.next) {
        EXPECT_EQ(Find(map, keyframe.next).previous, keyframe.id);
      }
    }
  }
}

class InertialAtlas : public SynthesizedAtlas {};

// Forster et al. (TRO 2017), equation 33: the preintegrated motion between two states.
TEST_P(InertialAtlas, HasMotionThatAgreesWithThePoses) {
  const Eigen::Vector3f gravity(0, 0, -9.81F);
  for (const Map& map : atlas_.maps) {
    EXPECT_TRUE(map.imu_initialized && map.inertial && map.imu_ba1 && map.imu_ba2);
    for (std::size_t row = 1; row < map.keyframes.size(); ++row) {
      const KeyFrame &a = map.keyframes[row - 1], &b = map.keyframes[row];
      EXPECT_TRUE(b.imu_calibration.is_set && b.imu_initialized && b.has_velocity);
      const Rigid3f pose_a = WorldFromBody(a), pose_b = WorldFromBody(b);
      EXPECT_LT((pose_b.translation - b.body_position).norm(), 1e-3F);
      const ImuPreintegration& motion = b.preintegration;
      const float t = motion.duration;
      EXPECT_NEAR(t, b.timestamp - a.timestamp, 1e-5);
      const Eigen::Matrix3f back = pose_a.rotation.toRotationMatrix().transpose();
      EXPECT_LT((back * pose_b.rotation.toRotationMatrix() - motion.rotation).norm(), 1e-4F);
      EXPECT_LT((back * (b.velocity - a.velocity - gravity * t) - motion.velocity).norm(), 1e-3F);
      EXPECT_LT(
          (back * (pose_b.translation - pose_a.translation - a.velocity * t - gravity * (t * t / 2)) - motion.position)
              .norm(),
          2e-3F);
      float sum = 0;
      Eigen::Matrix3f rotation = Eigen::Matrix3f::Identity();
      for (const ImuMeasurement& measurement : motion.measurements) {
        const Eigen::Vector3f turn = (measurement.angular_velocity - motion.bias.gyroscope) * measurement.duration;
        rotation = rotation * Eigen::AngleAxisf(turn.norm(), turn.normalized()).toRotationMatrix();
        sum += measurement.duration;
      }
      EXPECT_NEAR(sum, t, 1e-5);
      EXPECT_LT((rotation - motion.rotation).norm(), 1e-4F);
      EXPECT_TRUE((motion.covariance.diagonal().array() > 0).all());
      EXPECT_LT((motion.covariance - motion.covariance.transpose()).norm(), 1e-6F);
    }
  }
}

constexpr Case kVisual[] = {{"Monocular", Sensor::kMonocular, false},
                            {"Stereo", Sensor::kStereo, false},
                            {"Rgbd", Sensor::kRgbd, false},
                            {"FisheyeStereo", Sensor::kFisheyeStereo, false}};
constexpr Case kInertial[] = {{"MonocularInertial", Sensor::kMonocular, true},
                              {"StereoInertial", Sensor::kStereo, true},
                              {"RgbdInertial", Sensor::kRgbd, true},
                              {"FisheyeStereoInertial", Sensor::kFisheyeStereo, true}};
std::string NameOf(const ::testing::TestParamInfo<Case>& parameter) { return parameter.param.name; }

INSTANTIATE_TEST_SUITE_P(Visual, SynthesizedAtlas, ::testing::ValuesIn(kVisual), NameOf);
INSTANTIATE_TEST_SUITE_P(Inertial, SynthesizedAtlas, ::testing::ValuesIn(kInertial), NameOf);
INSTANTIATE_TEST_SUITE_P(Inertial, InertialAtlas, ::testing::ValuesIn(kInertial), NameOf);

TEST(SynthesizeAtlas, SeesSomePointsOfAFisheyePairInOneImageOnly) {
  SyntheticOptions options;
  options.sensor = Sensor::kFisheyeStereo;
  const Atlas atlas = SynthesizeAtlas(options);
  std::size_t both = 0, left = 0, right = 0;
  for (const MapPoint& point : atlas.maps[0].points) {
    for (const Observation& o : point.observations) {
      both += o.left >= 0 && o.right >= 0;
      left += o.left >= 0 && o.right < 0;
      right += o.left < 0 && o.right >= 0;
    }
  }
  EXPECT_GT(both, 100U);
  EXPECT_GT(left, 100U);
  EXPECT_GT(right, 100U);
}

TEST(SynthesizeAtlas, StaysOpenWithoutLoops) {
  SyntheticOptions options;
  options.loops = false;
  options.keyframes = 60;
  const Atlas atlas = SynthesizeAtlas(options);
  for (const KeyFrame& keyframe : atlas.maps[0].keyframes) EXPECT_TRUE(keyframe.loop_edges.empty());
}

TEST(SynthesizeAtlas, FitsTheRoomToManySizes) {
  struct Size {
    std::size_t keyframes, points, features;
  };
  for (const Size& size : {Size{2, 10, 20}, Size{2, 400, 500}, Size{3, 1, 5}, Size{5, 0, 10}, Size{30, 5000, 1000},
                           Size{400, 300, 100}, Size{400, 30000, 600}, Size{2000, 2000, 40}}) {
    SyntheticOptions options;
    options.keyframes = size.keyframes;
    options.points = size.points;
    options.features = size.features;
    const Atlas atlas = SynthesizeAtlas(options);
    for (const MapPoint& point : atlas.maps[0].points) {
      EXPECT_GE(point.observations.size(), 2U) << size.keyframes << ' ' << size.points << ' ' << size.features;
      EXPECT_LE(point.observations.size(), 500U) << size.keyframes << ' ' << size.points << ' ' << size.features;
    }
    for (const KeyFrame& keyframe : atlas.maps[0].keyframes)
      EXPECT_LE(static_cast<std::size_t>(keyframe.features.count), size.features);
  }
}

TEST(SynthesizeAtlas, SaysWhatIsWrongWithTheOptions) {
  const auto message = [](auto change) {
    SyntheticOptions options;
    change(options);
    try {
      SynthesizeAtlas(options);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(message([](auto& o) { o.maps = 0; }), HasSubstr("at least 1 map"));
  EXPECT_THAT(message([](auto& o) { o.keyframes = 1; }), HasSubstr("at least 2 keyframes"));
  EXPECT_THAT(message([](auto& o) { o.features = 0; }), HasSubstr("features per keyframe"));
  EXPECT_THAT(message([](auto& o) { o.pixel_noise = -1; }), HasSubstr("pixel noise"));
  EXPECT_THAT(message([](auto& o) { o.pixel_noise = std::nan(""); }), HasSubstr("pixel noise"));
  EXPECT_THAT(message([](auto& o) { o.points = 100000; }), HasSubstr("cannot see 100000 points twice"));
}

TEST(SynthesizeAtlas, TellsItsProgressFromTheCallersThread) {
  SyntheticOptions options;
  options.maps = 2;
  std::vector<double> fractions;
  options.progress = [&](std::string_view stage, double fraction) {
    EXPECT_THAT(std::string(stage), HasSubstr("synthesizing map"));
    fractions.push_back(fraction);
  };
  SynthesizeAtlas(options);
  EXPECT_EQ(fractions.front(), 0);
  EXPECT_EQ(fractions.back(), 1);
}

}  // namespace
}  // namespace slamdb
