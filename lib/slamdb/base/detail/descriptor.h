// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <unistd.h>

namespace slamdb::detail {

// Closes a descriptor when the scope ends.
struct Descriptor {
  int value;
  explicit Descriptor(int opened) : value(opened) {}
  ~Descriptor() {
    if (value > STDERR_FILENO) ::close(value);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
};

}  // namespace slamdb::detail
