// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

namespace slamdb::detail {

// The JSON of each known layout, v1.0 first, each behind its base.
std::span<const char* const> KnownLayoutTexts();

}  // namespace slamdb::detail
