// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/time_units.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"

namespace slamdb {
namespace {

constexpr std::array<std::string_view, 4> kShort = {"s", "ms", "us", "ns"};
constexpr std::array<std::string_view, 4> kLong = {"seconds", "milliseconds", "microseconds", "nanoseconds"};

}  // namespace

std::string_view NameOf(TimeUnit unit) { return kShort[static_cast<std::size_t>(unit)]; }

std::optional<TimeUnit> TimeUnitByName(std::string_view name) {
  static constexpr std::pair<std::string_view, TimeUnit> kSpellings[] = {{"sec", TimeUnit::kSeconds},
                                                                         {"secs", TimeUnit::kSeconds},
                                                                         {"second", TimeUnit::kSeconds},
                                                                         {"msec", TimeUnit::kMilliseconds},
                                                                         {"msecs", TimeUnit::kMilliseconds},
                                                                         {"milli", TimeUnit::kMilliseconds},
                                                                         {"millis", TimeUnit::kMilliseconds},
                                                                         {"millisec", TimeUnit::kMilliseconds},
                                                                         {"millisecs", TimeUnit::kMilliseconds},
                                                                         {"millisecond", TimeUnit::kMilliseconds},
                                                                         {"usec", TimeUnit::kMicroseconds},
                                                                         {"usecs", TimeUnit::kMicroseconds},
                                                                         {"micro", TimeUnit::kMicroseconds},
                                                                         {"micros", TimeUnit::kMicroseconds},
                                                                         {"microsec", TimeUnit::kMicroseconds},
                                                                         {"microsecs", TimeUnit::kMicroseconds},
                                                                         {"microsecond", TimeUnit::kMicroseconds},
                                                                         {"nsec", TimeUnit::kNanoseconds},
                                                                         {"nsecs", TimeUnit::kNanoseconds},
                                                                         {"nano", TimeUnit::kNanoseconds},
                                                                         {"nanos", TimeUnit::kNanoseconds},
                                                                         {"nanosec", TimeUnit::kNanoseconds},
                                                                         {"nanosecs", TimeUnit::kNanoseconds},
                                                                         {"nanosecond", TimeUnit::kNanoseconds}};
  for (const TimeUnit unit : detail::kTimeUnits)
    if (name == NameOf(unit) || name == detail::LongNameOf(unit)) return unit;
  for (const auto& [spelling, unit] : kSpellings)
    if (name == spelling) return unit;
  return std::nullopt;
}

namespace detail {

std::string_view LongNameOf(TimeUnit unit) { return kLong[static_cast<std::size_t>(unit)]; }

int PowerOf(TimeUnit unit) { return -3 * static_cast<int>(unit); }

bool IsEpoch(double seconds) { return seconds >= kEpochBegin && seconds < kEpochEnd; }

std::optional<std::string> ShiftedDecimal(std::string_view number, int power) {
  const auto value = ParseNumber<double>(number);
  constexpr std::size_t kLongest = 200;
  if (!value || !std::isfinite(*value) || number.size() > kLongest) return std::nullopt;
  const bool negative = number.starts_with('-');
  if (number.starts_with('+') || negative) number.remove_prefix(1);
  if (const std::size_t e = number.find_first_of("eE"); e != number.npos) {
    power += ParseNumber<int>(number.substr(e + 1)).value_or(0);
    number = number.substr(0, e);
  } else if (power == 0) {
    return Concat(negative ? "-" : "", number);
  }
  std::string digits(number);
  std::size_t point = std::min(digits.find('.'), digits.size());
  if (point < digits.size()) digits.erase(point, 1);
  const std::ptrdiff_t place = static_cast<std::ptrdiff_t>(point) + power;
  if (place > 400 || place < -400) return *value == 0 ? std::optional<std::string>("0") : std::nullopt;
  if (place <= 0) digits.insert(0, static_cast<std::size_t>(1 - place), '0');
  point = static_cast<std::size_t>(std::max<std::ptrdiff_t>(place, 1));
  if (digits.size() < point) digits.append(point - digits.size(), '0');
  digits.insert(point, 1, '.');
  digits.erase(digits.find_last_not_of('0') + 1);
  if (digits.ends_with('.')) digits.pop_back();
  digits.erase(0, std::min(digits.find_first_not_of('0'), digits.size()));
  if (digits.empty() || digits.front() == '.') digits.insert(0, 1, '0');
  return Concat(negative ? "-" : "", digits);
}

}  // namespace detail
}  // namespace slamdb
