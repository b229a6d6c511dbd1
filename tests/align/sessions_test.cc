// SPDX-License-Identifier: BSD-3-Clause
// Sessions over sensors, overlaps and seeds are found where they share enough, and never joined wrongly. The whole
// table is printed by slamdb_align_table (docs/align.md).
#include <gmock/gmock.h>

#include "slamdb/align/align_all.h"
#include "tests/align/trial.h"

namespace slamdb::testing {
namespace {

using Kind = std::tuple<Sensor, bool>;

class SessionsOf : public ::testing::TestWithParam<Kind> {
 protected:
  Outcome Overlapping(double overlap, std::uint64_t seed) const {
    const auto [sensor, inertial] = GetParam();
    return AlignSessions(SynthesizeSessions(PairOfSessions(sensor, inertial, overlap, seed)));
  }
};

TEST_P(SessionsOf, AreFoundFromAFifthOfOverlapOn) {
  std::uint64_t seed = 100;
  for (const double overlap : {0.2, 0.4, 0.8, 1.0}) {
    const Outcome outcome = Overlapping(overlap, ++seed);
    EXPECT_TRUE(outcome.found()) << overlap << ": " << Describe(outcome);
  }
}

TEST_P(SessionsOf, AreRefusedWhereTheyShareNothingOrTooLittle) {
  for (const std::uint64_t seed : {110U, 111U}) {
    const Outcome outcome = Overlapping(0, seed);
    EXPECT_EQ(outcome.alignment.verdict, AlignmentVerdict::kNoOverlap) << Describe(outcome);
    const Outcome little = Overlapping(0.03, seed);
    EXPECT_FALSE(little.aligned()) << Describe(little);
  }
}

TEST_P(SessionsOf, OfRoomsThatLookAlikeAreRefused) {
  const auto [sensor, inertial] = GetParam();
  for (const std::uint64_t seed : {120U, 121U}) {
    const Outcome outcome = AlignSessions(SynthesizeSessions(PairOfLookAlikes(sensor, inertial, seed)));
    EXPECT_EQ(outcome.alignment.verdict, AlignmentVerdict::kNoOverlap) << Describe(outcome);
    EXPECT_GT(outcome.alignment.evidence.agreeing, 0U) << "or it was no temptation";
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, SessionsOf,
                         ::testing::Values(Kind{Sensor::kMonocular, false}, Kind{Sensor::kMonocular, true},
                                           Kind{Sensor::kStereo, true}, Kind{Sensor::kRgbd, false},
                                           Kind{Sensor::kFisheyeStereo, false}));

// A covariance says how far off the truth may be, here within five standard deviations.
TEST(Sessions, LieWhereTheCovarianceSays) {
  for (const std::uint64_t seed : {130U, 131U, 132U, 133U}) {
    const SyntheticSessions sessions = SynthesizeSessions(PairOfSessions(Sensor::kMonocular, false, 0.4, seed));
    const Outcome outcome = AlignSessions(sessions);
    ASSERT_TRUE(outcome.found()) << Describe(outcome);
    const Alignment& alignment = outcome.alignment;
    const Similarity3d motion = *alignment.first_from_second * TrueTransform(sessions).Inverse();
    const Eigen::AngleAxisd turn(motion.rotation);
    Eigen::Matrix<double, 7, 1> error;
    error << turn.angle() * turn.axis(), motion * alignment.center - alignment.center, std::log(motion.scale);
    EXPECT_LT(error.dot(alignment.covariance.ldlt().solve(error)), 7 * 25) << seed;
  }
}

// Of a chain of sessions the first and the last share nothing, but the others bring them together.
TEST(Sessions, InAChainComeIntoOneFrame) {
  SyntheticOptions options = PairOfSessions(Sensor::kMonocular, false, 0.4, 140);
  options.maps = 3;
  const SyntheticSessions sessions = SynthesizeSessions(options);
  const std::array maps{MapRef{&sessions.atlas, 0}, MapRef{&sessions.atlas, 1}, MapRef{&sessions.atlas, 2}};
  const AlignedMaps aligned = AlignAllMaps(maps);
  ASSERT_EQ(aligned.places.size(), 3U);
  for (std::size_t map = 0; map < 3; ++map) {
    EXPECT_EQ(aligned.places[map].group, 0U);
    const Similarity3d truth = sessions.room_from_map[0].Inverse() * sessions.room_from_map[map];
    EXPECT_LT(truth.rotation.angularDistance(aligned.places[map].group_from_map.rotation), 0.02);
    EXPECT_NEAR(aligned.places[map].group_from_map.scale / truth.scale, 1, 0.03);
  }
  for (const MapLink& link : aligned.links) EXPECT_NE(link.use, LinkUse::kContradicts);
}

}  // namespace
}  // namespace slamdb::testing
