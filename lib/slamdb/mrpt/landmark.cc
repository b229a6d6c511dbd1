// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/mrpt/landmark.h"

#include <algorithm>
#include <cstring>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"

namespace slamdb::mrpt {
namespace {

using Bytes = std::vector<std::uint8_t>;

TPoint3D ToMrpt(const Eigen::Vector3d& point) { return {point.x(), point.y(), point.z()}; }
Eigen::Vector3d FromMrpt(const TPoint3D& point) { return {point.x, point.y, point.z}; }

// Floats and bytes of descriptors, bit for bit.
void Assign(std::optional<Bytes>& target, const Bytes& bytes) { target = bytes; }
void Assign(std::optional<std::vector<float>>& target, const Bytes& bytes) {
  if (bytes.size() % sizeof(float) != 0)
    throw Error(ErrorKind::kDamaged,
                slamdb::detail::Concat("a descriptor of ", bytes.size(), " bytes, expected a multiple of 4"));
  target.emplace(bytes.size() / sizeof(float));
  if (!bytes.empty()) std::memcpy(target->data(), bytes.data(), bytes.size());
}
Bytes BytesOf(const Bytes& bytes) { return bytes; }
Bytes BytesOf(const std::vector<float>& floats) {
  Bytes bytes(floats.size() * sizeof(float));
  if (!bytes.empty()) std::memcpy(bytes.data(), floats.data(), bytes.size());
  return bytes;
}

// Each kind of descriptor with its member, in the order of the kinds.
template <class Descriptors, class Visit>
void ForEachDescriptor(Descriptors& descriptors, const Visit& visit) {
  visit(DescriptorKind::kSift, descriptors.SIFT);
  visit(DescriptorKind::kSurf, descriptors.SURF);
  visit(DescriptorKind::kSpinImage, descriptors.SpinImg);
  visit(DescriptorKind::kPolarImage, descriptors.PolarImg);
  visit(DescriptorKind::kLogPolarImage, descriptors.LogPolarImg);
  visit(DescriptorKind::kOrb, descriptors.ORB);
  visit(DescriptorKind::kBld, descriptors.BLD);
  visit(DescriptorKind::kLatch, descriptors.LATCH);
}

CFeature ToMrpt(const LandmarkFeature& feature) {
  CFeature converted;
  converted.keypoint = {.pt = {feature.x, feature.y},
                        .ID = feature.keypoint_id,
                        .track_status = static_cast<TFeatureTrackStatus>(feature.track_status),
                        .response = feature.response,
                        .octave = feature.octave};
  if (feature.has_patch) converted.patch = feature.patch;
  converted.patchSize = feature.patch_size;
  converted.type = static_cast<TKeyPointMethod>(feature.type);
  converted.orientation = feature.orientation;
  converted.user_flags = feature.user_flags;
  converted.depth = feature.depth;
  converted.initialDepth = feature.initial_depth;
  converted.p3D = ToMrpt(feature.position_in_camera);
  converted.descriptors.SpinImg_range_rows = feature.spin_image_rows;
  converted.descriptors.polarImgsNoRotation = feature.polar_images_without_rotation;
  ForEachDescriptor(converted.descriptors, [&](DescriptorKind kind, auto& target) {
    if (const FeatureDescriptor* descriptor = feature.FindDescriptor(kind); descriptor != nullptr)
      Assign(target, descriptor->bytes);
  });
  return converted;
}

LandmarkFeature FromMrpt(const CFeature& feature) {
  LandmarkFeature converted;
  converted.x = feature.keypoint.pt.x;
  converted.y = feature.keypoint.pt.y;
  converted.keypoint_id = feature.keypoint.ID;
  converted.track_status = feature.keypoint.track_status;
  converted.response = feature.keypoint.response;
  converted.octave = feature.keypoint.octave;
  converted.has_patch = feature.patch.has_value();
  if (feature.patch) converted.patch = *feature.patch;
  converted.patch_size = feature.patchSize;
  converted.type = static_cast<FeatureType>(feature.type);
  converted.orientation = feature.orientation;
  converted.user_flags = feature.user_flags;
  converted.depth = feature.depth;
  converted.initial_depth = feature.initialDepth;
  converted.position_in_camera = FromMrpt(feature.p3D);
  converted.spin_image_rows = feature.descriptors.SpinImg_range_rows;
  converted.polar_images_without_rotation = feature.descriptors.polarImgsNoRotation;
  ForEachDescriptor(feature.descriptors, [&](DescriptorKind kind, const auto& source) {
    if (source) converted.descriptors.push_back({kind, BytesOf(*source)});
  });
  return converted;
}

}  // namespace

CLandmark::CLandmark(const Landmark& landmark)
    : pose_mean(ToMrpt(landmark.mean)),
      normal(ToMrpt(landmark.normal)),
      pose_cov_11(landmark.cov_11),
      pose_cov_22(landmark.cov_22),
      pose_cov_33(landmark.cov_33),
      pose_cov_12(landmark.cov_12),
      pose_cov_13(landmark.cov_13),
      pose_cov_23(landmark.cov_23),
      ID(static_cast<TLandmarkID>(landmark.id.value())),
      timestampLastSeen(Clock::duration(static_cast<Clock::rep>(landmark.last_seen))),
      seenTimesCount(landmark.seen_count) {
  for (const LandmarkFeature& feature : landmark.features) features.push_back(ToMrpt(feature));
}

Landmark CLandmark::ToLandmark() const {
  Landmark landmark;
  landmark.id = LandmarkId(static_cast<std::uint64_t>(ID));
  landmark.mean = FromMrpt(pose_mean);
  landmark.normal = FromMrpt(normal);
  landmark.cov_11 = pose_cov_11;
  landmark.cov_22 = pose_cov_22;
  landmark.cov_33 = pose_cov_33;
  landmark.cov_12 = pose_cov_12;
  landmark.cov_13 = pose_cov_13;
  landmark.cov_23 = pose_cov_23;
  landmark.last_seen = static_cast<std::uint64_t>(timestampLastSeen.time_since_epoch().count());
  landmark.seen_count = seenTimesCount;
  for (const CFeature& feature : features) landmark.features.push_back(FromMrpt(feature));
  return landmark;
}

void CLandmark::getPose(CPointPDFGaussian& p) const {
  p.mean = pose_mean;
  p.cov << pose_cov_11, pose_cov_12, pose_cov_13, pose_cov_12, pose_cov_22, pose_cov_23, pose_cov_13, pose_cov_23,
      pose_cov_33;
}

void CLandmark::getPose(TPoint3D& p, Eigen::MatrixXd& COV) const {
  CPointPDFGaussian pose;
  getPose(pose);
  p = pose.mean;
  COV = pose.cov;
}

void CLandmark::setPose(const CPointPDFGaussian& p) {
  pose_mean = p.mean;
  pose_cov_11 = p.cov(0, 0);
  pose_cov_22 = p.cov(1, 1);
  pose_cov_33 = p.cov(2, 2);
  pose_cov_12 = p.cov(0, 1);
  pose_cov_13 = p.cov(0, 2);
  pose_cov_23 = p.cov(1, 2);
}

TKeyPointMethod CLandmark::getType() const {
  if (features.empty())
    throw Error(ErrorKind::kNotPossible, slamdb::detail::Concat("landmark ", ID, " has no feature, and so no type"));
  return features.front().type;
}

void CLandmarksMap::TCustomSequenceLandmarks::erase(unsigned int indx) {
  if (indx < size()) landmarks_.erase(landmarks_.begin() + static_cast<std::ptrdiff_t>(indx));
}

const CLandmark* CLandmarksMap::TCustomSequenceLandmarks::getByID(TLandmarkID ID) const {
  const auto found = std::find_if(begin(), end(), [ID](const CLandmark& landmark) { return landmark.ID == ID; });
  return found == end() ? nullptr : &*found;
}

CLandmarksMap::CLandmarksMap(const std::vector<Landmark>& all) {
  for (const Landmark& landmark : all) landmarks.push_back(CLandmark(landmark));
}

std::vector<Landmark> CLandmarksMap::ToLandmarks() const {
  std::vector<Landmark> all;
  all.reserve(size());
  for (const CLandmark& landmark : landmarks) all.push_back(landmark.ToLandmark());
  return all;
}

}  // namespace slamdb::mrpt
