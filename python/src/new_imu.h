// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <optional>

#include "slamdb/build/imu.h"

namespace slamdb::python {

// What is given of the IMU of new keyframes: slamdb.ImuArrays, or a mapping of the same names; of None nothing.
// Throws Error (kUsage) that begins with `imu.` and the name.
std::optional<NewImu> GivenImu(pybind11::handle object);

}  // namespace slamdb::python
