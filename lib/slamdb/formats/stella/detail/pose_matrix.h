// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "slamdb/model/rigid.h"

namespace slamdb::stella {

// The 4x4 matrix of a transform: in double, of a rotation of length 1 as it is recorded, so that nothing is rounded.
Eigen::Matrix4d PoseMatrix(const Rigid3f& pose);

// The transform of a matrix: the one in single precision whose matrix it is, where there is one, and otherwise the
// nearest.
//
// Requires: a rotation.
Rigid3f PoseOf(const Eigen::Matrix4d& matrix);

}  // namespace slamdb::stella
