// SPDX-License-Identifier: BSD-3-Clause
// 1. Three matches at random, of a list of the best ones that grows; their poses, of which a fourth match must agree
// with one.
// 2. Who agrees with it. A better one than before is refined over those who do, and asked again (LO-RANSAC).
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "slamdb/align/detail/camera_pose.h"
#include "slamdb/model/detail/ransac.h"

namespace slamdb::detail {
namespace {

constexpr int kMostSamples = 500;
constexpr double kConfidence = 0.999;
constexpr double kInlierError = 9.21;   // chi-square, two degrees of freedom, 99 %
constexpr double kSampleError = 100;    // of a pose from three matches alone
constexpr std::size_t kFirstList = 20;  // matches that the first samples are of
constexpr int kPolishings = 2;

}  // namespace

CameraPose PoseOf(const View& view) { return {view.rotation, view.translation}; }

void SetPose(View& view, const CameraPose& pose) {
  view.rotation = pose.rotation;
  view.translation = pose.translation;
  view.center = pose.center();
}

double PoseFinder::SquaredError(const PictureMatch& match, const CameraPose& pose) const {
  const Keypoint& keypoint = view_.keypoints[match.keypoint];
  Eigen::Vector2d pixel;
  if (!view_.lens.Project(pose * map_.points()[match.point].position, pixel))
    return std::numeric_limits<double>::infinity();
  const double sigma = view_.ScaleOf(keypoint.octave);
  return (pixel - PixelOf(keypoint)).squaredNorm() / (sigma * sigma);
}

std::vector<PictureMatch> PoseFinder::InliersOf(std::span<const PictureMatch> matches, const CameraPose& pose) const {
  std::vector<PictureMatch> inliers;
  std::ranges::copy_if(matches, std::back_inserter(inliers),
                       [&](const PictureMatch& match) { return SquaredError(match, pose) < kInlierError; });
  return inliers;
}

std::optional<CameraPose> PoseFinder::Find(std::span<const PictureMatch> matches, std::size_t fewest,
                                           std::uint64_t seed) const {
  if (matches.size() < std::max<std::size_t>(fewest, 4)) return std::nullopt;
  std::mt19937_64 random(seed);
  std::vector<PictureMatch> best;
  CameraPose found;
  const auto keep_better = [&](const CameraPose& pose) {
    std::vector<PictureMatch> inliers = InliersOf(matches, pose);
    if (inliers.size() <= best.size()) return false;
    best = std::move(inliers);
    found = pose;
    return true;
  };
  int needed = kMostSamples;
  for (int sample = 0; sample < needed; ++sample) {
    const std::size_t list = std::min(matches.size(), kFirstList + static_cast<std::size_t>(sample));
    std::array<std::size_t, 4> rows{};
    for (std::size_t& row : rows) row = random() % list;
    std::array<Eigen::Vector3d, 3> rays, points;
    for (std::size_t i = 0; i < 3; ++i) {
      rays[i] = rays_[matches[rows[i]].keypoint];
      points[i] = map_.points()[matches[rows[i]].point].position;
    }
    for (const CameraPose& pose : SolveP3p(rays, points)) {
      if (!(SquaredError(matches[rows[3]], pose) < kSampleError) || !keep_better(pose)) continue;
      for (int i = 0; i < kPolishings && best.size() > 3; ++i)
        if (!keep_better(Refine(std::vector(best), found, 4).pose)) break;
      needed = SamplesNeeded(best.size(), matches.size(), kConfidence, kMostSamples);
    }
  }
  if (best.size() < fewest) return std::nullopt;
  return found;
}

}  // namespace slamdb::detail
