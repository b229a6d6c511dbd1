// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace slamdb::detail {

// 1234567 -> "1,234,567".
inline std::string Grouped(std::uint64_t number) {
  constexpr std::ptrdiff_t kGroup = 3;
  std::string text = std::to_string(number);
  for (auto place = static_cast<std::ptrdiff_t>(text.size()) - kGroup; place > 0; place -= kGroup)
    text.insert(text.begin() + place, ',');
  return text;
}

// "1 map", "3 maps", with the number grouped.
inline std::string Counted(std::uint64_t number, std::string_view one, std::string_view many = {}) {
  std::string text = Grouped(number) + " ";
  if (number == 1) return text.append(one);
  return many.empty() ? text.append(one) + "s" : text.append(many);
}

}  // namespace slamdb::detail
