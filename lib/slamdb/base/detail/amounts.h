// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "slamdb/export.h"

// Lengths, durations, sizes and dates as people read them: the same words in every report, picture and page. The page
// of `slamdb view` writes lengths and durations likewise (view/page/format.ts).
namespace slamdb::detail {

// Four significant digits, and whole numbers in groups beyond: `0.0123`, `30.23`, `12,345`.
SLAMDB_EXPORT std::string Rounded(double amount);

// The same with its unit: `30.23 m`, `12,345 units`.
SLAMDB_EXPORT std::string LengthText(double length, std::string_view unit);

// `17.9 s`, `1 min 15 s`, `11 h 6 min`.
SLAMDB_EXPORT std::string DurationText(double seconds);

// 33424706 as `33.4 MB`; powers of 1000.
SLAMDB_EXPORT std::string HumanBytes(std::uint64_t bytes);

// When it was, of seconds since 1970: `2014-06-24 19:02:59 UTC`. Empty for what counts from elsewhere.
SLAMDB_EXPORT std::string DateText(double seconds);

// Seconds with all their digits: `1403636579.76`.
SLAMDB_EXPORT std::string SecondsText(double seconds);

// "17.9 s", with the date of the beginning where times tell one: "17.9 s from 2014-06-24 19:02:59 UTC".
SLAMDB_EXPORT std::string DatedDuration(double begin, double end);

}  // namespace slamdb::detail
