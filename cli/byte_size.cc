// SPDX-License-Identifier: BSD-3-Clause
#include "cli/byte_size.h"

#include <cctype>
#include <cmath>
#include <utility>

#include "slamdb/base/detail/amounts.h"
#include "slamdb/base/detail/text.h"

namespace slamdb::cli {
namespace {

// 1 for `` and `B`, 1e3 for `k` and `kB`, 1024 for `Ki` and `KiB`; 0: no unit.
double FactorOf(std::string unit) {
  constexpr std::string_view kPrefixes = "kmgtpe";
  for (char& letter : unit) letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  if (unit.ends_with('b')) unit.pop_back();
  if (unit.empty()) return 1;
  const bool binary = unit.size() == 2 && unit.back() == 'i';
  const std::size_t power = kPrefixes.find(unit.front()) + 1;
  if (power == 0 || unit.size() > (binary ? 2U : 1U)) return 0;
  return std::pow(binary ? 1024.0 : 1000.0, static_cast<double>(power));
}

}  // namespace

std::optional<std::uint64_t> ParseByteSize(std::string_view text) {
  if (text.starts_with('+') || text.starts_with('-')) return std::nullopt;
  const std::size_t unit = text.find_last_of("0123456789.") + 1;
  const auto number = detail::ParseNumber<double>(text.substr(0, unit));
  const double factor = FactorOf(std::string(text.substr(unit)));
  const double bytes = number.value_or(-1) * factor;
  constexpr double kMost = 9e18;
  const bool is_part_of_one = bytes > 0 && bytes < 1;
  return factor > 0 && bytes >= 0 && bytes < kMost && !is_part_of_one ? std::optional(static_cast<std::uint64_t>(bytes))
                                                                      : std::nullopt;
}

CLI::Option* AddByteSize(CLI::App& verb, const std::string& names, const Limits& limits,
                         std::function<void(std::uint64_t bytes)> take, const std::string& description) {
  const auto check = [limits](const std::string& text) {
    const auto bytes = ParseByteSize(text);
    if (bytes && limits.Hold(static_cast<double>(*bytes))) return std::string();
    return "expected bytes, at most " + detail::HumanBytes(static_cast<std::uint64_t>(limits.high)) +
           ", such as 500MB or 1.5GiB, found '" + text + "'";
  };
  return verb
      .add_option_function<std::string>(
          names, [take = std::move(take)](const std::string& text) { take(ParseByteSize(text).value()); }, description)
      ->type_name("SIZE")
      ->check(check);
}

}  // namespace slamdb::cli
