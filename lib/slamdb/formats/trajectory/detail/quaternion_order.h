// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

#include "slamdb/base/notices.h"
#include "slamdb/formats/trajectory/detail/pose_text.h"

namespace slamdb::detail {

// In which order rows without names have their quaternions. Between blanks that is the order of `layout`; between
// commas both are written, and their rotations tell, which a note says: kTum's or kEuroc's. Nanoseconds since 1970
// between commas are EuRoC's, unless the rotations contradict. Throws Error with both readings when it cannot be told,
// and as Table.
PoseLayout LayoutOfRows(std::string_view text, PoseLayout layout, std::string_view path, Notices& notices);

}  // namespace slamdb::detail
