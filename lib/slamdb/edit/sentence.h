// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdio>
#include <string>

namespace slamdb {

// A sentence for a report, with one or two numbers as printf's `format` has them.
inline std::string Sentence(const char* format, double a, double b = 0) {
  std::array<char, 512> text;
  std::snprintf(text.data(), text.size(), format, a, b);
  return text.data();
}

}  // namespace slamdb
