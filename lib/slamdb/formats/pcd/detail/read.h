// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/format.h"

namespace slamdb::detail {

// The points of a PCD of version 0.6 or 0.7: ascii, binary and binary_compressed, with fields of any name.
//
// Throws Error (kDamaged) with the line of the header, or the number of the point.
Atlas ReadPcd(const Source& source, const ReadOptions& options, Notices& notices);

}  // namespace slamdb::detail
