// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/import/detail/keypoints.h"

#include <cmath>

namespace slamdb::detail {

float PatchAt(std::int32_t octave, const ScalePyramid& pyramid) {
  const bool is_level = octave >= 0 && static_cast<std::size_t>(octave) < pyramid.factors.size();
  return std::floor(kPatch * (is_level ? pyramid.factors[static_cast<std::size_t>(octave)] : 1));
}

}  // namespace slamdb::detail
