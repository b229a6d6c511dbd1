// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cmath>
#include <cstring>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/import/detail/possible.h"
#include "slamdb/formats/rtabmap/detail/blobs.h"

namespace slamdb::rtabmap {
namespace {

using detail::Concat;

// A blob, taken from front to back.
class Cursor {
 public:
  Cursor(Bytes blob, const Place& place) : blob_(blob), place_(place) {}

  bool AtEnd() const { return at_ == blob_.size(); }
  std::size_t left() const { return blob_.size() - at_; }

  template <class Value>
  std::vector<Value> Take(std::int64_t count) {
    if (count < 0 || static_cast<std::uint64_t>(count) > left() / sizeof(Value))
      place_.Fail(Concat("a calibration claims ", count, " numbers, which it cannot hold"));
    std::vector<Value> values(static_cast<std::size_t>(count));
    if (count > 0) std::memcpy(values.data(), blob_.data() + at_, values.size() * sizeof(Value));
    at_ += values.size() * sizeof(Value);
    return values;
  }
  std::int32_t Peek(std::size_t index) const {
    std::int32_t value = 0;
    if (left() < (index + 1) * sizeof value) place_.Fail("a calibration is cut");
    std::memcpy(&value, blob_.data() + at_ + index * sizeof value, sizeof value);
    return value;
  }

 private:
  Bytes blob_;
  const Place& place_;
  std::size_t at_ = 0;
};

// x forward, y left, z up, as robots are; and z forward, x right, y down, as cameras are.
Pose UsualCamera() {
  Pose base_from_camera = Pose::Identity();
  base_from_camera.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return base_from_camera;
}

NodeCamera WithIntrinsics(double fx, double fy, double cx, double cy) {
  NodeCamera camera;
  camera.fx = static_cast<float>(fx), camera.fy = static_cast<float>(fy);
  camera.cx = static_cast<float>(cx), camera.cy = static_cast<float>(cy);
  return camera;
}

struct Mono {
  NodeCamera camera;
  double shift = 0;  // of the projection matrix: focal length times how far right the camera is, negative
};

// Since 0.18: sizes, then K, D, R, P as doubles, and the place of the camera as floats.
Mono TakeMono(Cursor& cursor, const Place& place) {
  const std::vector<std::int32_t> header = cursor.Take<std::int32_t>(11);
  if (header[3] != 0) place.Fail(Concat("a camera is of type ", header[3], ", expected 0"));
  const std::vector<double> k = cursor.Take<double>(header[6]);
  cursor.Take<double>(header[7]);
  cursor.Take<double>(header[8]);
  const std::vector<double> p = cursor.Take<double>(header[9]);
  const std::vector<float> local = cursor.Take<float>(header[10]);
  Mono mono;
  if (p.size() == 12) {
    mono.camera = WithIntrinsics(p[0], p[5], p[2], p[6]);
    mono.shift = p[3];
  } else if (k.size() == 9) {
    mono.camera = WithIntrinsics(k[0], k[4], k[2], k[5]);
  }
  mono.camera.width = header[4];
  mono.camera.height = header[5];
  mono.camera.base_from_camera = UsualCamera();
  if (local.size() == 12) mono.camera.base_from_camera = PoseOf(local.data(), place).value_or(UsualCamera());
  return mono;
}

NodeCamera TakeStereo(Cursor& cursor, const Place& place) {
  const std::vector<std::int32_t> header = cursor.Take<std::int32_t>(10);
  cursor.Take<double>(header[4]);
  const std::vector<double> translation = cursor.Take<double>(header[5]);
  cursor.Take<double>(header[6]);
  cursor.Take<double>(header[7]);
  Mono left, right;
  if (header[8] > 0) left = TakeMono(cursor, place);
  if (header[9] > 0) right = TakeMono(cursor, place);
  if (right.shift != 0 && right.camera.fx > 0)
    left.camera.baseline = static_cast<float>(-right.shift) / right.camera.fx;
  else if (translation.size() == 3)
    left.camera.baseline = static_cast<float>(std::abs(translation[0]));
  return left.camera;
}

// Of what is no size of an image, -1.
std::int32_t WholePixels(float pixels) {
  constexpr float kMost = 1 << 30;
  return pixels >= 0 && pixels < kMost ? static_cast<std::int32_t>(pixels) : -1;
}

// Sizes of 0 are not recorded, cameras of zeros not calibrated.
std::string WhyNoCamera(const NodeCamera& camera) {
  const std::array<double, 3> others = {camera.cx, camera.cy, camera.baseline};
  const bool has_size = camera.width != 0 || camera.height != 0;
  std::string why = has_size ? detail::WhyNoImageSize(camera.width, camera.height) : std::string();
  return why.empty() ? detail::WhyNoCameraOrNone(camera.fx, camera.fy, others) : why;
}

// Before 0.18, floats alone: focal lengths, principal point, the baseline of a stereo camera, since 0.11.2 the size of
// the picture, and where the camera is.
std::vector<NodeCamera> OldCalibration(Cursor& cursor, bool has_size, const Place& place) {
  const std::size_t mono = has_size ? 18 : 16, stereo = mono + 1, floats = cursor.left() / sizeof(float);
  const bool is_stereo = floats == stereo;
  if (cursor.left() % sizeof(float) != 0 || (!is_stereo && floats % mono != 0))
    place.Fail(Concat("a calibration has ", cursor.left(), " bytes, which this version of RTAB-Map did not write"));
  std::vector<NodeCamera> cameras;
  while (!cursor.AtEnd()) {
    const std::vector<float> numbers = cursor.Take<float>(static_cast<std::int64_t>(is_stereo ? stereo : mono));
    NodeCamera& camera = cameras.emplace_back();
    camera.fx = numbers[0], camera.fy = numbers[1], camera.cx = numbers[2], camera.cy = numbers[3];
    if (is_stereo) camera.baseline = numbers[4];
    const float* behind = numbers.data() + (is_stereo ? 5 : 4);
    if (has_size) camera.width = WholePixels(behind[0]), camera.height = WholePixels(behind[1]);
    camera.base_from_camera = PoseOf(behind + (has_size ? 2 : 0), place).value_or(UsualCamera());
  }
  return cameras;
}

}  // namespace

std::vector<NodeCamera> CalibrationOf(Bytes blob, const Version& version, const Place& place) {
  constexpr std::size_t kMostCameras = 64;  // each of which becomes a keyframe
  Cursor cursor(blob, place);
  std::vector<NodeCamera> cameras;
  if (version < Version{0, 18, 0}) cameras = OldCalibration(cursor, version >= Version{0, 11, 2}, place);
  while (!cursor.AtEnd())
    cameras.push_back(cursor.Peek(3) == 1 ? TakeStereo(cursor, place) : TakeMono(cursor, place).camera);
  if (cameras.size() > kMostCameras)
    place.Fail(Concat("a calibration has ", cameras.size(), " cameras, expected at most ", kMostCameras));
  for (const NodeCamera& camera : cameras) place.Require(WhyNoCamera(camera));
  return cameras;
}

}  // namespace slamdb::rtabmap
