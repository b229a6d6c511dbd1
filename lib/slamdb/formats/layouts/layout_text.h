// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/export.h"
#include "slamdb/formats/layouts/layout.h"

namespace slamdb {

// The layout as JSON that people edit: in full, one member a line. LoadLayout takes the file.
[[nodiscard]] SLAMDB_EXPORT std::string LayoutText(const Layout& layout);

// What ReadOptions and WriteOptions have of a layout that is named by its id or its file: the id of a known one, or
// JSON; empty for none.
//
// Throws Error as LoadLayout does.
[[nodiscard]] SLAMDB_EXPORT std::string LayoutNamed(const std::string& id_or_path);

}  // namespace slamdb
