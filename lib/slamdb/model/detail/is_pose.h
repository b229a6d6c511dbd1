// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "slamdb/model/rigid.h"
#include "slamdb/model/similarity.h"

// What is a pose, said once for what reads, checks, uses and writes them.
namespace slamdb::detail {

// Of length 1 as far as files tell, which hold 1e-6 of it.
template <class Derived>
bool IsUnit(const Eigen::QuaternionBase<Derived>& quaternion) {
  constexpr double kTolerance = 1e-3;
  return std::abs(static_cast<double>(quaternion.norm()) - 1) <= kTolerance;
}

// Of length 1 as far as people write it, with a few digits. What is further off is not what its columns say.
template <class Derived>
bool IsNearUnit(const Eigen::QuaternionBase<Derived>& quaternion) {
  constexpr double kFarOff = 0.1;
  return std::abs(static_cast<double>(quaternion.norm()) - 1) <= kFarOff;
}

// Whether making the length 1 gives the rotation that was meant. What is off by more than a factor of two is zeros or
// noise.
template <class Derived>
bool IsRotation(const Eigen::QuaternionBase<Derived>& quaternion) {
  const auto length = static_cast<double>(quaternion.norm());
  return length >= 0.5 && length <= 2;
}

inline bool IsFinite(const Rigid3f& transform) {
  return transform.rotation.coeffs().allFinite() && transform.translation.allFinite();
}

inline bool IsPose(const Rigid3f& transform) {
  return IsRotation(transform.rotation) && transform.translation.allFinite();
}
// One that fits into the single precision of an atlas.
inline bool IsPose(const Similarity3d& transform) {
  return IsRotation(transform.rotation) && transform.translation.cast<float>().allFinite() && transform.scale > 0 &&
         std::isfinite(transform.scale);
}

}  // namespace slamdb::detail
