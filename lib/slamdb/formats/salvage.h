// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/export.h"
#include "slamdb/formats/format.h"
#include "slamdb/model/salvage.h"

namespace slamdb {

// Reads what can be read, with the format of the options, or else of the input.
// Of ORB-SLAM3 files, stores and MRPT landmarks.
//
// Throws Error when nothing can be read: kUnsupported for another format, kOutOfResources when memory does not suffice.
// Thread-safe.
[[nodiscard]] SLAMDB_EXPORT Salvage SalvageAtlas(const Location& location, const ReadOptions& options = {});

// The same of bytes in memory, which are not copied.
[[nodiscard]] SLAMDB_EXPORT Salvage SalvageBytes(Bytes bytes, const ReadOptions& options = {});

}  // namespace slamdb
