// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

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

inline Json TextOrNull(const std::string& text) { return text.empty() ? Json() : Json(text); }

// What every report begins with: {"report": "slamdb-cull-2"}.
inline Json ReportHead(std::string_view name) {
  return {{"report", "slamdb-" + std::string(name) + "-" + std::to_string(kReportVersion)}};
}

// And those of one atlas, with `input` and `output`.
inline Json ReportHead(std::string_view name, const ReportFiles& files) {
  Json json = ReportHead(name);
  json["input"] = TextOrNull(files.input);
  json["output"] = TextOrNull(files.output);
  return json;
}

// A report as text with a line feed; `indent` -1: on one line.
// Bytes of names and paths that are not UTF-8 become U+FFFD, as JSON is UTF-8.
inline std::string JsonText(const Json& report, int indent = 2) {
  return report.dump(indent, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace slamdb::detail
