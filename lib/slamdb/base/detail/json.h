// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/server.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"
#include "slamdb/base/report_files.h"

// How reports become JSON, the same for all of them; docs/json.md has the names that they share.
// For sources only: no public header includes nlohmann_json.
namespace slamdb::detail {

using Json = nlohmann::ordered_json;

// The version of the reports' names, which counts the changes that break their readers.
inline constexpr int kReportVersion = 2;

// Numbers up to 2^53 survive every JSON reader; larger ones only as text.
inline Json JsonNumber(std::uint64_t value) {
  constexpr std::uint64_t kExact = std::uint64_t{1} << 53;
  return value <= kExact ? Json(value) : Json(std::to_string(value));
}

// On one line, or with that many blanks an indent.
// Bytes of names and paths that are not UTF-8 become U+FFFD, as JSON is UTF-8. Passwords of servers are left out.
inline std::string Dumped(const Json& json, int indent = -1) {
  return WithoutPasswords(json.dump(indent, ' ', false, Json::error_handler_t::replace));
}

// The way back: a whole number that the type holds, also as text. Throws Error (kDamaged) for anything else.
template <std::integral Integer>
Integer IntegerOf(const Json& value) {
  std::optional<Integer> number;
  if (value.is_string())
    number = ParseNumber<Integer>(value.get_ref<const std::string&>());
  else if (value.is_number_unsigned() && std::in_range<Integer>(value.get<std::uint64_t>()))
    number = static_cast<Integer>(value.get<std::uint64_t>());
  else if (value.is_number_integer() && !value.is_number_unsigned() &&
           std::in_range<Integer>(value.get<std::int64_t>()))
    number = static_cast<Integer>(value.get<std::int64_t>());
  if (!number)
    throw Error(ErrorKind::kDamaged,
                Concat(Dumped(value), " is no whole number from ", std::numeric_limits<Integer>::min(), " to ",
                       std::numeric_limits<Integer>::max()));
  return *number;
}

template <class Number>
Json NumberOrNull(const std::optional<Number>& number) {
  return number ? Json(*number) : Json();
}
inline Json TextOrNull(const std::string& text) { return text.empty() ? Json() : Json(text); }

// What every report begins with: {"report": "slamdb-cull-2"}.
inline Json ReportHead(std::string_view name) {
  return {{"report", "slamdb-" + std::string(name) + "-" + std::to_string(kReportVersion)}};
}

// And those about what was read alone, with `input`.
inline Json ReportHead(std::string_view name, const std::string& input) {
  Json json = ReportHead(name);
  json["input"] = TextOrNull(input);
  return json;
}

// And those of one atlas, with `input` and `output`.
inline Json ReportHead(std::string_view name, const ReportFiles& files) {
  Json json = ReportHead(name, files.input);
  json["output"] = TextOrNull(files.output);
  return json;
}

// A report as text with a line feed; `indent` -1: on one line.
inline std::string JsonText(const Json& report, int indent = 2) { return Dumped(report, indent) + "\n"; }

}  // namespace slamdb::detail
