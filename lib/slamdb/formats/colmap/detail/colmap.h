// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/format.h"

namespace slamdb::detail {

// Sparse models of COLMAP, folders of binary and of text files, and its database of features. schema/colmap.md.
extern const Format kColmapFormat, kColmapTextFormat, kColmapDatabaseFormat;

}  // namespace slamdb::detail
