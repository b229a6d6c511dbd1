// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/format.h"

namespace slamdb::detail {

// The folder in which VINS-Mono and VINS-Fusion keep their pose graph. See schema/vins.md.
extern const Format kVinsFormat;

}  // namespace slamdb::detail
