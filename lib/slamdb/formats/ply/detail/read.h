// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/format.h"

namespace slamdb::detail {

// The vertices of any PLY as points: ascii and binary of both byte orders, with properties and elements of any name.
//
// Throws Error (kDamaged) with the line of the header or the number of the vertex.
Atlas ReadPly(const Source& source, const ReadOptions& options, Notices& notices);

}  // namespace slamdb::detail
