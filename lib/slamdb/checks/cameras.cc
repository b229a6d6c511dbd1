// SPDX-License-Identifier: BSD-3-Clause
// Cameras, and what keyframes keep of them.
#include <algorithm>
#include <array>
#include <cmath>

#include "slamdb/checks/detail/catalogue.h"
#include "slamdb/checks/detail/visit.h"

namespace slamdb::detail {
namespace {

bool Near(float a, float b) { return std::abs(a - b) <= 1e-3F * std::max(1.0F, std::abs(b)); }

std::size_t ParameterCount(CameraModel model) {
  constexpr std::array<std::size_t, 3> kCounts = {4, 8, 2};
  return kCounts.at(static_cast<std::size_t>(model));
}
std::string_view ClassOf(CameraModel model) {
  constexpr std::array<std::string_view, 3> kClasses = {"Pinhole (0)", "KannalaBrandt8 (1)", "Equirectangular (2)"};
  return kClasses.at(static_cast<std::size_t>(model));
}

bool IsSound(const Camera& camera) {
  const std::vector<float>& p = camera.parameters;
  return camera.model != CameraModel::kEquirectangular && p.size() == ParameterCount(camera.model) && p[0] > 0 &&
         p[1] > 0 && std::ranges::all_of(p, [](float value) { return std::isfinite(value); });
}

bool IsPositive(const Intrinsics& k) {
  return std::isfinite(k.fx) && std::isfinite(k.fy) && std::isfinite(k.cx) && std::isfinite(k.cy) && k.fx > 0 &&
         k.fy > 0;
}

// Whether the camera, which has all parameters, has these fx, fy, cx, cy.
bool HasIntrinsics(const Camera& camera, const Intrinsics& k) {
  const std::vector<float>& p = camera.parameters;
  return Near(p[0], k.fx) && Near(p[1], k.fy) && Near(p[2], k.cx) && Near(p[3], k.cy);
}

void TakeIntrinsics(const Camera& camera, Intrinsics& k) {
  k.fx = camera.parameters[0];
  k.fy = camera.parameters[1];
  k.cx = camera.parameters[2];
  k.cy = camera.parameters[3];
}

Eigen::Matrix3f MatrixOf(const Intrinsics& k) {
  Eigen::Matrix3f matrix = Eigen::Matrix3f::Identity();
  matrix(0, 0) = k.fx;
  matrix(1, 1) = k.fy;
  matrix(0, 2) = k.cx;
  matrix(1, 2) = k.cy;
  return matrix;
}

bool IsDerived(const KeyFrame& keyframe) {
  const Intrinsics& k = keyframe.intrinsics;
  const Eigen::Matrix3f matrix = MatrixOf(k);
  return Near(k.inverse_fx * k.fx, 1) && Near(k.inverse_fy * k.fy, 1) && Near(k.baseline * k.fx, k.baseline_fx) &&
         Near(2 * keyframe.half_baseline, k.baseline) &&
         std::equal(matrix.data(), matrix.data() + matrix.size(), keyframe.calibration_matrix.data(), Near);
}

void DeriveFromIntrinsics(KeyFrame& keyframe) {
  Intrinsics& k = keyframe.intrinsics;
  k.inverse_fx = 1 / k.fx;
  k.inverse_fy = 1 / k.fy;
  k.baseline = k.baseline_fx / k.fx;
  keyframe.half_baseline = k.baseline / 2;
  keyframe.calibration_matrix = MatrixOf(k);
}

// The only camera of the atlas with the keyframe's intrinsics; none when there is no such, or several.
CameraId CameraLike(const Atlas& atlas, const KeyFrame& keyframe) {
  CameraId found;
  for (const Camera& camera : atlas.cameras) {
    if (!IsSound(camera) || !HasIntrinsics(camera, keyframe.intrinsics)) continue;
    if (found) return {};
    found = camera.id;
  }
  return found;
}

// The only right camera that keyframes of this left camera have; none when there is no such, or several.
CameraId RightCameraBeside(const AtlasIndex& index, CameraId left) {
  CameraId found;
  for (const Map& map : index.atlas().maps)
    for (const KeyFrame& keyframe : map.keyframes) {
      if (keyframe.camera != left || keyframe.right_camera == found) continue;
      if (!keyframe.features.is_fisheye_stereo() || index.CameraRow(keyframe.right_camera) == kNoRow) continue;
      if (found) return {};
      found = keyframe.right_camera;
    }
  return found;
}

// Sets `camera` to `chosen` unless that is none too, and counts it.
void Choose(CameraId chosen, CameraId& camera, std::size_t& changed) {
  if (camera == chosen) return;
  camera = chosen;
  ++changed;
}

}  // namespace

void CheckCameraTarget(const Subject& subject, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t, const Map& map, const KeyFrame& keyframe) {
    if (subject.index.CameraRow(keyframe.camera) == kNoRow)
      findings.Add(PlaceOf(map, keyframe), keyframe.camera, " is not in the atlas");
    if (keyframe.right_camera && subject.index.CameraRow(keyframe.right_camera) == kNoRow)
      findings.Add(PlaceOf(map, keyframe), "right ", keyframe.right_camera, " is not in the atlas");
  });
}

void CheckRightCamera(const Subject& subject, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t, const Map& map, const KeyFrame& keyframe) {
    const bool fisheye_stereo = keyframe.features.is_fisheye_stereo();
    if (fisheye_stereo && !keyframe.right_camera)
      findings.Add(PlaceOf(map, keyframe), "is fisheye stereo (NLeft = ", keyframe.features.left_count,
                   ") without a right camera");
    if (!fisheye_stereo && keyframe.right_camera)
      findings.Add(PlaceOf(map, keyframe), "has right ", keyframe.right_camera,
                   " but no right features (NLeft = ", keyframe.features.left_count, ")");
  });
}

// Only where the keyframes leave no doubt which camera is meant.
std::size_t SetMissingCameras(Atlas& atlas) {
  const AtlasIndex index(atlas);
  std::size_t changed = 0;
  for (Map& map : atlas.maps)
    for (KeyFrame& keyframe : map.keyframes) {
      if (index.CameraRow(keyframe.camera) == kNoRow)
        if (const CameraId like = CameraLike(atlas, keyframe)) Choose(like, keyframe.camera, changed);
      if (!keyframe.right_camera || index.CameraRow(keyframe.right_camera) != kNoRow) continue;
      if (!keyframe.features.is_fisheye_stereo())
        Choose(CameraId(), keyframe.right_camera, changed);
      else if (const CameraId beside = RightCameraBeside(index, keyframe.camera))
        Choose(beside, keyframe.right_camera, changed);
    }
  return changed;
}

std::size_t SetRightCameras(Atlas& atlas) {
  const AtlasIndex index(atlas);
  std::size_t changed = 0;
  for (Map& map : atlas.maps)
    for (KeyFrame& keyframe : map.keyframes) {
      const bool fisheye_stereo = keyframe.features.is_fisheye_stereo();
      if (keyframe.bad || fisheye_stereo == keyframe.right_camera.has_value()) continue;
      Choose(fisheye_stereo ? RightCameraBeside(index, keyframe.camera) : CameraId(), keyframe.right_camera, changed);
    }
  return changed;
}

void CheckCameraParameters(const Subject& subject, Findings& findings) {
  for (const Camera& camera : subject.atlas.cameras) {
    const Place place{.camera = camera.id};
    const std::size_t expected = ParameterCount(camera.model);
    if (camera.parameters.size() != expected)
      findings.Add(place, "has ", camera.parameters.size(), " parameters instead of ", expected);
    else if (!std::ranges::all_of(camera.parameters, [](float value) { return std::isfinite(value); }))
      findings.Add(place, "its parameters hold NaN or infinity");
    else if (!(camera.parameters[0] > 0 && camera.parameters[1] > 0))
      findings.Add(place, "its focal lengths are not both above 0: ", camera.parameters[0], " and ",
                   camera.parameters[1]);
  }
}

void CheckCameraType(const Subject& subject, Findings& findings) {
  for (const Camera& camera : subject.atlas.cameras)
    if (camera.recorded_type != static_cast<std::uint32_t>(camera.model))
      findings.Add(Place{.camera = camera.id}, "has type ", camera.recorded_type, ", but is stored as ",
                   ClassOf(camera.model));
}

std::size_t SetCameraTypes(Atlas& atlas) {
  std::size_t changed = 0;
  for (Camera& camera : atlas.cameras) {
    if (camera.recorded_type == static_cast<std::uint32_t>(camera.model)) continue;
    camera.recorded_type = static_cast<std::uint32_t>(camera.model);
    ++changed;
  }
  return changed;
}

void CheckIntrinsicsPositive(const Subject& subject, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t, const Map& map, const KeyFrame& keyframe) {
    const Intrinsics& k = keyframe.intrinsics;
    if (!IsPositive(k))
      findings.Add(PlaceOf(map, keyframe), "its intrinsics cannot be used: fx, fy, cx, cy are ", k.fx, ", ", k.fy, ", ",
                   k.cx, ", ", k.cy);
  });
}

void CheckIntrinsicsAgree(const Subject& subject, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t, const Map& map, const KeyFrame& keyframe) {
    const Intrinsics& k = keyframe.intrinsics;
    if (!(k.fx > 0 && k.fy > 0)) return;  // the business of intrinsics-positive
    const auto expect = [&](bool agrees, const char* what) {
      if (!agrees) findings.Add(PlaceOf(map, keyframe), what);
    };
    const Eigen::Matrix3f& matrix = keyframe.calibration_matrix;
    expect(Near(k.inverse_fx * k.fx, 1) && Near(k.inverse_fy * k.fy, 1), "invfx and invfy are not 1/fx and 1/fy");
    expect(Near(matrix(0, 0), k.fx) && Near(matrix(1, 1), k.fy) && Near(matrix(0, 2), k.cx) && Near(matrix(1, 2), k.cy),
           "the calibration matrix does not hold fx, fy, cx, cy");
    expect(Near(k.baseline * k.fx, k.baseline_fx), "the baseline mb is not mbf / fx");
    expect(Near(2 * keyframe.half_baseline, k.baseline), "the half baseline is not half the baseline");
    const Camera* camera = subject.index.FindCamera(keyframe.camera);
    if (camera == nullptr || camera->parameters.size() != ParameterCount(camera->model)) return;
    expect(HasIntrinsics(*camera, k), "fx, fy, cx, cy are not its camera's");
  });
}

// What follows from fx, fy, cx, cy and mbf, as ORB-SLAM3 computes it. Those themselves come from the camera where they
// cannot be right. False, and nothing changed, where all is well or nothing usable follows, as 1/fx of a tiny fx.
bool RebuildIntrinsicsOf(KeyFrame& keyframe, const Camera* camera) {
  const Intrinsics before = keyframe.intrinsics;
  const Eigen::Matrix3f matrix = keyframe.calibration_matrix;
  const float half_baseline = keyframe.half_baseline;
  if (!IsPositive(before) && camera != nullptr && IsSound(*camera)) TakeIntrinsics(*camera, keyframe.intrinsics);
  if (!IsPositive(keyframe.intrinsics) || !std::isfinite(before.baseline_fx)) return false;
  if (before == keyframe.intrinsics && IsDerived(keyframe)) return false;
  DeriveFromIntrinsics(keyframe);
  if (IsDerived(keyframe)) return true;
  keyframe.intrinsics = before;
  keyframe.calibration_matrix = matrix;
  keyframe.half_baseline = half_baseline;
  return false;
}

std::size_t RebuildIntrinsics(Atlas& atlas) {
  const AtlasIndex index(atlas);
  std::size_t changed = 0;
  for (Map& map : atlas.maps)
    for (KeyFrame& keyframe : map.keyframes)
      if (!keyframe.bad && RebuildIntrinsicsOf(keyframe, index.FindCamera(keyframe.camera))) ++changed;
  return changed;
}

}  // namespace slamdb::detail
