// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "python/src/arrays.h"
#include "slamdb/model/rigid.h"

namespace slamdb::python {

// Of a unit quaternion.
inline Eigen::Matrix<double, 4, 4, Eigen::RowMajor> MatrixByRows(const Rigid3f& transform) {
  Eigen::Matrix<double, 4, 4, Eigen::RowMajor> matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = transform.rotation.toRotationMatrix().cast<double>();
  matrix.topRightCorner<3, 1>() = transform.translation.cast<double>();
  return matrix;
}

inline pybind11::array MatrixOf(const Rigid3f& transform) {
  auto array = NewArray<double>({4, 4});
  std::copy_n(MatrixByRows(transform).data(), 16, array.mutable_data());
  return ReadOnly(std::move(array));
}

}  // namespace slamdb::python
