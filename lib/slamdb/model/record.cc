// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/detail/record.h"

#include <algorithm>

#include "slamdb/model/detail/record_codec.h"

namespace slamdb::detail {
namespace {

constexpr std::uint8_t kDetailsLayout = 1, kLandmarkLayout = 1, kCarriedLayout = 1;

void CheckLayout(std::uint8_t layout, std::uint8_t expected, std::string_view of) {
  if (layout == expected) return;
  throw Error(ErrorKind::kDamaged, Concat(of, " of layout ", layout, ", expected ", expected));
}

// All but the preintegration.
template <class Codec, class Frame>
void WalkDetails(Codec& codec, Frame& frame) {
  const auto each = EachTo(codec, frame);
  codec.Field(frame.camera_from_parent);
  codec.Field(frame.merge_scale);
  fields::ForEachCameraField([&](std::string_view name, auto... members) {
    constexpr bool kIsId = std::is_same_v<std::remove_cvref_t<decltype(Member(frame, members...))>, CameraId>;
    if constexpr (!kIsId) each(name, members...);
  });
  codec.Field(frame.body_position);
  fields::ForEachImuCalibrationField(each);
}

// The preintegration without its measurements: numbers only, 2188 bytes.
template <class Codec, class Frame>
void WalkPreintegration(Codec& codec, Frame& frame) {
  const auto each = EachTo(codec, frame);
  fields::ForEachPreintegrationField([&](std::string_view name, auto... members) {
    constexpr bool kIsList =
        std::is_same_v<std::remove_cvref_t<decltype(Member(frame, members...))>, Column<ImuMeasurement>>;
    if constexpr (!kIsList) each(name, members...);
  });
}

}  // namespace

void EncodeDetails(const KeyFrame& keyframe, ByteWriter& out) {
  out.Put(kDetailsLayout);
  RecordWriter writer(out);
  WalkDetails(writer, keyframe);

  // Without IMU it is often nothing but zeros.
  ByteWriter numbers;
  RecordWriter number_writer(numbers);
  WalkPreintegration(number_writer, keyframe);
  const Bytes bytes = numbers.bytes();
  const bool zero = std::all_of(bytes.begin(), bytes.end(), [](std::byte byte) { return byte == std::byte{0}; });
  out.Put(static_cast<std::uint8_t>(zero ? 0 : 1));
  if (!zero) out.PutBytes(bytes);
  out.PutVector(keyframe.preintegration.measurements);
}

void DecodeDetails(Bytes blob, KeyFrame& keyframe) {
  ByteReader in(blob);
  CheckLayout(in.Get<std::uint8_t>(), kDetailsLayout, "details");
  RecordReader reader(in);
  WalkDetails(reader, keyframe);
  if (in.Get<std::uint8_t>() != 0) WalkPreintegration(reader, keyframe);
  in.GetVector(keyframe.preintegration.measurements);
  in.ExpectEnd();
}

void EncodeLandmarkFeatures(const std::vector<LandmarkFeature>& features, ByteWriter& out) {
  out.Put(kLandmarkLayout);
  out.Put(static_cast<std::uint32_t>(features.size()));
  RecordWriter writer(out);
  for (const LandmarkFeature& feature : features) ForEachField(&feature, EachTo(writer, feature));
}

std::vector<LandmarkFeature> DecodeLandmarkFeatures(Bytes blob) {
  ByteReader in(blob);
  CheckLayout(in.Get<std::uint8_t>(), kLandmarkLayout, "features of a landmark");
  RecordReader reader(in);
  std::vector<LandmarkFeature> features;
  for (auto count = in.Get<std::uint32_t>(); count > 0; --count) {
    LandmarkFeature& feature = features.emplace_back();
    ForEachField(&feature, EachTo(reader, feature));
  }
  in.ExpectEnd();
  return features;
}

void EncodeCarried(const Boxed<Carried>& carried, ByteWriter& out) {
  if (!carried) return;
  out.Put(kCarriedLayout);
  out.PutVector(carried->members);
  const Matrix& descriptors = carried->descriptors;
  for (const std::int32_t number : {descriptors.rows, descriptors.columns, descriptors.type}) out.Put(number);
  out.Put(descriptors.continuous);
  out.PutVector(descriptors.data);
}

Boxed<Carried> DecodeCarried(Bytes blob) {
  Boxed<Carried> carried;
  if (blob.empty()) return carried;
  ByteReader in(blob);
  CheckLayout(in.Get<std::uint8_t>(), kCarriedLayout, "carried members");
  in.GetVector(carried.Make().members);
  Matrix& descriptors = carried.Make().descriptors;
  for (std::int32_t* number : {&descriptors.rows, &descriptors.columns, &descriptors.type})
    *number = in.Get<std::int32_t>();
  descriptors.continuous = in.Get<Flag>();
  in.GetVector(descriptors.data);
  in.ExpectEnd();
  return carried;
}

KeyframeReals RealsOf(const KeyFrame& keyframe) {
  const Quaternionf& q = keyframe.camera_from_world.rotation;
  const Eigen::Vector3f& t = keyframe.camera_from_world.translation;
  const Eigen::Vector3f& v = keyframe.velocity;
  const Eigen::Vector3f& a = keyframe.imu_bias.accelerometer;
  const Eigen::Vector3f& w = keyframe.imu_bias.gyroscope;
  return {q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z(), v.x(),
          v.y(), v.z(), a.x(), a.y(), a.z(), w.x(), w.y(), w.z()};
}

void SetReals(KeyFrame& keyframe, const KeyframeReals& reals) {
  keyframe.camera_from_world.rotation.coeffs() << reals[1], reals[2], reals[3], reals[0];
  const auto vector = [&](std::size_t first) {
    return Eigen::Vector3f(reals[first], reals[first + 1], reals[first + 2]);
  };
  keyframe.camera_from_world.translation = vector(4);
  keyframe.velocity = vector(7);
  keyframe.imu_bias.accelerometer = vector(10);
  keyframe.imu_bias.gyroscope = vector(13);
}

}  // namespace slamdb::detail
