// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iterator>
#include <string_view>

#include "slamdb/model/camera.h"
#include "slamdb/model/features.h"
#include "slamdb/model/landmark.h"

namespace slamdb::detail {

// The enumerators of the model as JSON spells them.
constexpr std::string_view NameOf(MatrixForm form) {
  switch (form) {
    case MatrixForm::kUsual:
      return "usual";
    case MatrixForm::kUsualNotContinuous:
      return "usual_not_continuous";
    case MatrixForm::kEmpty:
      return "empty";
    case MatrixForm::kEmptyContinuous:
      return "empty_continuous";
  }
  return "unknown";
}

constexpr std::string_view NameOf(CameraModel model) {
  switch (model) {
    case CameraModel::kPinhole:
      return "pinhole";
    case CameraModel::kKannalaBrandt8:
      return "kannala_brandt_8";
    case CameraModel::kEquirectangular:
      return "equirectangular";
  }
  return "unknown";
}

constexpr std::string_view NameOf(DescriptorKind kind) {
  constexpr std::string_view kNames[] = {"sift", "surf", "spin_image", "polar_image", "log_polar_image",
                                         "orb",  "bld",  "latch"};
  const auto number = static_cast<std::size_t>(kind);
  return number < std::size(kNames) ? kNames[number] : "unknown";
}

// Empty for numbers that MRPT has no name for.
constexpr std::string_view NameOf(FeatureType type) {
  switch (type) {
    case FeatureType::kNotDefined:
      return "not_defined";
    case FeatureType::kKlt:
      return "klt";
    case FeatureType::kHarris:
      return "harris";
    case FeatureType::kSift:
      return "sift";
    case FeatureType::kSurf:
      return "surf";
    case FeatureType::kBeacon:
      return "beacon";
    case FeatureType::kFast:
      return "fast";
    case FeatureType::kOrb:
      return "orb";
    case FeatureType::kAkaze:
      return "akaze";
    case FeatureType::kLsd:
      return "lsd";
  }
  return {};
}

}  // namespace slamdb::detail
