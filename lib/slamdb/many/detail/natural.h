// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace slamdb::detail {

// Whether a name stands before another one as people count: `map2` before `map10`, a folder's files before those of
// `folder2`. Of equal numbers the one with fewer leading zeros is first; everything else is by bytes. A strict weak
// order in which only equal names are equal.
bool NaturalLess(std::string_view a, std::string_view b);

}  // namespace slamdb::detail
