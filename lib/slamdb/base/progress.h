// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string_view>

namespace slamdb {

// Called now and then during long work: what is being done ("reading session_b.osa"), and how much of it, 0 to 1.
// Throwing from it cancels the work.
//
// Always called from the thread that called the library.
using Progress = std::function<void(std::string_view stage, double fraction)>;

}  // namespace slamdb
