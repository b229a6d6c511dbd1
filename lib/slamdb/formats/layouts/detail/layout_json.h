// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "slamdb/base/detail/json.h"
#include "slamdb/formats/layouts/layout.h"

namespace slamdb::detail {

// ParseLayout, with the layouts that it may be a change of.
Layout ParseLayoutOver(std::string_view json, const std::string& path, std::span<const Layout> bases);

// The layout in full, as ParseLayout takes it.
Json JsonOf(const Layout& layout);

// Gives members ORB-SLAM3's own names where a layout has the short ones of older layout files: `gw` becomes
// mfGridElementWidthInv, and `fx: arr<f32,9>` nine members.
void UseOwnNames(Layout& layout);

}  // namespace slamdb::detail
