// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string_view>

#include "slamdb/base/progress.h"

namespace slamdb::detail {

// Tells a listener how far work of so many steps is. Without a listener it does nothing.
class Steps {
 public:
  Steps(const Progress& progress, std::string_view stage, std::size_t steps)
      : progress_(progress), stage_(stage), steps_(steps) {}

  // Another step is done. Throws what the listener throws.
  void Next() {
    if (done_ < steps_) ++done_;  // work that turns out longer stays at its end
    if (progress_) progress_(stage_, static_cast<double>(done_) / static_cast<double>(steps_));
  }

 private:
  const Progress& progress_;
  std::string_view stage_;
  std::size_t steps_, done_ = 0;
};

}  // namespace slamdb::detail
