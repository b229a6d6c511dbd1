// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/stella/detail/cameras.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <numbers>
#include <span>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/formats/import/detail/possible.h"
#include "slamdb/formats/stella/detail/lens.h"
#include "slamdb/model/detail/matrix_types.h"

namespace slamdb::stella {
namespace {

constexpr std::string_view kScale = " levels, scale ";  // in names of ORB parameters

constexpr std::array<std::string_view, 4> kModels = {"Perspective", "Fisheye", "Equirectangular", "RadialDivision"};
constexpr std::array<std::string_view, 3> kSetups = {"Monocular", "Stereo", "RGBD"};

template <class Value, std::size_t count>
std::optional<Value> Find(const std::array<std::string_view, count>& names, std::string_view name) {
  for (std::size_t i = 0; i < count; ++i)
    if (names[i] == name) return static_cast<Value>(i);
  return std::nullopt;
}

// As many pixels in a radian as the middle of an equirectangular picture has.
LensCamera Pinhole(const LensCamera& lens) {
  if (lens.model != Model::kEquirectangular) return lens;
  LensCamera pinhole = lens;
  pinhole.fx = lens.columns / (2 * std::numbers::pi);
  pinhole.fy = lens.rows / std::numbers::pi;
  pinhole.cx = lens.columns / 2.0;
  pinhole.cy = lens.rows / 2.0;
  return pinhole;
}

// k3 only where there is one.
Matrix MatrixOf(const std::array<double, 5>& distortion) {
  return detail::FloatColumn(std::span(distortion).first(distortion[4] == 0 ? 4 : 5));
}

template <class Value>
std::array<double, 5> NumbersOf(const Matrix& matrix) {
  std::array<double, 5> numbers{};
  for (std::size_t i = 0; i < numbers.size() && (i + 1) * sizeof(Value) <= matrix.data.size(); ++i) {
    Value value;
    std::memcpy(&value, matrix.data.data() + i * sizeof value, sizeof value);
    numbers[i] = static_cast<double>(value);
  }
  return numbers;
}

}  // namespace

std::string_view NameOf(Model model) { return kModels[static_cast<std::size_t>(model)]; }
std::string_view NameOf(Setup setup) { return kSetups[static_cast<std::size_t>(setup)]; }
std::optional<Model> ModelOf(std::string_view name) { return Find<Model>(kModels, name); }
std::optional<Setup> SetupOf(std::string_view name) { return Find<Setup>(kSetups, name); }

OrbParams OrbParams::Of(const ScalePyramid& pyramid) {
  OrbParams params;
  params.levels = pyramid.levels > 0 ? static_cast<std::uint32_t>(pyramid.levels) : 0;
  params.scale_factor = pyramid.factor;
  if (!params.is_sound()) params = {};
  params.name = detail::Concat("ORB of ", params.levels, kScale);
  detail::AppendNumber(params.name, params.scale_factor);
  return params;
}

std::optional<OrbParams> OrbParams::Named(const std::string& name) {
  const std::size_t scale = name.find(kScale);
  if (!name.starts_with("ORB of ") || scale == std::string::npos) return std::nullopt;
  const std::string_view text = name;
  const auto levels = detail::ParseNumber<std::uint32_t>(text.substr(7, scale - 7));
  const auto factor = detail::ParseNumber<float>(text.substr(scale + kScale.size()));
  OrbParams params{.name = name, .scale_factor = factor.value_or(0), .levels = levels.value_or(0)};
  if (!params.is_sound()) return std::nullopt;
  return params;
}

std::string WhyNoCamera(const LensCamera& lens) {
  const auto& k = lens.distortion;
  const std::array<double, 8> others = {lens.cx, lens.cy, k[0], k[1], k[2], k[3], k[4], lens.focal_x_baseline};
  const bool is_known = lens.fx != 0 || lens.fy != 0 || lens.columns > 0 || lens.rows > 0;
  std::string why = is_known ? detail::WhyNoImageSize(lens.columns, lens.rows) : std::string();
  if (!why.empty()) return why;
  const bool has_focal_length = lens.model != Model::kEquirectangular;
  return has_focal_length ? detail::WhyNoCameraOrNone(lens.fx, lens.fy, others) : detail::WhyNoCamera(1, 1, others);
}

Camera CameraOf(const LensCamera& lens, CameraId id) {
  const LensCamera pinhole = Pinhole(lens);
  Camera camera;
  camera.id = id;
  for (const double parameter : {pinhole.fx, pinhole.fy, pinhole.cx, pinhole.cy})
    camera.parameters.push_back(static_cast<float>(parameter));
  if (lens.model == Model::kEquirectangular) {
    camera.model = CameraModel::kEquirectangular;
    camera.recorded_type = static_cast<std::uint32_t>(camera.model);
    camera.parameters = {static_cast<float>(lens.columns), static_cast<float>(lens.rows)};
  }
  if (lens.model != Model::kFisheye) return camera;
  camera.model = CameraModel::kKannalaBrandt8;
  camera.recorded_type = 1;
  for (std::size_t i = 0; i < 4; ++i) camera.parameters.push_back(static_cast<float>(lens.distortion[i]));
  return camera;
}

void SetLens(KeyFrame& keyframe, const LensCamera& lens, std::optional<double> depth_threshold) {
  constexpr double kBaselines = 40;
  const LensCamera pinhole = Pinhole(lens);
  Intrinsics& intrinsics = keyframe.intrinsics;
  intrinsics.fx = static_cast<float>(pinhole.fx);
  intrinsics.fy = static_cast<float>(pinhole.fy);
  intrinsics.cx = static_cast<float>(pinhole.cx);
  intrinsics.cy = static_cast<float>(pinhole.cy);
  intrinsics.baseline_fx = static_cast<float>(lens.focal_x_baseline);
  if (lens.focal_x_baseline > 0 && pinhole.fx > 0) {
    const double baseline = lens.focal_x_baseline / pinhole.fx;
    intrinsics.baseline = static_cast<float>(baseline);
    intrinsics.depth_threshold = static_cast<float>(depth_threshold.value_or(kBaselines * baseline));
    keyframe.half_baseline = intrinsics.baseline / 2;
  }
  keyframe.distortion = MatrixOf(lens.model == Model::kPerspective ? lens.distortion : std::array<double, 5>{});
  if (lens.columns > 0 && lens.rows > 0) keyframe.bounds = BoundsOf(lens);
}

LensCamera LensOf(const KeyFrame& keyframe, const Camera* camera) {
  LensCamera lens;
  lens.focal_x_baseline = static_cast<double>(keyframe.intrinsics.baseline_fx);
  if (camera != nullptr && camera->model == CameraModel::kKannalaBrandt8 && camera->parameters.size() == 8) {
    lens.model = Model::kFisheye;
    const auto parameter = [&](std::size_t i) { return static_cast<double>(camera->parameters[i]); };
    lens.fx = parameter(0), lens.fy = parameter(1), lens.cx = parameter(2), lens.cy = parameter(3);
    for (std::size_t i = 0; i < 4; ++i) lens.distortion[i] = parameter(i + 4);
    return lens;
  }
  if (camera != nullptr && camera->model == CameraModel::kEquirectangular) {
    lens.model = Model::kEquirectangular;
    return lens;
  }
  const Intrinsics& own = keyframe.intrinsics;
  std::array<float, 4> pinhole = {own.fx, own.fy, own.cx, own.cy};
  if (own.fx == 0 && camera != nullptr && camera->parameters.size() == pinhole.size())
    std::ranges::copy(camera->parameters, pinhole.begin());
  lens.fx = static_cast<double>(pinhole[0]), lens.fy = static_cast<double>(pinhole[1]);
  lens.cx = static_cast<double>(pinhole[2]), lens.cy = static_cast<double>(pinhole[3]);
  if (keyframe.distortion.type == detail::kCv32F) lens.distortion = NumbersOf<float>(keyframe.distortion);
  if (keyframe.distortion.type == detail::kCv64F) lens.distortion = NumbersOf<double>(keyframe.distortion);
  return lens;
}

}  // namespace slamdb::stella
