// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace slamdb::detail {

// Throws Error (kUnsupported), which says what to install, where this slamdb was built without Ceres.
void RequireCeres();

}  // namespace slamdb::detail
