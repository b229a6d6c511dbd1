// SPDX-License-Identifier: BSD-3-Clause
#include "cli/values.h"

#include <cmath>

#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"
#include "slamdb/model/geodetic.h"

namespace slamdb::cli {

std::string CheckFinite(const std::string& text) {
  const auto number = detail::ParseNumber<double>(text);
  return number && std::isfinite(*number) ? std::string() : "expected a finite number, found '" + text + "'";
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
