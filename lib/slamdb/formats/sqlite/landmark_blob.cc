// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/landmark_blob.h"

namespace slamdb::sqlite {
namespace {

constexpr std::uint8_t kLayout = 1;

void EncodeFeature(const LandmarkFeature& feature, ByteWriter& out) {
  out.Put(feature.x);
  out.Put(feature.y);
  out.Put(feature.keypoint_id);
  out.Put(static_cast<std::int32_t>(feature.type));
  out.Put(feature.track_status);
  out.Put(feature.response);
  out.Put(feature.orientation);
  out.Put(feature.octave);
  out.Put(feature.user_flags);
  out.Put(feature.depth);
  out.Put(feature.initial_depth);
  for (const double value : feature.position_in_camera) out.Put(value);
  out.Put(feature.patch_size);
  out.Put(static_cast<std::uint8_t>(feature.has_patch));
  out.PutVector(feature.patch);
  out.Put(feature.spin_image_rows);
  out.Put(static_cast<std::uint8_t>(feature.polar_images_without_rotation));
  out.Put(static_cast<std::uint8_t>(feature.descriptors.size()));
  for (const FeatureDescriptor& descriptor : feature.descriptors) {
    out.Put(static_cast<std::uint8_t>(descriptor.kind));
    out.PutVector(descriptor.bytes);
  }
}

LandmarkFeature DecodeFeature(ByteReader& in) {
  LandmarkFeature feature;
  feature.x = in.Get<float>();
  feature.y = in.Get<float>();
  feature.keypoint_id = in.Get<std::uint64_t>();
  feature.type = static_cast<FeatureType>(in.Get<std::int32_t>());
  feature.track_status = in.Get<std::uint32_t>();
  feature.response = in.Get<float>();
  feature.orientation = in.Get<float>();
  feature.octave = in.Get<std::uint8_t>();
  feature.user_flags = in.Get<std::uint8_t>();
  feature.depth = in.Get<double>();
  feature.initial_depth = in.Get<double>();
  for (double& value : feature.position_in_camera) value = in.Get<double>();
  feature.patch_size = in.Get<std::uint16_t>();
  feature.has_patch = in.Get<std::uint8_t>() != 0;
  in.GetVector(feature.patch);
  feature.spin_image_rows = in.Get<std::uint16_t>();
  feature.polar_images_without_rotation = in.Get<std::uint8_t>() != 0;
  feature.descriptors.resize(in.Get<std::uint8_t>());
  for (FeatureDescriptor& descriptor : feature.descriptors) {
    descriptor.kind = static_cast<DescriptorKind>(in.Get<std::uint8_t>() & 7);
    in.GetVector(descriptor.bytes);
  }
  return feature;
}

}  // namespace

void EncodeLandmarkFeatures(const std::vector<LandmarkFeature>& features, ByteWriter& out) {
  out.Put(kLayout);
  out.Put(static_cast<std::uint32_t>(features.size()));
  for (const LandmarkFeature& feature : features) EncodeFeature(feature, out);
}

std::vector<LandmarkFeature> DecodeLandmarkFeatures(Bytes blob) {
  ByteReader in(blob);
  const auto layout = in.Get<std::uint8_t>();
  if (layout != kLayout) throw Error("features of a landmark of layout " + std::to_string(layout) + ", expected 1");
  std::vector<LandmarkFeature> features;
  for (auto count = in.Get<std::uint32_t>(); count > 0; --count) features.push_back(DecodeFeature(in));
  in.ExpectEnd();
  return features;
}

}  // namespace slamdb::sqlite
