// SPDX-License-Identifier: BSD-3-Clause
#include "cli/values.h"

#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"
#include "slamdb/model/geodetic.h"

namespace slamdb::cli {

std::function<std::string(const std::string&)> Within(const Limits& limits) {
  return [limits](const std::string& text) {
    const auto number = detail::ParseNumber<double>(text);
    return number && limits.Hold(*number) ? std::string() : "expected " + limits.Text() + ", found '" + text + "'";
  };
}

std::string CheckPlace(const std::string& text) {
  try {
    (void)ParseGeodetic(text);
    return {};
  } catch (const Error& error) {
    return error.problem();
  }
}

}  // namespace slamdb::cli
