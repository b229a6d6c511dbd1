// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "slamdb/base/column.h"
#include "slamdb/model/flag.h"

namespace slamdb {

// A small matrix of any OpenCV type as a file holds it. cv::Mat.
struct Matrix {
  std::int32_t rows = 0, columns = 0;
  std::int32_t type = 0;  // OpenCV's type code: 5 = one channel of 32-bit floats
  Flag continuous;
  Column<std::byte> data;  // row after row
  friend bool operator==(const Matrix&, const Matrix&) = default;
};

}  // namespace slamdb
