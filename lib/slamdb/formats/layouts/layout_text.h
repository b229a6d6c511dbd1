// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/export.h"
#include "slamdb/formats/layouts/layout.h"

namespace slamdb {

// The layout as JSON that people edit: in full, one member a line. LoadLayout takes the file.
[[nodiscard]] SLAMDB_EXPORT std::string LayoutText(const Layout& layout);

}  // namespace slamdb
