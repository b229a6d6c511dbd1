// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace slamdb::cli {

// A report as text with a line feed. Bytes of names and paths that are not UTF-8 become U+FFFD, as JSON is UTF-8.
inline std::string JsonText(const nlohmann::ordered_json& report, int indent = 2) {
  return report.dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace slamdb::cli
