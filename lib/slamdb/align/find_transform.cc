// SPDX-License-Identifier: BSD-3-Clause
// 1. Three matches at random whose triangles are alike.
// 2. The similarity that lays one triangle on the other (Umeyama), and who agrees with it.
// 3. The best one is solved again from all who agree.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "slamdb/align/detail/fit.h"
#include "slamdb/model/detail/ransac.h"

namespace slamdb::detail {
namespace {

constexpr int kMostSamples = 600;
constexpr double kConfidence = 0.999;
constexpr double kSideRatio = 1.25;    // by which sides of the two triangles may differ, after the scale
constexpr double kInlierError = 9.21;  // chi-square, two degrees of freedom, 99 %
constexpr int kPolishings = 2;

using Sample = std::array<std::size_t, 3>;

const Eigen::Vector3d& PositionOf(const MapViews& map, const LocalPoint& point) {
  return map.points()[point.point].position;
}

Similarity3d ToSimilarity(const Eigen::Matrix4d& matrix, bool with_scale) {
  Similarity3d transform;
  const Eigen::Matrix3d scaled = matrix.topLeftCorner<3, 3>();
  transform.scale = with_scale ? std::cbrt(scaled.determinant()) : 1;
  transform.rotation = Eigen::Quaterniond(Eigen::Matrix3d(scaled / transform.scale)).normalized();
  transform.translation = matrix.topRightCorner<3, 1>();
  return transform;
}

class Sampler {
 public:
  Sampler(const MapViews& first, const MapViews& second, std::span<const PointMatch> matches, bool with_scale)
      : first_(first), second_(second), matches_(matches), with_scale_(with_scale) {}

  // Three different matches, or nothing when their triangles are not alike.
  std::optional<Sample> Draw(std::mt19937_64& random) const {
    Sample sample;
    for (std::size_t i = 0; i < sample.size(); ++i) {
      sample[i] = random() % matches_.size();
      for (std::size_t j = 0; j < i; ++j)
        if (sample[i] == sample[j]) return std::nullopt;
    }
    double least = 1e300, most = 0;
    for (std::size_t i = 0; i < sample.size(); ++i) {
      const PointMatch &a = matches_[sample[i]], &b = matches_[sample[(i + 1) % 3]];
      const double side = (PositionOf(first_, a.first) - PositionOf(first_, b.first)).norm();
      const double other = (PositionOf(second_, a.second) - PositionOf(second_, b.second)).norm();
      if (!(side > 0 && other > 0)) return std::nullopt;
      least = std::min(least, side / other);
      most = std::max(most, side / other);
    }
    const bool alike = with_scale_ ? most <= kSideRatio * least : most <= kSideRatio && least * kSideRatio >= 1;
    return alike ? std::optional(sample) : std::nullopt;
  }

  template <class Rows>
  Similarity3d Solve(const Rows& rows) const {
    Eigen::Matrix3Xd source(3, std::ssize(rows)), target(3, std::ssize(rows));
    Eigen::Index column = 0;
    for (const std::size_t row : rows) {
      source.col(column) = PositionOf(second_, matches_[row].second);
      target.col(column++) = PositionOf(first_, matches_[row].first);
    }
    return ToSimilarity(Eigen::umeyama(source, target, with_scale_), with_scale_);
  }

 private:
  const MapViews &first_, &second_;
  const std::span<const PointMatch> matches_;
  const bool with_scale_;
};

}  // namespace

bool PairGeometry::IsInlier(const PointMatch& match, const Similarity3d& first_from_second) const {
  const MatchErrors errors = ErrorsOf(match, first_from_second);
  return errors.in_first < kInlierError && errors.in_second < kInlierError;
}

std::vector<PointMatch> PairGeometry::InliersOf(std::span<const PointMatch> matches,
                                                const Similarity3d& first_from_second) const {
  std::vector<PointMatch> inliers;
  std::ranges::copy_if(matches, std::back_inserter(inliers),
                       [&](const PointMatch& match) { return IsInlier(match, first_from_second); });
  return inliers;
}

std::optional<Similarity3d> PairGeometry::FindTransform(std::span<const PointMatch> matches, std::size_t fewest,
                                                        std::uint64_t seed) const {
  if (matches.size() < std::max<std::size_t>(fewest, 3)) return std::nullopt;
  const Sampler sampler(first_, second_, matches, freedom() == Freedom::kSimilarity);
  std::mt19937_64 random(seed);
  std::vector<std::size_t> best;
  Similarity3d found;
  const auto keep_better = [&](const Similarity3d& transform) {
    if (!(transform.scale > 0 && std::isfinite(transform.scale))) return false;
    std::vector<std::size_t> rows;
    for (std::size_t row = 0; row < matches.size(); ++row)
      if (IsInlier(matches[row], transform)) rows.push_back(row);
    if (rows.size() <= best.size()) return false;
    best = std::move(rows);
    found = transform;
    return true;
  };
  int needed = kMostSamples;
  for (int sample = 0; sample < needed; ++sample) {
    const std::optional<Sample> rows = sampler.Draw(random);
    if (!rows || !keep_better(sampler.Solve(*rows))) continue;
    for (int i = 0; i < kPolishings && best.size() > 3; ++i)
      if (!keep_better(sampler.Solve(std::vector(best)))) break;
    needed = SamplesNeeded(best.size(), matches.size(), kConfidence, kMostSamples);
  }
  if (best.size() < fewest) return std::nullopt;
  return found;
}

}  // namespace slamdb::detail
