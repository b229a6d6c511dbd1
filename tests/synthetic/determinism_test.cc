// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <span>
#include <string>

#include "slamdb/base/detail/hash.h"
#include "slamdb/synthetic/detail/portable.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/support/equals_atlas.h"

namespace slamdb {
namespace {

// Hashes what is computed in a synthetic atlas, member by member, since structs have padding.
class Digest {
 public:
  template <class T>
  void Add(const T* values, std::size_t count) {
    hash_ = detail::HashBytes(std::as_bytes(std::span(values, count)), hash_);
  }
  template <class T>
  void Add(const Column<T>& column) {
    Add(column.data(), column.size());
  }
  void Add(const Rigid3f& pose) {
    Add(pose.rotation.coeffs().data(), 4);
    Add(pose.translation.data(), 3);
  }
  void Add(const KeyFrame& keyframe);
  void Add(const MapPoint& point);

  std::string text() const { return detail::Hex(hash_); }

 private:
  std::uint64_t hash_ = 0;
};

void Digest::Add(const KeyFrame& keyframe) {
  Add(&keyframe.timestamp, 1);
  Add(keyframe.camera_from_world);
  Add(keyframe.left_from_right);
  const Features& features = keyframe.features;
  Add(features.keypoints);
  Add(features.right_keypoints);
  Add(features.right_x);
  Add(features.depth);
  Add(features.descriptors);
  Add(features.map_points);
  Add(features.right_of_left);
  Add(features.grid.keypoints);
  Add(features.bag_of_words.words);
  Add(features.bag_of_words.weights);
  Add(features.feature_vector.features);
  for (const Connection& connection : keyframe.connections) Add(&connection.weight, 1);
  Add(keyframe.children);
  Add(keyframe.loop_edges);
  Add(keyframe.velocity.data(), 3);
  const ImuPreintegration& motion = keyframe.preintegration;
  Add(motion.covariance.data(), 225);
  Add(motion.rotation.data(), 9);
  Add(motion.velocity_by_gyro.data(), 9);
  Add(motion.position_by_acc.data(), 9);
  Add(motion.position.data(), 3);
  for (const ImuMeasurement& measurement : motion.measurements) {
    Add(measurement.acceleration.data(), 3);
    Add(measurement.angular_velocity.data(), 3);
  }
}

void Digest::Add(const MapPoint& point) {
  Add(point.position.data(), 3);
  Add(point.normal.data(), 3);
  Add(point.observations);
  Add(point.descriptor.data(), point.descriptor.size());
  Add(&point.observation_count, 1);
  Add(&point.min_distance, 1);
}

std::string DigestOf(const Atlas& atlas) {
  Digest digest;
  for (const Map& map : atlas.maps) {
    for (const KeyFrame& keyframe : map.keyframes) digest.Add(keyframe);
    for (const MapPoint& point : map.points) digest.Add(point);
  }
  return digest.text();
}

std::string DigestOf(Sensor sensor, bool inertial) {
  SyntheticOptions options;
  options.sensor = sensor;
  options.inertial = inertial;
  options.maps = 2;
  return DigestOf(SynthesizeAtlas(options));
}

// These may change when synthesis changes, but must be the same on every machine.
TEST(Synthesis, GivesTheSameBytesOnEveryMachine) {
  EXPECT_EQ(DigestOf(Sensor::kMonocular, false), "73457a20b8ff7f33");
  EXPECT_EQ(DigestOf(Sensor::kStereo, false), "dd9dd50e52342caa");
  EXPECT_EQ(DigestOf(Sensor::kRgbd, false), "2845589da28fa6f6");
  EXPECT_EQ(DigestOf(Sensor::kFisheyeStereo, false), "bb158a7ef4f574b4");
  EXPECT_EQ(DigestOf(Sensor::kMonocular, true), "3a1a1062e196f83b");
  EXPECT_EQ(DigestOf(Sensor::kStereo, true), "22eac512493c26ec");
  EXPECT_EQ(DigestOf(Sensor::kRgbd, true), "828ea45c81e63389");
  EXPECT_EQ(DigestOf(Sensor::kFisheyeStereo, true), "27ed136cf1a2f7e0");
}

TEST(Synthesis, DoesNotDependOnTheNumberOfThreads) {
  SyntheticOptions options;
  options.inertial = true;
  options.keyframes = 300;
  options.points = 9000;
  options.threads = 1;
  const Atlas expected = SynthesizeAtlas(options);
  options.threads = 3;
  EXPECT_THAT(SynthesizeAtlas(options), EqualsAtlas(expected));
}

TEST(Synthesis, DependsOnTheSeed) {
  SyntheticOptions options;
  const std::string first = DigestOf(SynthesizeAtlas(options));
  options.seed = 2;
  EXPECT_NE(DigestOf(SynthesizeAtlas(options)), first);
}

TEST(PortableMathematics, AgreesWithTheLibraryOfThisMachine) {
  using namespace synthetic;  // NOLINT(google-build-using-namespace)
  for (double angle = -40; angle < 40; angle += 0.0371) {
    EXPECT_NEAR(Sine(angle), std::sin(angle), 1e-14);
    EXPECT_NEAR(Cosine(angle), std::cos(angle), 1e-14);
    EXPECT_NEAR(ArcTangent(std::sin(angle), 2 * std::cos(angle)), std::atan2(std::sin(angle), 2 * std::cos(angle)),
                1e-14);
  }
  EXPECT_EQ(ArcTangent(0, 1), 0);
  EXPECT_NEAR(ArcTangent(1, 0), kPi / 2, 1e-15);
}

TEST(PortableMathematics, TurnsRotationsIntoAxesAndQuaternionsAndBack) {
  using namespace synthetic;  // NOLINT(google-build-using-namespace)
  for (const Eigen::Vector3d& axis : {Eigen::Vector3d(0.3, -1.2, 0.7), Eigen::Vector3d(1e-7, 0, -1e-7),
                                      Eigen::Vector3d(0, 0, 3), Eigen::Vector3d(3.1, 0, 0.1)}) {
    const Eigen::Matrix3d rotation = Rotation(axis);
    EXPECT_LT((AxisAngle(rotation) - axis).norm(), 1e-9);
    EXPECT_LT((rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-14);
    const Rigid3f recorded = Pose{rotation, {1, 2, 3}}.Recorded();
    EXPECT_LT((recorded.rotation.toRotationMatrix().cast<double>() - rotation).norm(), 1e-6);
    EXPECT_GE(recorded.rotation.w(), 0);
  }
}

}  // namespace
}  // namespace slamdb
