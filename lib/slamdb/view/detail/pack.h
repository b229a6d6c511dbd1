// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "slamdb/view/detail/columns.h"

namespace slamdb::view {

// The columns as blocks of markup, `<script type="text/plain" data-name=.. data-part=..>septets of
// zlib(bytes)</script>`, in their order; those without bytes are left out. Parts are packed side by side.
std::vector<std::string> PackColumns(const Columns& columns, int threads);

// Bytes as text that stands in a script of HTML: 7 bits a letter, low bits first, see schema/view.md.
std::string Septets(std::string_view bytes);

}  // namespace slamdb::view
