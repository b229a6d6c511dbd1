// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/landmarks/landmarks.h"

#include <Eigen/QR>
#include <algorithm>
#include <limits>
#include <unordered_map>

namespace slamdb {
namespace {

bool IsKnown(const GaussianPoint& pose) { return !pose.covariance.isZero(0); }

double WeightOf(const Landmark& landmark) { return std::max(1.0, static_cast<double>(landmark.seen_count)); }

Eigen::Vector3d WeightedMean(const Landmark& a, const Eigen::Vector3d& of_a, const Landmark& b,
                             const Eigen::Vector3d& of_b) {
  const double share = WeightOf(b) / (WeightOf(a) + WeightOf(b));
  return of_a + share * (of_b - of_a);
}

// In the form m1 + K (m2 - m1) with K = C1 (C1 + C2)^-1, which needs no inverse of either. Where both know a direction
// exactly, the sum has none either; `a` is believed there.
GaussianPoint Product(const GaussianPoint& a, const GaussianPoint& b) {
  const Eigen::Matrix3d sum = a.covariance + b.covariance;
  const Eigen::Matrix3d gain = a.covariance * sum.completeOrthogonalDecomposition().pseudoInverse();
  const Eigen::Matrix3d covariance = a.covariance - gain * a.covariance;
  return {a.mean + gain * (b.mean - a.mean), 0.5 * (covariance + covariance.transpose())};
}

GaussianPoint FusedPose(const Landmark& a, const Landmark& b) {
  const GaussianPoint of_a = a.pose(), of_b = b.pose();
  if (IsKnown(of_a) && IsKnown(of_b)) {
    const GaussianPoint product = Product(of_a, of_b);
    if (product.mean.allFinite() && product.covariance.allFinite()) return product;
  } else if (IsKnown(of_a)) {
    return of_a;
  } else if (IsKnown(of_b)) {
    return of_b;
  }
  return {WeightedMean(a, a.mean, b, b.mean), Eigen::Matrix3d::Zero()};
}

bool IsOfFloats(const Eigen::Matrix3d& matrix) { return matrix == matrix.cast<float>().cast<double>(); }

std::uint32_t Sum(std::uint32_t a, std::uint32_t b) {
  return a > std::numeric_limits<std::uint32_t>::max() - b ? std::numeric_limits<std::uint32_t>::max() : a + b;
}

}  // namespace

Landmark FuseLandmarks(const Landmark& a, const Landmark& b) {
  Landmark fused = a;
  GaussianPoint pose = FusedPose(a, b);
  if (IsOfFloats(a.pose().covariance) && IsOfFloats(b.pose().covariance))
    pose.covariance = pose.covariance.cast<float>().cast<double>().eval();
  fused.set_pose(pose);
  const Eigen::Vector3d normal = WeightedMean(a, a.normal, b, b.normal);
  fused.normal = normal.isZero(0) ? normal : normal.normalized();
  fused.seen_count = Sum(a.seen_count, b.seen_count);
  fused.last_seen = std::max(a.last_seen, b.last_seen);
  if (!fused.id) fused.id = b.id;
  if (fused.features.empty()) fused.features = b.features;
  return fused;
}

std::uint64_t TakeLandmarks(std::vector<Landmark>& into, std::span<const Landmark> from) {
  std::unordered_map<LandmarkId, std::size_t> rows;
  rows.reserve(into.size() + from.size());
  for (std::size_t row = 0; row < into.size(); ++row)
    if (into[row].is_numbered()) rows.emplace(into[row].id, row);
  std::uint64_t fused = 0;
  for (const Landmark& landmark : from) {
    const auto [found, is_new] =
        landmark.is_numbered() ? rows.emplace(landmark.id, into.size()) : std::pair{rows.end(), true};
    if (is_new) {
      into.push_back(landmark);
    } else {
      into[found->second] = FuseLandmarks(into[found->second], landmark);
      ++fused;
    }
  }
  return fused;
}

}  // namespace slamdb
