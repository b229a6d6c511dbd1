// SPDX-License-Identifier: BSD-3-Clause
// The transform between two maps from matched points: RANSAC, least squares, covariance, consensus.
#include "slamdb/align/detail/fit.h"

#include <gmock/gmock.h>

#include <numbers>
#include <random>

#include "slamdb/align/detail/consensus.h"
#include "slamdb/align/detail/verify.h"
#include "tests/align/worlds.h"

namespace slamdb::testing {
namespace {

using detail::Fit;
using detail::Freedom;
using detail::PointMatch;

double Turned(const Similarity3d& a, const Similarity3d& b) {
  return a.rotation.angularDistance(b.rotation) * 180 / std::numbers::pi;
}

// A transform so many degrees and first map's units, and a share of the scale, from another.
Similarity3d Off(const Similarity3d& from, double degrees, double shift, double scale) {
  const Eigen::Quaterniond turn(
      Eigen::AngleAxisd(degrees * std::numbers::pi / 180, Eigen::Vector3d(1, 2, -1).normalized()));
  return {from.scale * (1 + scale), (turn * from.rotation).normalized(),
          from.translation + shift * Eigen::Vector3d(2, -1, 2) / 3};
}

class EverySensor : public ::testing::TestWithParam<std::tuple<Sensor, bool>> {
 protected:
  PreparedPair two_{SmallPair(std::get<0>(GetParam()), std::get<1>(GetParam()))};
};

TEST_P(EverySensor, FreedomIsWhatTheMapsDoNotKnow) {
  const auto [sensor, inertial] = GetParam();
  const Freedom expected = inertial                       ? Freedom::kUpright
                           : sensor == Sensor::kMonocular ? Freedom::kSimilarity
                                                          : Freedom::kRigid;
  EXPECT_EQ(two_.pair.geometry.freedom(), expected);
}

TEST_P(EverySensor, RansacFindsTheTruthAmongFalseMatches) {
  std::vector<PointMatch> matches = two_.TrueMatches();
  ASSERT_GE(matches.size(), 60U);
  const std::size_t right = matches.size();
  for (std::size_t i = 0; i < right; ++i)  // as many that are false
    matches.push_back({matches[i].first, matches[(i * 7 + 31) % right].second});
  const auto& geometry = two_.pair.geometry;
  const auto found = geometry.FindTransform(matches, 20, 1);
  ASSERT_TRUE(found);
  EXPECT_LT(Turned(*found, two_.truth()), 0.5);
  EXPECT_NEAR(found->scale / two_.truth().scale, 1, 0.01);
  EXPECT_GE(geometry.InliersOf(matches, *found).size(), right * 95 / 100);
  const auto again = geometry.FindTransform(matches, 20, 1);
  EXPECT_EQ(again->translation, found->translation) << "the same seed, the same result";
}

TEST_P(EverySensor, LeastSquaresFindsTheTruthFromNearBy) {
  const std::vector<PointMatch> matches = two_.TrueMatches();
  const bool free_scale = two_.pair.geometry.freedom() == Freedom::kSimilarity;
  const double unit = 1 / two_.sessions.room_from_map[0].scale;  // of a metre
  const Similarity3d start = Off(two_.truth(), 2, 0.1 * unit, free_scale ? 0.05 : 0);
  const Fit fit = two_.pair.geometry.Refine(matches, start, 30);
  EXPECT_LT(Turned(fit.first_from_second, two_.truth()), 0.01);
  EXPECT_LT((fit.first_from_second.translation - two_.truth().translation).norm(), 2e-3 * unit);
  EXPECT_NEAR(fit.first_from_second.scale / two_.truth().scale, 1, 1e-3);
  EXPECT_EQ(fit.residuals, 4 * matches.size());
  EXPECT_LT(fit.cost / static_cast<double>(fit.residuals), 1e-3) << "keypoints have no noise";
  EXPECT_EQ(fit.covariance(6, 6) > 0, free_scale);
  if (two_.pair.geometry.freedom() == Freedom::kUpright) {
    EXPECT_LT((fit.first_from_second.rotation * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitZ()).norm(), 1e-6);
    EXPECT_LT(fit.covariance(0, 0), 1e-3 * fit.covariance(2, 2)) << "gravity is known";
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, EverySensor,
                         ::testing::Combine(::testing::Values(Sensor::kMonocular, Sensor::kStereo, Sensor::kRgbd,
                                                              Sensor::kFisheyeStereo),
                                            ::testing::Bool()));

TEST(PairGeometry, TooFewMatchesGiveNothing) {
  const PreparedPair two(SmallPair());
  const std::vector<PointMatch> matches = two.TrueMatches();
  const std::span few(matches.data(), 2);
  EXPECT_FALSE(two.pair.geometry.FindTransform(few, 2, 1));
  EXPECT_FALSE(two.pair.geometry.FindTransform({}, 0, 1));
  EXPECT_FALSE(two.pair.geometry.FindTransform(std::vector(8, matches[0]), 8, 1)) << "one point makes no triangle";
  const Fit none = two.pair.geometry.Refine({}, two.truth());
  EXPECT_EQ(none.residuals, 0U);
  EXPECT_EQ(none.first_from_second.translation, two.truth().translation);
}

TEST(PairGeometry, BehindACameraIsNoInlier) {
  const PreparedPair two(SmallPair());
  const Similarity3d turned{1, two.truth().rotation * Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitY()),
                            Eigen::Vector3d::Zero()};
  for (const PointMatch& match : two.TrueMatches()) EXPECT_FALSE(two.pair.geometry.IsInlier(match, turned));
}

// Over many draws of the keypoints' noise, the errors of the transform are as large as its covariance says.
TEST(PairGeometry, CovarianceIsThatOfManyTrials) {
  constexpr int kTrials = 60;
  SyntheticOptions options = SmallPair(Sensor::kMonocular);
  PreparedPair two(options);
  const std::vector<PointMatch> matches = two.TrueMatches();
  std::mt19937_64 draws(11);
  std::normal_distribution<double> normal;
  std::vector<std::pair<Keypoint*, Keypoint>> keypoints;  // and what they were
  for (std::size_t map = 0; map < 2; ++map)
    for (KeyFrame& keyframe : two.sessions.atlas.maps[map].keyframes)
      for (Keypoint& keypoint : keyframe.features.undistorted) keypoints.emplace_back(&keypoint, keypoint);
  Eigen::Matrix<double, 7, 7> sum = Eigen::Matrix<double, 7, 7>::Zero(), claimed = sum;
  for (int trial = 0; trial < kTrials; ++trial) {
    for (auto& [keypoint, was] : keypoints) {
      const double sigma = std::pow(1.2, was.octave);
      keypoint->x = was.x + static_cast<float>(sigma * normal(draws));
      keypoint->y = was.y + static_cast<float>(sigma * normal(draws));
    }
    const Fit fit = two.pair.geometry.Refine(matches, two.truth(), 20);
    const Similarity3d motion = fit.first_from_second * two.truth().Inverse();
    const Eigen::AngleAxisd turn(motion.rotation);
    Eigen::Matrix<double, 7, 1> error;
    error << turn.angle() * turn.axis(), motion * fit.center - fit.center, std::log(motion.scale);
    sum += error * error.transpose() / kTrials;
    claimed += fit.covariance / kTrials;
  }
  for (int i = 0; i < 7; ++i) EXPECT_NEAR(std::sqrt(sum(i, i) / claimed(i, i)), 1, 0.35) << i;
}

TEST(Consensus, LargestSetOfWhatAgreesComesFirst) {
  const PreparedPair two(SmallPair());
  const std::vector<PointMatch> matches = two.TrueMatches();
  const auto hypothesis = [&](std::uint32_t view, const Similarity3d& transform, std::size_t inliers) {
    return detail::Hypothesis{
        {view, view, 1}, transform, {matches.begin(), matches.begin() + static_cast<std::ptrdiff_t>(inliers)}};
  };
  const Similarity3d truth = two.truth(), other = Off(truth, 30, 1, 0);
  const std::vector hypotheses{hypothesis(0, other, 50), hypothesis(1, truth, 20),
                               hypothesis(2, Off(truth, 1, 0.01, 0), 22), hypothesis(2, Off(truth, 0, 0.02, 0), 21),
                               hypothesis(3, Off(truth, 0, 0, 0.2), 16)};
  const auto found = detail::FindConsensus(two.pair, hypotheses);
  ASSERT_EQ(found.size(), 3U);
  EXPECT_THAT(found[0].members, ::testing::UnorderedElementsAre(1U, 2U, 3U));
  EXPECT_EQ(found[0].inliers, 63U);
  EXPECT_EQ(found[0].second_keyframes, 2U);
  EXPECT_THAT(found[1].members, ::testing::ElementsAre(0U)) << "one strong pair alone";
  EXPECT_THAT(found[2].members, ::testing::ElementsAre(4U)) << "another scale";
  EXPECT_TRUE(detail::FindConsensus(two.pair, {}).empty());
}

// What pictures must show is there when the maps lie right, and is not when they lie wrong.
TEST(LookFor, FindsPointsWhereTheyAreAndNowhereElse) {
  SyntheticOptions options = SmallPair();
  options.sessions->common = 1;
  const PreparedPair two(options);
  const detail::MapViews &first = two.maps[0].views, &second = two.maps[1].views;
  const detail::SeenShare right = detail::LookFor(second, first, two.truth(), 1);
  EXPECT_GT(right.found_share(), 0.95);
  EXPECT_GT(right.cell_share(), 0.99);
  EXPECT_EQ(right.agreeing_views, right.views);
  EXPECT_LT(right.front_share(), 0.01);
  const detail::SeenShare wrong = detail::LookFor(second, first, Off(two.truth(), 6, 0.3, 0), 1);
  EXPECT_GT(wrong.views, 0U);
  EXPECT_LT(wrong.found_share(), 0.05);
  EXPECT_LT(wrong.cell_share(), 0.1);
  const Similarity3d near{1, two.truth().rotation, two.truth().translation - Eigen::Vector3d(0, 0, 1)};
  EXPECT_EQ(detail::LookFor(second, first, two.truth(), 3).found, right.found) << "for any number of threads";
  EXPECT_GT(detail::LookFor(second, first, near, 1).in_front, 0U);
}

}  // namespace
}  // namespace slamdb::testing
