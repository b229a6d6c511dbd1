// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

// The tables of COLMAP's databases, as far as slamdb fills them: schema/colmap.md.
namespace slamdb::colmap {

extern const std::string_view kCommonTables, kOldTables, kNewTables;

}  // namespace slamdb::colmap
