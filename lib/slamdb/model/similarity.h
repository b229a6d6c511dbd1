// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "slamdb/model/rigid.h"

namespace slamdb {

// A similarity transform (Sim3) named `target_from_source`:
//   x_in_target = scale * (rotation * x_in_source) + translation
// The rotation is a unit quaternion and the scale positive.
// Double precision: it moves whole maps, whose entities are float.
struct Similarity3d {
  double scale = 1;
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Similarity3d Inverse() const {
    const Eigen::Quaterniond inverse = rotation.conjugate();
    return {1 / scale, inverse, -(inverse * translation) / scale};
  }

  // a_from_c = a_from_b * b_from_c
  friend Similarity3d operator*(const Similarity3d& a_from_b, const Similarity3d& b_from_c) {
    return {a_from_b.scale * b_from_c.scale, a_from_b.rotation * b_from_c.rotation,
            a_from_b.scale * (a_from_b.rotation * b_from_c.translation) + a_from_b.translation};
  }
  friend Eigen::Vector3d operator*(const Similarity3d& a_from_b, const Eigen::Vector3d& x_in_b) {
    return a_from_b.scale * (a_from_b.rotation * x_in_b) + a_from_b.translation;
  }
};

}  // namespace slamdb
