// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <charconv>

#include "slamdb/formats/export/detail/raw.h"
#include "slamdb/formats/mrpt/detail/landmarks.h"
#include "slamdb/formats/mrpt/detail/stream.h"

namespace slamdb::mrpt {
namespace {

void AppendBytes(std::string& out, const std::vector<std::uint8_t>& bytes) {
  out.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

// An optional descriptor of numbers of `size` bytes.
void AppendNumbers(std::string& out, std::string_view tag, const FeatureDescriptor* descriptor, std::size_t size) {
  out.append(tag);
  out.push_back(descriptor != nullptr ? 1 : 0);
  if (descriptor == nullptr) return;
  detail::AppendRaw(out, static_cast<std::uint32_t>(descriptor->bytes.size() / size));
  AppendBytes(out, descriptor->bytes);
}

void AppendMatrix(std::string& out, const FeatureDescriptor* descriptor) {
  out.append(kOptionalMatrix);
  out.push_back(descriptor != nullptr ? 1 : 0);
  if (descriptor != nullptr) AppendBytes(out, descriptor->bytes);
}

void AppendDescriptors(std::string& out, const LandmarkFeature& feature, bool own_slots) {
  const auto find = [&](DescriptorKind kind) { return feature.FindDescriptor(kind); };
  AppendNumbers(out, kOptionalBytes, find(DescriptorKind::kSift), 1);
  AppendNumbers(out, kOptionalFloats, find(DescriptorKind::kSurf), sizeof(float));
  AppendNumbers(out, kOptionalFloats, find(DescriptorKind::kSpinImage), sizeof(float));
  detail::AppendRaw(out, feature.spin_image_rows);
  AppendMatrix(out, find(DescriptorKind::kPolarImage));
  AppendMatrix(out, find(DescriptorKind::kLogPolarImage));
  out.push_back(feature.polar_images_without_rotation ? 1 : 0);
  const FeatureDescriptor *orb = find(DescriptorKind::kOrb), *latch = find(DescriptorKind::kLatch);
  // Both in their own slots where there are both, or where nobody would look for ORB in the last one.
  const bool orb_last = !own_slots && orb != nullptr && latch == nullptr && feature.type == FeatureType::kOrb;
  AppendNumbers(out, kOptionalBytes, orb_last ? nullptr : orb, 1);
  AppendNumbers(out, kOptionalBytes, find(DescriptorKind::kBld), 1);
  AppendNumbers(out, kOptionalBytes, orb_last ? orb : latch, 1);
}

void AppendFeature(std::string& out, const LandmarkFeature& feature, bool own_slots) {
  static const std::string header = HeaderOf(kFeatureClass, kFeatureVersion);
  out.append(header);
  detail::AppendRaw(out, feature.x);
  detail::AppendRaw(out, feature.y);
  detail::AppendRaw(out, feature.keypoint_id);
  out.append(kOptionalImage);
  out.push_back(feature.has_patch ? 1 : 0);
  if (feature.has_patch) AppendBytes(out, feature.patch);
  detail::AppendRaw(out, feature.patch_size);
  detail::AppendRaw(out, static_cast<std::int32_t>(feature.type));
  detail::AppendRaw(out, feature.track_status);
  detail::AppendRaw(out, feature.response);
  detail::AppendRaw(out, feature.orientation);
  detail::AppendRaw(out, feature.octave);
  detail::AppendRaw(out, feature.user_flags);
  detail::AppendRaw(out, feature.depth);
  detail::AppendRaw(out, feature.initial_depth);
  for (const double value : feature.position_in_camera) detail::AppendRaw(out, value);
  AppendDescriptors(out, feature, own_slots);
  out.push_back(kEndFlag);
}

std::array<double, 6> Covariance(const Landmark& landmark) {
  return {landmark.cov_11, landmark.cov_22, landmark.cov_33, landmark.cov_12, landmark.cov_13, landmark.cov_23};
}

// Right-aligned in `width` columns.
void AppendPadded(std::string& out, std::string_view text, std::size_t width) {
  out.append(width - std::min(width, text.size()), ' ').append(text);
}

void AppendFixed(std::string& out, double value) {
  std::array<char, 512> text;
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, 6);
  AppendPadded(out, {text.data(), static_cast<std::size_t>(end - text.data())}, 10);
}

}  // namespace

void AppendLandmark2(std::string& out, const Landmark& landmark, bool own_slots) {
  static const std::string header = HeaderOf(kLandmarkClass, kLandmarkVersion);
  out.append(header).append(kFeatureVector);
  detail::AppendRaw(out, static_cast<std::uint32_t>(landmark.features.size()));
  for (const LandmarkFeature& feature : landmark.features) AppendFeature(out, feature, own_slots);
  for (const double value : landmark.mean) detail::AppendRaw(out, value);
  for (const double value : landmark.normal) detail::AppendRaw(out, value);
  for (const double value : Covariance(landmark)) detail::AppendRaw(out, static_cast<float>(value));
  detail::AppendRaw(out, landmark.id.value());
  detail::AppendRaw(out, landmark.last_seen);
  detail::AppendRaw(out, landmark.seen_count);
  out.push_back(kEndFlag);
}

void AppendLandmark3(std::string& out, const Landmark& landmark) {
  detail::AppendRaw(out, landmark.id.value());
  for (const double value : landmark.mean) detail::AppendRaw(out, value);
  for (const double value : Covariance(landmark)) detail::AppendRaw(out, value);
  detail::AppendRaw(out, landmark.seen_count);
}

void AppendLandmarkText(std::string& out, const Landmark& landmark) {
  constexpr std::uint64_t kTicksPerSecond = 10'000'000, kSecondsPerDay = 86'400;
  for (const double value : landmark.mean) {
    AppendFixed(out, value);
    out.push_back(' ');
  }
  const FeatureType type = landmark.features.empty() ? FeatureType::kNotDefined : landmark.features[0].type;
  AppendPadded(out, std::to_string(static_cast<std::int32_t>(type)), 4);
  out.push_back(' ');
  AppendPadded(out, std::to_string(landmark.seen_count), 4);
  out.push_back(' ');
  AppendFixed(out, static_cast<double>(landmark.last_seen / kTicksPerSecond % kSecondsPerDay));
  if (type == FeatureType::kSift)
    if (const FeatureDescriptor* sift = landmark.features[0].FindDescriptor(DescriptorKind::kSift))
      for (const std::uint8_t byte : sift->bytes) out.append(" ").append(std::to_string(byte)).append(" ");
  const auto id = static_cast<std::int32_t>(landmark.id.value());  // MRPT cuts it to an int
  out.append(" ").append(std::to_string(id)).append(" \n");
}

}  // namespace slamdb::mrpt
