// SPDX-License-Identifier: BSD-3-Clause
// Sessions of one room, and of rooms that look alike, are what they claim to be.
#include <gmock/gmock.h>

#include <algorithm>
#include <limits>

#include "slamdb/base/error.h"
#include "slamdb/model/derive.h"
#include "slamdb/synthetic/synthesize.h"

namespace slamdb {
namespace {

SyntheticOptions Sessions(double overlap, Sensor sensor = Sensor::kRgbd) {
  SyntheticOptions options{.sensor = sensor, .maps = 2};
  options.keyframes = 20;
  options.points = 800;
  options.features = sensor == Sensor::kFisheyeStereo ? 1600 : 700;
  options.sessions = SessionOptions{.overlap = overlap};
  return options;
}

// The share of the second map's points that are where one of the first map's is, and how many bits they differ in.
struct Shared {
  double share = 0, bits = 0;
};
Shared SharedBy(const SyntheticSessions& sessions) {
  const Similarity3d first_from_second = sessions.room_from_map[0].Inverse() * sessions.room_from_map[1];
  const double most = 1e-3 / sessions.room_from_map[0].scale;
  Shared shared;
  for (const MapPoint& point : sessions.atlas.maps[1].points) {
    const Eigen::Vector3d position = first_from_second * point.position.cast<double>();
    for (const MapPoint& other : sessions.atlas.maps[0].points)
      if ((position - other.position.cast<double>()).squaredNorm() < most * most) {
        shared.share += 1;
        shared.bits += HammingDistance(point.descriptor, other.descriptor);
      }
  }
  shared.bits /= std::max(1.0, shared.share);
  shared.share /= static_cast<double>(sessions.atlas.maps[1].points.size());
  return shared;
}

TEST(Sessions, ShareTheirPointsInTheOverlapOnly) {
  for (const Sensor sensor : {Sensor::kMonocular, Sensor::kRgbd, Sensor::kFisheyeStereo})
    for (const double overlap : {0.0, 0.1, 0.5, 1.0}) {
      const Shared shared = SharedBy(SynthesizeSessions(Sessions(overlap, sensor)));
      EXPECT_NEAR(shared.share, 0.7 * overlap, 0.06) << overlap;
      EXPECT_LT(shared.bits, 17) << "the same looks";
    }
}

TEST(Sessions, ShareAllPointsWhereAllAreCommon) {
  SyntheticOptions options = Sessions(0.5);
  options.sessions->common = 1;
  EXPECT_NEAR(SharedBy(SynthesizeSessions(options)).share, 0.5, 0.01);
}

TEST(Sessions, OfAMonocularCameraHaveScalesOfTheirOwn) {
  double least = 1e9, most = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SyntheticOptions options = Sessions(0.5, Sensor::kMonocular);
    options.keyframes = 8;
    options.points = 100;
    options.seed = seed;
    for (const Similarity3d& room_from_map : SynthesizeSessions(options).room_from_map) {
      least = std::min(least, room_from_map.scale);
      most = std::max(most, room_from_map.scale);
    }
    options.sensor = Sensor::kStereo;
    EXPECT_EQ(SynthesizeSessions(options).room_from_map[1].scale, 1);
    options.sensor = Sensor::kMonocular;
    options.inertial = true;
    EXPECT_EQ(SynthesizeSessions(options).room_from_map[1].scale, 1) << "an IMU knows it";
  }
  EXPECT_GE(least, 0.0999);
  EXPECT_LT(least, 0.3);
  EXPECT_LE(most, 10.001);
  EXPECT_GT(most, 3);
}

TEST(Sessions, HaveTheirOwnOriginsIdsAndTimes) {
  const SyntheticSessions sessions = SynthesizeSessions(Sessions(0.5));
  const Map &first = sessions.atlas.maps[0], &second = sessions.atlas.maps[1];
  EXPECT_LT(second.keyframes[0].camera_from_world.translation.norm(), 1e-6F) << "the first camera is the origin";
  EXPECT_GT((sessions.room_from_map[0].translation - sessions.room_from_map[1].translation).norm(), 1);
  EXPECT_GT(second.keyframes.front().id, first.keyframes.back().id);
  EXPECT_GT(second.points.front().id, first.points.back().id);
  EXPECT_GT(second.keyframes.front().timestamp, first.keyframes.back().timestamp + 1);
}

// Every point is seen where the true transform says, in the room and in the map.
TEST(Sessions, TruthTakesPointsOntoTheWall) {
  for (const bool inertial : {false, true}) {
    SyntheticOptions options = Sessions(0.3, Sensor::kMonocular);
    options.inertial = inertial;
    const SyntheticSessions sessions = SynthesizeSessions(options);
    std::vector<double> radii;
    for (std::size_t map = 0; map < 2; ++map)
      for (const MapPoint& point : sessions.atlas.maps[map].points) {
        const Eigen::Vector3d in_room = sessions.room_from_map[map] * point.position.cast<double>();
        radii.push_back(in_room.head<2>().norm());
      }
    const auto [least, most] = std::ranges::minmax(radii);
    EXPECT_LT(most - least, 0.41) << "the wall is round, and 0.4 m thick";
  }
}

TEST(Sessions, BeforeAndBehindTheirArcSeeWhatTheyDoNotMap) {
  const SyntheticSessions sessions = SynthesizeSessions(Sessions(0.3));
  // Descriptors of the first map's last points are among the keypoints of the second's first keyframe that are no
  // points.
  const Features& features = sessions.atlas.maps[1].keyframes[0].features;
  std::size_t seen = 0;
  for (const MapPoint& point : sessions.atlas.maps[0].points)
    for (std::size_t row = 0; row < features.descriptors.size(); ++row)
      if (!features.map_points[row] && HammingDistance(features.descriptors[row], point.descriptor) < 30) ++seen;
  EXPECT_GT(seen, 20U);
}

TEST(Sessions, OfRoomsThatLookAlikeShareLooksButNotPlaces) {
  SyntheticOptions options = Sessions(0.5);
  options.sessions = SessionOptions{.common = 1, .look_alike = true};
  const SyntheticSessions sessions = SynthesizeSessions(options);
  EXPECT_LT(SharedBy(sessions).share, 0.05);
  std::size_t alike = 0;
  for (const MapPoint& point : sessions.atlas.maps[1].points)
    alike += std::ranges::any_of(sessions.atlas.maps[0].points, [&](const MapPoint& other) {
      return HammingDistance(point.descriptor, other.descriptor) < 30;
    });
  EXPECT_NEAR(static_cast<double>(alike) / 800, 0.5, 0.06) << "every other strip is a copy";
}

TEST(Sessions, FlippedBitsSetHowFarLooksDiffer) {
  SyntheticOptions options = Sessions(0.5);
  const double before = SharedBy(SynthesizeSessions(options)).bits;
  options.flipped_bits = 24;
  const double after = SharedBy(SynthesizeSessions(options)).bits;
  EXPECT_LT(before, 12);
  EXPECT_GT(after, before + 5);
}

TEST(Sessions, OutliersShowSomethingElse) {
  const auto off = [](double outliers) {
    SyntheticOptions options = Sessions(0.5);
    options.outliers = outliers;
    const SyntheticSessions made = SynthesizeSessions(options);
    const Map& map = made.atlas.maps[0];
    std::size_t all = 0, far = 0;
    for (const MapPoint& point : map.points)
      for (const Observation& observation : point.observations) {
        const KeyFrame& keyframe = map.keyframes[observation.keyframe.value() - map.keyframes[0].id.value()];
        const auto pixel = Project(made.atlas.cameras[0], keyframe.camera_from_world * point.position);
        const Keypoint& keypoint = keyframe.features.undistorted[static_cast<std::size_t>(observation.left)];
        ++all;
        far += !pixel || (*pixel - Eigen::Vector2f(keypoint.x, keypoint.y)).norm() > 25 ? 1 : 0;
      }
    return static_cast<double>(far) / static_cast<double>(all);
  };
  EXPECT_EQ(off(0), 0);
  EXPECT_NEAR(off(0.1), 0.1, 0.02);
}

TEST(Sessions, AnotherVocabularyHasOtherWordsForTheSameLooks) {
  SyntheticOptions options = Sessions(0.5);
  const Atlas one = SynthesizeAtlas(options);
  options.vocabulary = 2;
  const Atlas other = SynthesizeAtlas(options);
  EXPECT_NE(one.vocabulary.checksum, other.vocabulary.checksum);
  EXPECT_EQ(other.vocabulary.checksum.size(), 32U);
  const Features &a = one.maps[0].keyframes[3].features, &b = other.maps[0].keyframes[3].features;
  EXPECT_EQ(a.descriptors, b.descriptors);
  EXPECT_NE(a.bag_of_words.words, b.bag_of_words.words);
}

TEST(Sessions, OptionsOutOfRangeAreRefused) {
  const auto refused = [](const auto& change) {
    SyntheticOptions options = Sessions(0.5);
    change(options);
    EXPECT_THROW((void)SynthesizeSessions(options), Error);
  };
  refused([](SyntheticOptions& options) { options.sessions->overlap = 1.1; });
  refused([](SyntheticOptions& options) { options.sessions->overlap = -0.1; });
  refused([](SyntheticOptions& options) { options.sessions->common = 2; });
  refused([](SyntheticOptions& options) { options.outliers = 1; });
  refused([](SyntheticOptions& options) { options.flipped_bits = 257; });
  refused([](SyntheticOptions& options) { options.flipped_bits = -1; });
  refused([](SyntheticOptions& options) { options.sessions->overlap = std::numeric_limits<double>::quiet_NaN(); });
}

}  // namespace
}  // namespace slamdb
