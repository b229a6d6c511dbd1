// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "slamdb/view/detail/columns.h"

namespace slamdb::view {

// The columns as blocks of markup, `<script type="text/plain" data-name=.. data-part=..>base64 of
// zlib(bytes)</script>`, in their order; those without bytes are left out. Parts are packed side by side.
std::vector<std::string> PackColumns(const Columns& columns, int threads);

}  // namespace slamdb::view
