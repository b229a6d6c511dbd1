// SPDX-License-Identifier: BSD-3-Clause
// What AlignMaps says of maps in which there is little to find, and that it says the same each time.
#include <gmock/gmock.h>

#include <limits>

#include "slamdb/base/error.h"
#include "tests/align/trial.h"
#include "tests/align/worlds.h"

namespace slamdb::testing {
namespace {

Alignment Aligned(const Atlas& atlas) { return AlignMaps({&atlas, 0}, {&atlas, 1}, {.threads = 1}); }

TEST(AlignMaps, FindsWhatOverlaps) {
  const Outcome outcome = AlignSessions(SynthesizeSessions(SmallPair()));
  EXPECT_TRUE(outcome.found()) << Describe(outcome);
  EXPECT_FALSE(outcome.alignment.scale_is_free);
  ASSERT_FALSE(outcome.alignment.pairs.empty());
  EXPECT_TRUE(std::ranges::is_sorted(outcome.alignment.pairs, std::greater(), &AlignedPair::inliers));
  EXPECT_EQ(outcome.alignment.evidence.points, outcome.alignment.matches.size());
}

TEST(AlignMaps, MatchesAreTheSamePointsOfTheWall) {
  const SyntheticSessions sessions = SynthesizeSessions(SmallPair(Sensor::kMonocular));
  const Outcome outcome = AlignSessions(sessions);
  ASSERT_TRUE(outcome.found()) << Describe(outcome);
  const Similarity3d truth = TrueTransform(sessions);
  const auto position = [&](std::size_t map, MapPointId id) {
    const Column<MapPoint>& points = sessions.atlas.maps[map].points;
    return points[id.value() - points.front().id.value()].position.cast<double>().eval();
  };
  std::size_t wrong = 0;
  for (const auto& [first, second, error] : outcome.alignment.matches)
    wrong += (position(0, first) - truth * position(1, second)).norm() * sessions.room_from_map[0].scale > 0.05 ? 1 : 0;
  EXPECT_LE(wrong, outcome.alignment.matches.size() / 50);
}

TEST(AlignMaps, SaysTheSameForAnyNumberOfThreads) {
  const SyntheticSessions sessions = SynthesizeSessions(PairOfSessions(Sensor::kMonocular, false, 0.3, 5));
  const Alignment one = AlignSessions(sessions, {.threads = 1}).alignment;
  const Alignment two = AlignSessions(sessions, {.threads = 2}).alignment;
  ASSERT_TRUE(one.first_from_second && two.first_from_second);
  EXPECT_EQ(one.first_from_second->translation, two.first_from_second->translation);
  EXPECT_EQ(one.first_from_second->rotation.coeffs(), two.first_from_second->rotation.coeffs());
  EXPECT_EQ(one.first_from_second->scale, two.first_from_second->scale);
  EXPECT_EQ(one.covariance, two.covariance);
  EXPECT_EQ(one.reason, two.reason);
  EXPECT_EQ(one.matches.size(), two.matches.size());
}

TEST(AlignMaps, WithoutACommonVocabularyItTrainsOne) {
  SyntheticOptions options = SmallPair();
  const SyntheticSessions ours = SynthesizeSessions(options);
  options.vocabulary = 9;
  const SyntheticSessions theirs = SynthesizeSessions(options);
  ASSERT_NE(ours.atlas.vocabulary.checksum, theirs.atlas.vocabulary.checksum);
  const Alignment alignment = AlignMaps({&ours.atlas, 0}, {&theirs.atlas, 1});
  EXPECT_EQ(alignment.verdict, AlignmentVerdict::kAligned) << alignment.reason;
  EXPECT_TRUE(alignment.evidence.own_vocabulary);
  EXPECT_LT(ErrorOf(ours, *alignment.first_from_second).degrees, 0.5);
}

// Each as `map` 0 and 1: what is in neither direction to be aligned.
template <class Change>
void ExpectNoOverlap(const Change& change) {
  for (const std::size_t map : {0U, 1U}) {
    SyntheticSessions sessions = SynthesizeSessions(SmallPair());
    change(sessions.atlas.maps[map]);
    const Alignment alignment = Aligned(sessions.atlas);
    EXPECT_EQ(alignment.verdict, AlignmentVerdict::kNoOverlap) << map << ": " << alignment.reason;
    EXPECT_FALSE(alignment.reason.empty());
  }
}

TEST(AlignMaps, NothingIsInAnEmptyMap) {
  ExpectNoOverlap([](Map& map) { map = Map{.id = map.id}; });
}
TEST(AlignMaps, NothingIsInAMapWithoutKeyFrames) {
  ExpectNoOverlap([](Map& map) { map.keyframes.clear(); });
}
TEST(AlignMaps, NothingIsInAMapWithoutPoints) {
  ExpectNoOverlap([](Map& map) { map.points.clear(); });
}
TEST(AlignMaps, NothingIsInAMapOfBadKeyFrames) {
  ExpectNoOverlap([](Map& map) {
    for (KeyFrame& keyframe : map.keyframes) keyframe.bad = Flag(true);
  });
}
TEST(AlignMaps, NothingIsInAMapOfBadPoints) {
  ExpectNoOverlap([](Map& map) {
    for (MapPoint& point : map.points) point.bad = Flag(true);
  });
}
TEST(AlignMaps, NothingIsInAMapAtNan) {
  ExpectNoOverlap([](Map& map) {
    for (KeyFrame& keyframe : map.keyframes)
      keyframe.camera_from_world.translation.x() = std::numeric_limits<float>::quiet_NaN();
  });
}
TEST(AlignMaps, NothingIsInAMapOfPointsInOnePlace) {
  ExpectNoOverlap([](Map& map) {
    for (MapPoint& point : map.points) point.position.setConstant(1);
  });
}

// One keyframe is too little to be sure, but nothing breaks.
TEST(AlignMaps, OneKeyFrameIsNeverEnough) {
  for (const std::size_t map : {0U, 1U}) {
    SyntheticSessions sessions = SynthesizeSessions(SmallPair());
    Column<KeyFrame>& keyframes = sessions.atlas.maps[map].keyframes;
    for (std::size_t row = 0; row < keyframes.size(); ++row)
      keyframes[row].bad = Flag(row != (map == 0 ? keyframes.size() - 3 : 3));
    EXPECT_NE(Aligned(sessions.atlas).verdict, AlignmentVerdict::kAligned);
  }
}

// A map whose descriptors were lost, or whose words are nonsense, must not stop the others from being found.
TEST(AlignMaps, DamageToAFewKeyFramesIsBorne) {
  SyntheticSessions sessions = SynthesizeSessions(SmallPair());
  Column<KeyFrame>& keyframes = sessions.atlas.maps[1].keyframes;
  keyframes[0].features.descriptors.clear();
  keyframes[1].features.bag_of_words.words.resize(3);
  keyframes[2].features.feature_vector.sizes.assign(1, 4'000'000'000U);
  keyframes[3].camera = CameraId(77);
  const Outcome outcome = AlignSessions(sessions);
  EXPECT_TRUE(outcome.found()) << Describe(outcome);
}

}  // namespace
}  // namespace slamdb::testing
