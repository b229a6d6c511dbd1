// SPDX-License-Identifier: BSD-3-Clause
// Observations of points that the map has.
#include <gmock/gmock.h>

#include <algorithm>
#include <random>

#include "slamdb/build/links.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/build/taken_apart.h"

namespace slamdb {
namespace {

class Observations : public ::testing::TestWithParam<Sensor> {
 protected:
  Atlas atlas_ = SynthesizeAtlas({.sensor = GetParam(), .keyframes = 12, .points = 260, .features = 200});
};

// Points that are built with a part of their observations and get the others later are what they are built at once.
TEST_P(Observations, AddedLaterAreAsGoodAsAtOnce) {
  std::mt19937 random(2);
  const Map& map = atlas_.maps[0];
  const NewPoints all = PointsOf(map);
  NewPoints part = all;
  part.observations.clear();
  std::vector<PointObservation> later;
  std::vector<bool> is_seen(all.positions.size(), false);
  for (const NewObservation& seen : all.observations) {
    const bool is_first = !is_seen[seen.point];
    is_seen[seen.point] = true;
    if (is_first || random() % 2 == 0)
      part.observations.push_back(seen);
    else
      later.push_back({all.ids[seen.point], seen.keyframe, seen.keypoint});
  }
  ASSERT_GT(later.size(), 100U);
  std::ranges::shuffle(later, random);

  Atlas whole;
  whole.vocabulary = atlas_.vocabulary;
  for (const Camera& camera : atlas_.cameras) AddCamera(whole, camera.model, camera.parameters, camera.id);
  AddMap(whole, map.id);
  AddKeyFrames(whole, map.id, KeyFramesOf(map));
  Atlas grown = whole;
  AddPoints(whole, map.id, all);
  AddPoints(grown, map.id, part);
  const std::size_t half = later.size() / 2;
  AddObservations(grown.maps[0], std::span(later).first(half));
  AddObservations(grown.maps[0], std::span(later).subspan(half));

  EXPECT_EQ(TroublesOf(grown), "");
  for (std::size_t row = 0; row < whole.maps[0].points.size(); ++row) {
    const MapPoint &one = grown.maps[0].points[row], &other = whole.maps[0].points[row];
    EXPECT_EQ(one.observations, other.observations);
    EXPECT_EQ(one.observation_count, other.observation_count);
    EXPECT_LE((one.normal - other.normal).norm(), 1e-6F);
    EXPECT_EQ(one.descriptor, other.descriptor);
  }
  for (std::size_t row = 0; row < whole.maps[0].keyframes.size(); ++row) {
    const KeyFrame &one = grown.maps[0].keyframes[row], &other = whole.maps[0].keyframes[row];
    EXPECT_EQ(one.features.map_points, other.features.map_points);
    EXPECT_EQ(one.connections, other.connections);
  }
}

INSTANTIATE_TEST_SUITE_P(Sensors, Observations,
                         ::testing::Values(Sensor::kMonocular, Sensor::kStereo, Sensor::kFisheyeStereo));

}  // namespace
}  // namespace slamdb
