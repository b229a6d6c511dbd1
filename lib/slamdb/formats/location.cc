// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/location.h"

#include <filesystem>

#include "slamdb/formats/detail/choose.h"
#include "slamdb/formats/formats.h"

namespace slamdb {
namespace {

// Files that hold one atlas, without a name.
bool IsPlain(const Format& format) { return !format.named; }

}  // namespace

Location Location::Parse(std::string_view text) {
  const std::size_t slash = text.rfind('/');
  const std::size_t component = slash == std::string_view::npos ? 0 : slash + 1;
  const std::size_t hash = text.rfind('#');
  const Location whole(std::string(text), {});
  std::error_code ignored;
  if (hash == std::string_view::npos || hash <= component || std::filesystem::exists(text, ignored)) return whole;
  const Location parts(std::string(text.substr(0, hash)), std::string(text.substr(hash + 1)));
  const bool plain = detail::FormatBySuffix(text, IsPlain) != nullptr && !HoldsNamedAtlases(parts.path);
  return plain ? whole : parts;
}

}  // namespace slamdb
