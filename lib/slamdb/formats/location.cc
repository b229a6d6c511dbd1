// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>

#include "slamdb/formats/format.h"

namespace slamdb {

Location Location::Parse(std::string_view text) {
  const std::size_t slash = text.rfind('/');
  const std::size_t component = slash == std::string_view::npos ? 0 : slash + 1;
  const std::size_t hash = text.rfind('#');
  std::error_code ignored;
  if (hash == std::string_view::npos || hash <= component || std::filesystem::exists(text, ignored))
    return {.path = std::string(text), .name = {}};
  return {.path = std::string(text.substr(0, hash)), .name = std::string(text.substr(hash + 1))};
}

}  // namespace slamdb
