// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/landmark.h"

#include <algorithm>
#include <cmath>

#include "slamdb/base/error.h"

namespace slamdb {
namespace {

constexpr std::int64_t kTicksPerSecond = 10'000'000, kTicksTo1970 = 116'444'736'000'000'000;

}  // namespace

const FeatureDescriptor* LandmarkFeature::FindDescriptor(DescriptorKind kind) const {
  const auto found = std::find_if(descriptors.begin(), descriptors.end(),
                                  [kind](const FeatureDescriptor& descriptor) { return descriptor.kind == kind; });
  return found == descriptors.end() ? nullptr : &*found;
}

GaussianPoint Landmark::pose() const {
  GaussianPoint pose{.mean = mean};
  pose.covariance << cov_11, cov_12, cov_13, cov_12, cov_22, cov_23, cov_13, cov_23, cov_33;
  return pose;
}

void Landmark::set_pose(const GaussianPoint& pose) {
  mean = pose.mean;
  cov_11 = pose.covariance(0, 0);
  cov_22 = pose.covariance(1, 1);
  cov_33 = pose.covariance(2, 2);
  cov_12 = pose.covariance(0, 1);
  cov_13 = pose.covariance(0, 2);
  cov_23 = pose.covariance(1, 2);
}

FeatureType Landmark::type() const {
  if (features.empty()) throw Error(ErrorKind::kNotPossible, ToString(id) + " has no feature, and so no type");
  return features.front().type;
}

LandmarkFeature& Landmark::CreateOneFeature() {
  features.resize(1);
  return features.front();
}

void TransformLandmarks(std::span<Landmark> landmarks, const Similarity3d& target_from_source) {
  const double scale = target_from_source.scale;
  const Eigen::Matrix3d rotation = target_from_source.rotation.toRotationMatrix();
  for (Landmark& landmark : landmarks) {
    GaussianPoint pose = landmark.pose();
    pose.mean = target_from_source * pose.mean;
    pose.covariance = scale * scale * (rotation * pose.covariance * rotation.transpose());
    landmark.set_pose(pose);
    landmark.normal = rotation * landmark.normal;
    for (LandmarkFeature& feature : landmark.features) {
      feature.depth *= scale;
      feature.initial_depth *= scale;
      feature.position_in_camera *= scale;
    }
  }
}

std::uint64_t TicksOfSeconds(double seconds) {
  // The whole seconds apart, so that their fraction keeps its digits.
  const double whole = std::floor(seconds);
  if (!(whole >= -11'644'473'600.0 && whole < 910'692'730'085.0)) return 0;
  const auto ticks = static_cast<std::int64_t>(whole) * kTicksPerSecond + kTicksTo1970;
  return static_cast<std::uint64_t>(ticks + std::llround((seconds - whole) * static_cast<double>(kTicksPerSecond)));
}

double SecondsOfTicks(std::uint64_t ticks) {
  const auto since_1970 = static_cast<std::int64_t>(ticks - static_cast<std::uint64_t>(kTicksTo1970));
  const std::int64_t whole = since_1970 / kTicksPerSecond, rest = since_1970 % kTicksPerSecond;
  return static_cast<double>(whole) + static_cast<double>(rest) / static_cast<double>(kTicksPerSecond);
}

}  // namespace slamdb
