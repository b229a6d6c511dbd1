// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "bench/measure.h"

namespace slamdb::bench {

// What slamdb is held against.
std::span<const Measurement> References();

}  // namespace slamdb::bench
