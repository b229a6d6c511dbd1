// SPDX-License-Identifier: BSD-3-Clause
// Landmarks that are the same place become one: alike ones, and those of one id.
#include <gmock/gmock.h>

#include <Eigen/LU>

#include "slamdb/edit/landmarks/landmarks.h"
#include "slamdb/edit/merge/join.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/edit/landmarks/some_landmarks.h"

namespace slamdb {
namespace {

using ::testing::SizeIs;

// A landmark with a descriptor of one kind, of whose bytes the first is `byte`.
Landmark Alike(double x, FeatureType type, std::uint8_t byte, double variance = 0.5) {
  Landmark landmark = LandmarkAt({x, 0, 5}, Eigen::Vector3d::Constant(variance));
  landmark.CreateOneFeature().type = type;
  std::vector<std::uint8_t> bytes(type == FeatureType::kSift ? 128 : 32, 10);
  bytes[0] = byte;
  landmark.features[0].descriptors = {
      {type == FeatureType::kSift ? DescriptorKind::kSift : DescriptorKind::kOrb, bytes}};
  return landmark;
}

bool AreFused(const Landmark& a, const Landmark& b, const FuseAlikeOptions& options = {}) {
  std::vector<Landmark> landmarks{a, b};
  return FuseAlikeLandmarks(landmarks, 1, options).fused == 1;
}

// The numbers of MRPT 2.5.8 itself: tests/mrpt.sh holds both against each other.
TEST(FuseAlikeLandmarks, TakesSiftAsMrptDoes) {
  constexpr FeatureType kSift = FeatureType::kSift;
  EXPECT_TRUE(AreFused(Alike(0, kSift, 10), Alike(4.7096, kSift, 10)));
  EXPECT_FALSE(AreFused(Alike(0, kSift, 10), Alike(4.7097, kSift, 10)));
  EXPECT_TRUE(AreFused(Alike(0, kSift, 10), Alike(0, kSift, 127)));
  EXPECT_FALSE(AreFused(Alike(0, kSift, 10), Alike(0, kSift, 128)));
  EXPECT_TRUE(AreFused(Alike(0, kSift, 10), Alike(2, kSift, 116)));
  EXPECT_FALSE(AreFused(Alike(0, kSift, 10), Alike(2, kSift, 117)));
}

TEST(FuseAlikeLandmarks, TakesOrbByBits) {
  constexpr FeatureType kOrb = FeatureType::kOrb;
  EXPECT_TRUE(AreFused(Alike(0, kOrb, 0), Alike(0, kOrb, 0xff), {.hamming = 8}));
  EXPECT_FALSE(AreFused(Alike(0, kOrb, 0), Alike(0, kOrb, 0xff), {.hamming = 7}));
  EXPECT_TRUE(AreFused(Alike(0, kOrb, 0), Alike(1, kOrb, 0), {.hamming = 0}));
  EXPECT_FALSE(AreFused(Alike(0, kOrb, 0), Alike(0, FeatureType::kSift, 0)));
  Landmark misplaced = Alike(0, kOrb, 3);  // as MRPT 2 reads and writes it again
  misplaced.features[0].descriptors[0].kind = DescriptorKind::kBld;
  EXPECT_TRUE(AreFused(Alike(0, kOrb, 3), misplaced));
}

TEST(FuseAlikeLandmarks, TheMostAlikeGoFirst) {
  constexpr FeatureType kSift = FeatureType::kSift;
  std::vector<Landmark> landmarks{Alike(0, kSift, 10), Alike(0.1, kSift, 10), Alike(0.06, kSift, 10),
                                  Alike(0.1, kSift, 10), Alike(90, kSift, 10)};
  for (std::size_t i = 0; i < landmarks.size(); ++i) landmarks[i].id = LandmarkId(10 + i);
  const FuseAlikeReport report = FuseAlikeLandmarks(landmarks, 2);
  EXPECT_EQ(report.fused, 2U);
  EXPECT_EQ(report.replaced, (std::vector<std::pair<LandmarkId, LandmarkId>>{{LandmarkId(12), LandmarkId(10)},
                                                                             {LandmarkId(13), LandmarkId(11)}}));
  ASSERT_THAT(landmarks, SizeIs(3));
  EXPECT_NEAR(landmarks[0].mean.x(), 0.03, 1e-12);
  EXPECT_EQ(landmarks[0].seen_count, 2U);
  EXPECT_EQ(landmarks[2].id, LandmarkId(14));
}

TEST(FuseAlikeLandmarks, LeavesWhatCannotBeCompared) {
  Landmark plain = LandmarkAt({0, 0, 5}, {1, 1, 1});
  std::vector<Landmark> landmarks{Alike(0, FeatureType::kOrb, 1, 0), plain, Alike(0, FeatureType::kOrb, 1, 0), plain};
  const FuseAlikeReport report = FuseAlikeLandmarks(landmarks, 2);
  EXPECT_EQ(report.fused, 0U);
  EXPECT_EQ(report.plain, 2U);
  EXPECT_EQ(report.unplaced, 2U);
  ASSERT_THAT(landmarks, SizeIs(4));
  EXPECT_EQ(FuseAlikeLandmarks(landmarks, 9).fused, 0U);
}

TEST(FuseAlikeLandmarks, ThreadsMakeNoDifference) {
  std::vector<Landmark> one;
  for (int i = 0; i < 3000; ++i)
    one.push_back(Alike(0.37 * (i % 1500), i % 2 == 0 ? FeatureType::kOrb : FeatureType::kSift,
                        static_cast<std::uint8_t>(i * 7), 0.02));
  std::vector<Landmark> many = one;
  EXPECT_EQ(FuseAlikeLandmarks(one, 1500, {.threads = 1}).fused, FuseAlikeLandmarks(many, 1500, {.threads = 4}).fused);
  ASSERT_EQ(one.size(), many.size());
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_EQ(one[i].mean, many[i].mean);
}

// Two maps of one room, made one without a transform.
TEST(JoinMaps, FusesMapsOfLandmarksAlone) {
  Atlas atlas = LandmarksOf(SynthesizeAtlas({.keyframes = 8, .points = 200}));
  const std::size_t count = atlas.maps[0].landmarks.size();
  atlas.maps.push_back(atlas.maps[0]);
  atlas.maps[0].id = MapId(0);
  atlas.maps[1].id = MapId(1);
  for (Landmark& landmark : atlas.maps[1].landmarks) landmark.id = LandmarkId(landmark.id.value() + 100'000);
  const JoinReport report = JoinMaps(atlas, {.first = MapId(0), .second = MapId(1), .fuse = FuseOptions{}});
  EXPECT_EQ(report.landmarks, count);
  ASSERT_TRUE(report.alike.has_value());
  EXPECT_EQ(report.fused_landmarks + report.alike->unplaced / 2, count);
  EXPECT_FALSE(report.link.first);
  EXPECT_THAT(atlas.maps, SizeIs(1));
}

TEST(FuseLandmarks, IsTheProductOfTheGaussians) {
  Landmark a = LandmarkAt({0, 0, 0}, {1, 4, 1}, 3), b = LandmarkAt({1, 1, 1}, {1, 1, 3}, 5);
  a.id = LandmarkId(8);
  a.last_seen = 70;
  b.last_seen = 90;
  a.normal = {0, 0, 1};
  b.normal = {0, 0, 1};
  b.CreateOneFeature().type = FeatureType::kOrb;
  const Landmark fused = FuseLandmarks(a, b);
  EXPECT_TRUE(fused.mean.isApprox(Eigen::Vector3d(0.5, 0.8, 0.25)));
  EXPECT_DOUBLE_EQ(fused.cov_11, 0.5);
  EXPECT_EQ(fused.cov_22, static_cast<double>(0.8F)) << "of floats comes one";
  EXPECT_DOUBLE_EQ(fused.cov_33, 0.75);
  EXPECT_EQ(fused.seen_count, 8U);
  EXPECT_EQ(fused.last_seen, 90U);
  EXPECT_EQ(fused.id, LandmarkId(8));
  EXPECT_TRUE(fused.normal.isApprox(Eigen::Vector3d(0, 0, 1)));
  EXPECT_EQ(fused.type(), FeatureType::kOrb);
}

TEST(FuseLandmarks, EqualsTheInformationForm) {
  Landmark a = LandmarkAt({0.1, 0.2, 0.3}, {1, 2, 3}), b = LandmarkAt({0.3, 0.1, -0.3}, {2, 0.5, 1});
  a.cov_12 = 0.7;
  a.cov_23 = -0.4;
  b.cov_13 = 0.9;
  const Eigen::Matrix3d information = a.pose().covariance.inverse() + b.pose().covariance.inverse();
  const Eigen::Vector3d mean =
      information.inverse() * (a.pose().covariance.inverse() * a.mean + b.pose().covariance.inverse() * b.mean);
  for (const Landmark& fused : {FuseLandmarks(a, b), FuseLandmarks(b, a)}) {
    EXPECT_TRUE(fused.mean.isApprox(mean));
    EXPECT_TRUE(fused.pose().covariance.isApprox(information.inverse()));
  }
}

// Landmarks of one plane, known exactly across it.
TEST(FuseLandmarks, WorksWhereADirectionHasNoUncertainty) {
  const Landmark fused = FuseLandmarks(LandmarkAt({0, 0, 2}, {1, 4, 0}), LandmarkAt({1, 1, 2}, {1, 1, 0}));
  EXPECT_TRUE(fused.mean.isApprox(Eigen::Vector3d(0.5, 0.8, 2)));
  EXPECT_TRUE(fused.pose().covariance.isApprox(Eigen::Vector3d(0.5, 0.8, 0).asDiagonal().toDenseMatrix(), 1e-6));
}

TEST(FuseLandmarks, AnUnknownCovarianceYields) {
  const Landmark known = LandmarkAt({1, 1, 1}, {2, 2, 2}, 1), a = LandmarkAt({3, 3, 3}, {0, 0, 0}, 9),
                 b = LandmarkAt({0, 0, 0}, {0, 0, 0}, 3);
  EXPECT_EQ(FuseLandmarks(known, a).mean, known.mean);
  EXPECT_EQ(FuseLandmarks(a, known).cov_11, 2);
  EXPECT_TRUE(FuseLandmarks(a, b).mean.isApprox(Eigen::Vector3d(2.25, 2.25, 2.25)));  // 9 to 3
  Landmark often = a;
  often.seen_count = 0xffffffff;
  EXPECT_EQ(FuseLandmarks(often, b).seen_count, 0xffffffffU);
}

TEST(TakeLandmarks, FusesEqualIdsAndAddsTheRest) {
  std::vector<Landmark> into{LandmarkAt({0, 0, 0}, {1, 1, 1}), LandmarkAt({5, 5, 5}, {1, 1, 1})};
  into[0].id = LandmarkId(1);
  std::vector<Landmark> from{LandmarkAt({1, 1, 1}, {1, 1, 1}), LandmarkAt({2, 2, 2}, {1, 1, 1}),
                             LandmarkAt({3, 3, 3}, {1, 1, 1})};
  from[0].id = LandmarkId(1);
  from[2].id = LandmarkId(2);
  EXPECT_EQ(TakeLandmarks(into, from), 1U);
  ASSERT_THAT(into, SizeIs(4));
  EXPECT_TRUE(into[0].mean.isApprox(Eigen::Vector3d(0.5, 0.5, 0.5)));
  EXPECT_EQ(into[0].seen_count, 2U);
  EXPECT_EQ(into[2].mean, from[1].mean);
  EXPECT_EQ(into[3].id, LandmarkId(2));
}

}  // namespace
}  // namespace slamdb
