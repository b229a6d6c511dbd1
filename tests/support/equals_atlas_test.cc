// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/equals_atlas.h"

#include <limits>

#include "slamdb/synthetic/synthesize.h"

namespace slamdb {
namespace {

using ::testing::Not;
using ::testing::StartsWith;

Atlas Sample() {
  SyntheticOptions options;
  options.sensor = Sensor::kFisheyeStereo;
  options.inertial = true;
  options.maps = 2;
  return SynthesizeAtlas(options);
}

template <class Change>
std::string DifferenceAfter(Change change) {
  const Atlas expected = Sample();
  Atlas actual = expected;
  change(actual);
  return FirstDifference(actual, expected);
}

TEST(FirstDifference, IsNothingBetweenEquals) {
  const Atlas atlas = Sample();
  EXPECT_EQ(FirstDifference(atlas, Sample()), "");
  EXPECT_THAT(Sample(), EqualsAtlas(atlas));
}

TEST(FirstDifference, NamesThePlace) {
  EXPECT_THAT(DifferenceAfter([](Atlas& a) { a.encoding.text = true; }), StartsWith("encoding.text: 1 instead of 0"));
  EXPECT_EQ(DifferenceAfter([](Atlas& a) { a.encoding.long_bytes = 4; }), "encoding.long_bytes: 4 instead of 8");
  EXPECT_EQ(DifferenceAfter([](Atlas& a) { a.vocabulary.name = "other.txt"; }),
            "vocabulary.name: other.txt instead of synthetic.txt");
  EXPECT_EQ(DifferenceAfter([](Atlas& a) { a.maps.pop_back(); }), "maps: 1 entries instead of 2");
  EXPECT_EQ(DifferenceAfter([](Atlas& a) { a.maps[1].id = MapId(9); }), "maps[1].id: map 9 instead of map 1");
  EXPECT_THAT(DifferenceAfter([](Atlas& a) { a.maps[0].keyframes[7].features.map_points[3] = MapPointId(77777); }),
              StartsWith("map 0, kf 7, map_points[3]: mp 77777 "));
  EXPECT_THAT(DifferenceAfter([](Atlas& a) { a.maps[1].keyframes[2].features.keypoints[5].octave = 9; }),
              StartsWith("map 1, kf 22, keypoints[5].octave: 9 "));
  EXPECT_THAT(DifferenceAfter([](Atlas& a) { a.maps[0].points[4].observations[1].left = 12345; }),
              StartsWith("map 0, mp 4, observations[1].left: 12345 "));
  EXPECT_THAT(DifferenceAfter([](Atlas& a) { a.maps[0].keyframes[1].preintegration.covariance(2, 1) = 7; }),
              StartsWith("map 0, kf 1, preintegration.covariance[17]: 7"));
  EXPECT_THAT(DifferenceAfter([](Atlas& a) { a.maps[0].keyframes[1].bad.recorded = 77; }),
              StartsWith("map 0, kf 1, bad: 77 instead of 0"));
  EXPECT_EQ(DifferenceAfter([](Atlas& a) {
              a.maps[0].repeated_points.push_back({3, 0, 4});
            }),
            "map 0, repeated_points: 1 entries instead of 0");
  EXPECT_THAT(DifferenceAfter([](Atlas& a) { a.cameras[1].parameters[0] = 1; }),
              StartsWith("camera 1, parameters[0]: 1 "));
  EXPECT_THAT(DifferenceAfter([](Atlas& a) { ++a.next_ids.frame; }), StartsWith("next_ids.frame"));
}

TEST(FirstDifference, ComparesFloatsByTheirBits) {
  const auto with = [](float value) {
    Atlas atlas;
    atlas.maps.resize(1);
    atlas.maps[0].points.resize(1);
    atlas.maps[0].points[0].min_distance = value;
    return atlas;
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(FirstDifference(with(nan), with(nan)), "");
  EXPECT_NE(FirstDifference(with(nan), with(-nan)), "");
  EXPECT_NE(FirstDifference(with(0.0F), with(-0.0F)), "");
  EXPECT_THAT(with(0.0F), Not(EqualsAtlas(with(-0.0F))));
}

}  // namespace
}  // namespace slamdb
