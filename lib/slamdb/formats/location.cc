// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/location.h"

#include <filesystem>

namespace slamdb {

Location Location::Parse(std::string_view text) {
  const std::size_t slash = text.rfind('/');
  const std::size_t component = slash == std::string_view::npos ? 0 : slash + 1;
  const std::size_t hash = text.rfind('#');
  std::error_code ignored;
  if (hash == std::string_view::npos || hash <= component || std::filesystem::exists(text, ignored))
    return {std::string(text), {}};
  return {std::string(text.substr(0, hash)), std::string(text.substr(hash + 1))};
}

}  // namespace slamdb
