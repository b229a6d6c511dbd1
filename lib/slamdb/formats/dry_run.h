// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "slamdb/formats/format.h"

namespace slamdb {

// Options for writing in any format: with `bytes` all is done as it would be, notices and losses too, but nothing is
// written. Stores and custom formats are not asked: of them only WriteAtlas' own losses come.
struct DryRunOptions {
  std::uint64_t* bytes = nullptr;  // what the file would take; of several files the one that is named, of a folder all
};

}  // namespace slamdb
