// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/detail/lens_numbers.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>

#include "slamdb/base/detail/concat.h"
#include "slamdb/model/detail/matrix_types.h"

namespace slamdb::detail {

std::optional<std::vector<double>> RecordedDistortion(const KeyFrame& keyframe) {
  const Matrix& matrix = keyframe.distortion;
  std::vector<double> distortion;
  if (matrix.type != kCv32F && !matrix.data.empty()) return std::nullopt;
  for (std::size_t at = 0; at + sizeof(float) <= matrix.data.size() && distortion.size() < 5; at += sizeof(float)) {
    float value = 0;
    std::memcpy(&value, &matrix.data[at], sizeof(float));
    if (!std::isfinite(value)) return std::nullopt;
    distortion.push_back(static_cast<double>(value));
  }
  while (!distortion.empty() && distortion.back() == 0) distortion.pop_back();
  return distortion;
}

std::vector<double> DistortionCoefficients(const KeyFrame& keyframe) {
  return RecordedDistortion(keyframe).value_or(std::vector<double>());
}

std::vector<double> LensNumbers(const KeyFrame& keyframe, const Camera* camera) {
  const Intrinsics& intrinsics = keyframe.intrinsics;
  if (!(intrinsics.fx > 0)) return {};
  std::vector<double> lens;
  for (const float number : {intrinsics.fx, intrinsics.fy, intrinsics.cx, intrinsics.cy})
    lens.push_back(static_cast<double>(number));
  constexpr std::size_t kPinhole = 4;
  if (camera != nullptr && camera->parameters.size() > kPinhole) {
    for (std::size_t i = kPinhole; i < camera->parameters.size(); ++i)
      lens.push_back(static_cast<double>(camera->parameters[i]));
  } else {
    const std::vector<double> distortion = DistortionCoefficients(keyframe);
    std::ranges::copy(distortion, std::back_inserter(lens));
  }
  return lens;
}

bool AreLensesAlike(const std::vector<double>& one, const std::vector<double>& other) {
  constexpr double kRounding = 2e-6;
  for (std::size_t i = 0; i < std::max(one.size(), other.size()); ++i) {
    const double a = i < one.size() ? one[i] : 0, b = i < other.size() ? other[i] : 0;
    if (!(std::abs(a - b) <= kRounding * std::max(1.0, std::abs(b)))) return false;
  }
  return true;
}

std::string LensText(const std::vector<double>& lens) {
  std::string text;
  for (const double number : lens) text += Concat(text.empty() ? "" : " ", Digits(number, 6));
  return text;
}

}  // namespace slamdb::detail
