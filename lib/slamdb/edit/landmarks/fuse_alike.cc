// SPDX-License-Identifier: BSD-3-Clause
// 1. What of each landmark can be compared: a descriptor and a covariance.
// 2. For each landmark of the second part those of the first that are alike, found along the x axis.
// 3. Pairs are fused, the most alike first.
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <numeric>
#include <tuple>

#include "slamdb/base/detail/median.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/edit/landmarks/detail/points.h"
#include "slamdb/edit/landmarks/landmarks.h"

namespace slamdb {
namespace {

// MRPT: CLandmarksMap::TLikelihoodOptions, TInsertionOptions and the constants of its matching.
constexpr double kPositionSigma = 4, kSiftSigma = 100, kLeastLikelihood = 0.5;
constexpr double kLargestUncertainty = 4;  // in medians: bounds what is searched
constexpr std::size_t kMostPartners = 8;   // kept of each landmark of the second part

// The descriptor of a landmark that is compared; null: it has none.
const FeatureDescriptor* DescriptorOf(const Landmark& landmark) {
  if (landmark.features.empty()) return nullptr;
  const LandmarkFeature& feature = landmark.features.front();
  if (feature.type == FeatureType::kSift) return feature.FindDescriptor(DescriptorKind::kSift);
  for (const DescriptorKind kind : {DescriptorKind::kOrb, DescriptorKind::kBld, DescriptorKind::kLatch}) {
    const FeatureDescriptor* found =
        kind == DescriptorKind::kOrb ? detail::OrbOf(feature) : feature.FindDescriptor(kind);
    if (found != nullptr) return found;
  }
  return nullptr;
}

double SquaredEuclidean(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
  return std::transform_reduce(a.begin(), a.end(), b.begin(), 0.0, std::plus<>(), [](std::uint8_t x, std::uint8_t y) {
    const double difference = static_cast<double>(x) - static_cast<double>(y);
    return difference * difference;
  });
}

int DifferentBits(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
  return std::transform_reduce(a.begin(), a.end(), b.begin(), 0, std::plus<>(), [](std::uint8_t x, std::uint8_t y) {
    return std::popcount(static_cast<unsigned>(x ^ y));
  });
}

struct Pair {
  double likelihood = 0;
  std::size_t first = 0, second = 0;  // rows
  friend bool operator<(const Pair& a, const Pair& b) {
    return std::tie(b.likelihood, a.first, a.second) < std::tie(a.likelihood, b.first, b.second);
  }
};

class AlikeFuser {
 public:
  AlikeFuser(std::vector<Landmark>& landmarks, std::size_t second, const FuseAlikeOptions& options)
      : landmarks_(landmarks), second_(std::min(second, landmarks.size())), options_(options) {}

  FuseAlikeReport Run() {
    FindComparable();
    std::vector<Pair> pairs = FindPairs();
    std::ranges::sort(pairs, std::less<>());
    gone_.assign(landmarks_.size(), 0);
    std::vector<std::uint8_t> taken(second_, 0);
    for (const Pair& pair : pairs)
      if (!gone_[pair.second] && !taken[pair.first]) {
        taken[pair.first] = 1;
        Fuse(pair);
      }
    if (report_.fused == 0) return std::move(report_);
    report_.mean_distance /= static_cast<double>(report_.fused);
    std::ranges::sort(report_.replaced);
    std::erase_if(landmarks_, [&](const Landmark& landmark) {
      return gone_[static_cast<std::size_t>(&landmark - landmarks_.data())] != 0;
    });
    return std::move(report_);
  }

 private:
  // Reaches of 0 are of landmarks that are not compared.
  void FindComparable() {
    descriptors_.resize(landmarks_.size());
    reach_.assign(landmarks_.size(), 0);
    std::vector<double> known;
    for (std::size_t row = 0; row < landmarks_.size(); ++row) {
      const GaussianPoint pose = landmarks_[row].pose();
      descriptors_[row] = DescriptorOf(landmarks_[row]);
      const bool placed = pose.mean.allFinite() && pose.covariance.allFinite() && !pose.covariance.isZero(0);
      report_.plain += descriptors_[row] == nullptr;
      report_.unplaced += !placed;
      if (!placed || descriptors_[row] == nullptr) continue;
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(pose.covariance, Eigen::EigenvaluesOnly);
      const double largest = axes.eigenvalues().maxCoeff();
      if (!(largest > 0)) continue;
      reach_[row] = kPositionSigma * std::sqrt(2 * std::numbers::ln2 * largest);
      known.push_back(reach_[row]);
    }
    widest_ = kLargestUncertainty * detail::MedianOf(std::move(known));
    for (double& reach : reach_) reach = std::min(reach, widest_);
  }

  std::vector<Pair> FindPairs() const {
    std::vector<std::size_t> along;  // rows of the first part that can be compared, by x
    for (std::size_t row = 0; row < second_; ++row)
      if (reach_[row] > 0) along.push_back(row);
    std::ranges::sort(along, {}, [&](std::size_t row) { return std::pair(landmarks_[row].mean.x(), row); });
    std::vector<std::vector<Pair>> partners(landmarks_.size() - second_);
    detail::ParallelFor(partners.size(), 64, options_.threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) partners[i] = FindPartners(along, second_ + i);
    });
    std::vector<Pair> pairs;
    for (const std::vector<Pair>& some : partners) pairs.insert(pairs.end(), some.begin(), some.end());
    return pairs;
  }

  std::vector<Pair> FindPartners(const std::vector<std::size_t>& along, std::size_t row) const {
    std::vector<Pair> found;
    if (!(reach_[row] > 0)) return found;
    const auto x_of = [&](std::size_t other) { return landmarks_[other].mean.x(); };
    const double x = x_of(row);
    for (auto at = std::ranges::lower_bound(along, x - reach_[row] - widest_, {}, x_of); at != along.end(); ++at) {
      if (x_of(*at) > x + reach_[row] + widest_) break;
      const double apart = (landmarks_[*at].mean - landmarks_[row].mean).norm();
      if (apart > reach_[row] + reach_[*at]) continue;
      const double likelihood = Likelihood(*at, row);
      if (!(likelihood > kLeastLikelihood)) continue;
      found.push_back({likelihood, *at, row});
      std::ranges::push_heap(found, std::less<>());
      if (found.size() <= kMostPartners) continue;
      std::ranges::pop_heap(found, std::less<>());
      found.pop_back();
    }
    return found;
  }

  double Likelihood(std::size_t a, std::size_t b) const {
    const double squared = SquaredDescriptorDistance(a, b);
    if (squared < 0) return 0;
    const GaussianPoint first = landmarks_[a].pose(), second = landmarks_[b].pose();
    const Eigen::LLT<Eigen::Matrix3d> sum(first.covariance + second.covariance);
    if (sum.info() != Eigen::Success) return 0;
    const Eigen::Vector3d apart = second.mean - first.mean;
    return std::exp(-0.5 * apart.dot(sum.solve(apart)) / (kPositionSigma * kPositionSigma) - 0.5 * squared);
  }

  // In its standard deviations; below 0: the two cannot be compared.
  double SquaredDescriptorDistance(std::size_t a, std::size_t b) const {
    const FeatureDescriptor &first = *descriptors_[a], &second = *descriptors_[b];
    const FeatureType type = landmarks_[a].features.front().type;
    // Of an ORB feature either slot holds ORB.
    const bool same_kind = first.kind == second.kind || type == FeatureType::kOrb;
    if (type != landmarks_[b].features.front().type || !same_kind || first.bytes.empty() ||
        first.bytes.size() != second.bytes.size())
      return -1;
    if (first.kind == DescriptorKind::kSift)
      return SquaredEuclidean(first.bytes, second.bytes) / (kSiftSigma * kSiftSigma);
    const int bits = DifferentBits(first.bytes, second.bytes);
    if (bits > options_.hamming) return -1;
    // Above the limit by half a bit, so that it passes at one place.
    const double limit = options_.hamming + 0.5;
    return 2 * std::numbers::ln2 * bits * bits / (limit * limit);
  }

  void Fuse(const Pair& pair) {
    Landmark &first = landmarks_[pair.first], &second = landmarks_[pair.second];
    report_.mean_distance += (first.mean - second.mean).norm();
    ++report_.fused;
    gone_[pair.second] = 1;
    const LandmarkId gone = second.id;
    first = FuseLandmarks(first, second);
    if (gone && first.id != gone) report_.replaced.emplace_back(gone, first.id);
  }

  std::vector<Landmark>& landmarks_;
  std::size_t second_;
  const FuseAlikeOptions& options_;
  std::vector<const FeatureDescriptor*> descriptors_;
  std::vector<double> reach_;
  double widest_ = 0;
  std::vector<std::uint8_t> gone_;
  FuseAlikeReport report_;
};

}  // namespace

FuseAlikeReport FuseAlikeLandmarks(std::vector<Landmark>& landmarks, std::size_t second,
                                   const FuseAlikeOptions& options) {
  return AlikeFuser(landmarks, second, options).Run();
}

}  // namespace slamdb
