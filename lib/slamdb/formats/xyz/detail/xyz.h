// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/format.h"

namespace slamdb::detail {

// Points as lines of three numbers, and nothing else. schema/xyz.md
extern const Format kXyzFormat;

}  // namespace slamdb::detail
