// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "slamdb/model/similarity.h"

// The logarithm of a similarity in the order of g2o: rotation vector, what the translation is of, log of the scale.
// After Strasdat, Local Accuracy and Global Consistency for Efficient Visual SLAM, 2012.
namespace slamdb::g2o {

using Vector7d = Eigen::Matrix<double, 7, 1>;

Vector7d LogOf(const Similarity3d& similarity);
// The inverse. Finite for finite numbers of sensible size.
Similarity3d ExpOf(const Vector7d& logarithm);

}  // namespace slamdb::g2o
