// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

#include "slamdb/model/camera.h"
#include "slamdb/model/features.h"

namespace slamdb {

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
  }
  return "unknown";
}

}  // namespace slamdb
