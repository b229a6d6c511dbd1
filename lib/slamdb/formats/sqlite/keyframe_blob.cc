// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/keyframe_blob.h"

#include <algorithm>

namespace slamdb::sqlite {
namespace {

constexpr std::uint8_t kVersion = 1;

// One description of the fields, walked by a writer and by a reader.
struct Encoder {
  ByteWriter& out;

  template <class T>
  void Field(const T& value) {
    out.Put(value);
  }
  void Field(const Flag& flag) { out.Put(flag.recorded); }
  template <class Scalar, int Rows, int Columns>
  void Field(const Eigen::Matrix<Scalar, Rows, Columns>& matrix) {
    out.PutBytes(std::as_bytes(std::span(matrix.data(), static_cast<std::size_t>(Rows * Columns))));
  }
  void Field(const Quaternionf& rotation) { Field(Eigen::Vector4f(rotation.coeffs())); }
  template <class Vector>
  void List(const Vector& values) {
    out.PutVector(values);
  }
};

struct Decoder {
  ByteReader& in;

  template <class T>
  void Field(T& value) {
    value = in.Get<T>();
  }
  void Field(Flag& flag) { flag.recorded = in.Get<std::uint8_t>(); }
  template <class Scalar, int Rows, int Columns>
  void Field(Eigen::Matrix<Scalar, Rows, Columns>& matrix) {
    std::memcpy(matrix.data(), in.TakeArray(Rows * Columns, sizeof(Scalar)), Rows * Columns * sizeof(Scalar));
  }
  void Field(Quaternionf& rotation) {
    Eigen::Vector4f coefficients;
    Field(coefficients);
    rotation.coeffs() = coefficients;
  }
  template <class Vector>
  void List(Vector& values) {
    in.GetVector(values);
  }
};

template <class Codec, class Pose>
void WalkPose(Codec& codec, Pose& pose) {
  codec.Field(pose.rotation);
  codec.Field(pose.translation);
}

template <class Codec, class Bias>
void WalkBias(Codec& codec, Bias& bias) {
  codec.Field(bias.accelerometer);
  codec.Field(bias.gyroscope);
}

template <class Codec, class Frame>
void WalkCamera(Codec& codec, Frame& frame) {
  WalkPose(codec, frame.camera_from_parent);
  codec.Field(frame.merge_scale);
  auto& pinhole = frame.intrinsics;
  for (auto* value : {&pinhole.fx, &pinhole.fy, &pinhole.inverse_fx, &pinhole.inverse_fy, &pinhole.cx, &pinhole.cy,
                      &pinhole.baseline_fx, &pinhole.baseline, &pinhole.depth_threshold}) {
    codec.Field(*value);
  }
  codec.Field(frame.calibration_matrix);
  auto& distortion = frame.distortion;
  for (auto* value : {&distortion.rows, &distortion.columns, &distortion.type}) codec.Field(*value);
  codec.Field(distortion.continuous);
  codec.List(distortion.data);
  codec.Field(frame.half_baseline);
  WalkPose(codec, frame.left_from_right);
  auto& bounds = frame.bounds;
  codec.Field(bounds.grid_columns);
  codec.Field(bounds.grid_rows);
  codec.Field(bounds.inverse_cell_width);
  codec.Field(bounds.inverse_cell_height);
  for (auto* value : {&bounds.min_x, &bounds.min_y, &bounds.max_x, &bounds.max_y}) codec.Field(*value);
  auto& pyramid = frame.pyramid;
  codec.Field(pyramid.levels);
  codec.Field(pyramid.factor);
  codec.Field(pyramid.log_factor);
  for (auto* list : {&pyramid.factors, &pyramid.sigma2, &pyramid.inverse_sigma2}) codec.List(*list);
}

template <class Codec, class Frame>
void WalkInertial(Codec& codec, Frame& frame) {
  codec.Field(frame.body_position);
  auto& calibration = frame.imu_calibration;
  WalkPose(codec, calibration.camera_from_body);
  WalkPose(codec, calibration.body_from_camera);
  codec.Field(calibration.noise);
  codec.Field(calibration.walk_noise);
  codec.Field(calibration.is_set);
}

// All but the measurements: numbers only, 2188 bytes.
template <class Codec, class Preintegration>
void WalkPreintegration(Codec& codec, Preintegration& imu) {
  codec.Field(imu.duration);
  codec.Field(imu.covariance);
  codec.Field(imu.information);
  codec.Field(imu.noise);
  codec.Field(imu.walk_noise);
  WalkBias(codec, imu.bias);
  codec.Field(imu.rotation);
  codec.Field(imu.velocity);
  codec.Field(imu.position);
  codec.Field(imu.rotation_by_gyro);
  codec.Field(imu.velocity_by_gyro);
  codec.Field(imu.velocity_by_acc);
  codec.Field(imu.position_by_gyro);
  codec.Field(imu.position_by_acc);
  codec.Field(imu.mean_acceleration);
  codec.Field(imu.mean_angular_velocity);
  WalkBias(codec, imu.updated_bias);
  codec.Field(imu.bias_change);
}

}  // namespace

void EncodeDetails(const KeyFrame& keyframe, ByteWriter& out) {
  Encoder encoder{out};
  out.Put(kVersion);
  WalkCamera(encoder, keyframe);
  WalkInertial(encoder, keyframe);

  // Without IMU it is often nothing but zeros.
  ByteWriter numbers;
  Encoder number_encoder{numbers};
  WalkPreintegration(number_encoder, keyframe.preintegration);
  const Bytes bytes = numbers.bytes();
  const bool zero = std::all_of(bytes.begin(), bytes.end(), [](std::byte byte) { return byte == std::byte{0}; });
  out.Put(static_cast<std::uint8_t>(zero ? 0 : 1));
  if (!zero) out.PutBytes(bytes);
  out.PutVector(keyframe.preintegration.measurements);
}

void DecodeDetails(Bytes blob, KeyFrame& keyframe) {
  ByteReader in(blob);
  Decoder decoder{in};
  if (const int version = in.Get<std::uint8_t>(); version != kVersion) {
    throw Error("details of layout " + std::to_string(version) + ", expected " + std::to_string(kVersion));
  }
  WalkCamera(decoder, keyframe);
  WalkInertial(decoder, keyframe);
  if (in.Get<std::uint8_t>() != 0) WalkPreintegration(decoder, keyframe.preintegration);
  in.GetVector(keyframe.preintegration.measurements);
  in.ExpectEnd();
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

}  // namespace slamdb::sqlite
