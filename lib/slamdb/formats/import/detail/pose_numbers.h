// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace slamdb::detail {

// Why numbers of another program's file are no position or pose, as the end of an error; nullptr: they are one. Those
// of an atlas are 32-bit floats.
const char* WhyNoPosition(const Eigen::Vector3d& position);
// `quaternion`: in any order; of any length that is not about 0.
const char* WhyNoPose(const Eigen::Vector4d& quaternion, const Eigen::Vector3d& position);
const char* WhyNoPoseOfMatrix(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& position);

}  // namespace slamdb::detail
