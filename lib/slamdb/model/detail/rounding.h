// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/notices.h"
#include "slamdb/model/detail/camera_in_world.h"

namespace slamdb::detail {

// By how much coordinates are off that became the 32-bit floats of an atlas.
class Rounding {
 public:
  static constexpr double kMost = 1e-3;  // a millimetre: more of it is a loss

  void Add(double off) {
    if (off > 0) ++count_, most_ = std::max(most_, off);
  }
  // Of a place that the pose was made of; no more than the millimetre is what every number is off.
  void AddPose(const Rigid3f& camera_from_world, const Eigen::Vector3d& center) {
    AddLoss((ExactCenter(camera_from_world) - center).cwiseAbs().maxCoeff());
  }
  void AddLoss(double off) {
    if (off > kMost) Add(off);
  }
  void Tell(Notices& notices) const {
    if (count_ == 0) return;
    const std::string text =
        Concat("coordinates are rounded to the 32-bit floats of an atlas: ", Thousands(count_), ", by up to ", most_);
    if (most_ > kMost)
      notices.Lose(text + "; take an origin near them off first");
    else
      notices.Warn(text);
  }

 private:
  std::uint64_t count_ = 0;
  double most_ = 0;
};

}  // namespace slamdb::detail
