// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/umeyama.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "slamdb/base/error.h"
#include "slamdb/synthetic/detail/random.h"

namespace slamdb {
namespace {

using synthetic::Random;
using ::testing::HasSubstr;
using Points = std::vector<Eigen::Vector3d>;

const Similarity3d kTruth{2.5, Eigen::Quaterniond(0.1, -0.8, 0.3, 0.5).normalized(), {100, -7, 3}};

Points RandomPoints(std::size_t count, std::uint64_t seed) {
  Random random({seed});
  Points points;
  for (std::size_t i = 0; i < count; ++i)
    points.emplace_back(random.Uniform(-5, 5), random.Uniform(-5, 5), random.Uniform(-5, 5));
  return points;
}

Points Moved(const Points& points, const Similarity3d& transform) {
  Points moved;
  for (const Eigen::Vector3d& point : points) moved.push_back(transform * point);
  return moved;
}

void ExpectNear(const Similarity3d& actual, const Similarity3d& expected, double tolerance) {
  EXPECT_NEAR(actual.scale, expected.scale, tolerance);
  EXPECT_LE(actual.rotation.angularDistance(expected.rotation), tolerance);
  EXPECT_LE((actual.translation - expected.translation).norm(), 100 * tolerance);
}

std::string MessageOf(const Points& source, const Points& target, const UmeyamaOptions& options = {}) {
  try {
    SolveUmeyama(source, target, options);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Umeyama, FindsTheExactTransform) {
  for (const std::size_t count : {3, 4, 10, 1000}) {
    const Points source = RandomPoints(count, count);
    const UmeyamaResult result = SolveUmeyama(source, Moved(source, kTruth), {});
    ExpectNear(result.target_from_source, kTruth, 1e-9);
    for (const double residual : result.residuals) EXPECT_LT(residual, 1e-9);
    EXPECT_EQ(result.inliers, std::vector<std::uint8_t>(count, 1));
  }
}

TEST(Umeyama, PointsOfAPlaneAreNotMirrored) {
  Points source = RandomPoints(20, 7);
  for (Eigen::Vector3d& point : source) point.z() = 0;
  ExpectNear(SolveUmeyama(source, Moved(source, kTruth), {}).target_from_source, kTruth, 1e-9);
  // A mirrored target still gets a rotation.
  Points mirrored = RandomPoints(20, 8), target = mirrored;
  for (Eigen::Vector3d& point : target) point.x() = -point.x();
  const Eigen::Matrix3d rotation = SolveUmeyama(mirrored, target, {}).target_from_source.rotation.toRotationMatrix();
  EXPECT_NEAR(rotation.determinant(), 1, 1e-9);
}

TEST(Umeyama, KeepsTheScaleWhenAsked) {
  const Points source = RandomPoints(50, 3);
  const Similarity3d rigid{1, kTruth.rotation, kTruth.translation};
  const Points target = Moved(source, rigid);
  ExpectNear(SolveUmeyama(source, target, {.with_scale = false}).target_from_source, rigid, 1e-9);
  EXPECT_EQ(SolveUmeyama(source, Moved(source, kTruth), {.with_scale = false}).target_from_source.scale, 1);
}

// Four corners of a square, one pulled outwards by 0.4: the means move by 0.1 in x and y.
TEST(Umeyama, ByHand) {
  const Points source = {{1, 1, 0}, {-1, 1, 0}, {-1, -1, 0}, {1, -1, 0}};
  Points target = source;
  target[0] += Eigen::Vector3d(0.4, 0.4, 0);
  const UmeyamaResult result = SolveUmeyama(source, target, {.with_scale = false});
  ExpectNear(result.target_from_source, {.translation = {0.1, 0.1, 0}}, 1e-12);
  EXPECT_NEAR(result.residuals[0], 0.3 * std::sqrt(2), 1e-12);
  EXPECT_NEAR(result.residuals[1], 0.1 * std::sqrt(2), 1e-12);
  // scale: sum of target . source over sum of squares = (8 + 0.8) / 8
  EXPECT_NEAR(SolveUmeyama(source, target, {}).target_from_source.scale, 1.1, 1e-12);
}

TEST(Umeyama, OutliersAreLeftOut) {
  const Points source = RandomPoints(300, 11);
  Points target = Moved(source, kTruth);
  Random random({12});
  for (std::size_t i = 0; i < target.size(); ++i) {
    target[i] += 0.01 * Eigen::Vector3d(random.Normal(), random.Normal(), random.Normal());
    if (i % 5 < 2) target[i] += Eigen::Vector3d(random.Uniform(20, 90), random.Uniform(20, 90), 0);
  }
  const UmeyamaResult plain = SolveUmeyama(source, target, {});
  EXPECT_GT((plain.target_from_source.translation - kTruth.translation).norm(), 1);
  const UmeyamaResult robust = SolveUmeyama(source, target, {.outlier_distance = 0.1});
  ExpectNear(robust.target_from_source, kTruth, 2e-3);
  for (std::size_t i = 0; i < target.size(); ++i) EXPECT_EQ(robust.inliers[i], i % 5 < 2 ? 0 : 1) << i;
  EXPECT_EQ(SolveUmeyama(source, target, {.outlier_distance = 0.1}).residuals, robust.residuals);
}

TEST(Umeyama, SaysHowLargeResidualsAre) {
  const Points square{{1, 1, 0}, {1, -1, 0}, {-1, 1, 0}, {-1, -1, 0}};
  const UmeyamaResult same = SolveUmeyama(square, square, {});
  EXPECT_NEAR(same.rms, 0, 1e-12);
  EXPECT_NEAR(same.spread, std::sqrt(2), 1e-12);
  EXPECT_FALSE(PoorFitWarning(same.rms, same.spread));
  EXPECT_FALSE(PoorFitWarning(0.1, 1));
  EXPECT_EQ(PoorFitWarning(0.5, 2)->find("the fit is poor: points that spread by 2 miss their places by 0.5"), 0U);
}

TEST(Umeyama, RefusesWhatDoesNotDetermineIt) {
  const Points two = {{0, 0, 0}, {1, 0, 0}};
  EXPECT_THAT(MessageOf(two, two), HasSubstr("at least 3 pairs"));
  EXPECT_THAT(MessageOf(two, {{0, 0, 0}}), HasSubstr("must correspond"));
  Points line;
  for (int i = 0; i < 10; ++i) line.emplace_back(i, 2 * i, 1e-7 * (i % 3));
  EXPECT_THAT(MessageOf(line, line), HasSubstr("one line"));
  const Points far = {{1e300, 0, 0}, {0, 1e300, 0}, {0, 0, 1e300}};
  EXPECT_THAT(MessageOf(far, far), HasSubstr("squares overflow"));
  const Points one(5, Eigen::Vector3d(1, 2, 3));
  EXPECT_THAT(MessageOf(one, one), HasSubstr("in one place"));
  Points holed = RandomPoints(5, 1);
  holed[2].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(MessageOf(RandomPoints(5, 1), holed), HasSubstr("NaN"));
  EXPECT_THAT(MessageOf(RandomPoints(30, 1), RandomPoints(30, 2), {.with_scale = false, .outlier_distance = 1e-6}),
              HasSubstr("agree"));
}

TEST(Umeyama, SolvesALineWhereAskedTo) {
  Points line;
  for (int i = 0; i < 10; ++i) line.emplace_back(i, 2 * i, -i);
  const UmeyamaResult fit = SolveUmeyama(line, Moved(line, kTruth), {.accept_line = true});
  EXPECT_TRUE(fit.on_line);
  EXPECT_NEAR(fit.rms, 0, 1e-9) << "whatever the rotation about it";
  EXPECT_NEAR(fit.target_from_source.scale, kTruth.scale, 1e-9);
  EXPECT_FALSE(SolveUmeyama(RandomPoints(9, 1), RandomPoints(9, 1), {.accept_line = true}).on_line);
  // One place that the origin's distance rounds, of which sim3 would make any scale.
  const Points one(1000, Eigen::Vector3d(0.1, 0.2, 1e6));
  const std::string message = MessageOf(one, RandomPoints(1000, 1), {.accept_line = true});
  EXPECT_THAT(message, HasSubstr("in one place"));
  EXPECT_EQ(message.find("line"), std::string::npos) << message;
  EXPECT_THAT(MessageOf(line, line, {.leave_out_gross = true, .accept_line = true}), HasSubstr("one line"));
}

}  // namespace
}  // namespace slamdb
