// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string_view>

namespace slamdb {

// Called now and then during long work, always from the thread that called the library: what is being done
// ("reading session_b.osa") and how much of it is done, 0 to 1. Throwing from it cancels the work.
using Progress = std::function<void(std::string_view stage, double fraction)>;

}  // namespace slamdb
