// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/location.h"

#include <filesystem>

#include "slamdb/base/detail/server.h"
#include "slamdb/formats/detail/choose.h"
#include "slamdb/formats/formats.h"

namespace slamdb {
namespace {

// Files that hold one atlas, without a name.
bool IsPlain(const Format& format) { return !format.named; }

Location Split(std::string_view text, std::size_t hash) {
  if (hash == std::string_view::npos) return {std::string(text), {}};
  return {std::string(text.substr(0, hash)), std::string(text.substr(hash + 1))};
}

}  // namespace

Location Location::Parse(std::string_view text) {
  if (detail::IsServer(text)) return Split(text, detail::NameBehind(text));
  const std::size_t slash = text.rfind('/');
  const std::size_t component = slash == std::string_view::npos ? 0 : slash + 1;
  const std::size_t hash = text.rfind('#');
  const Location whole(std::string(text), {});
  std::error_code ignored;
  if (hash == std::string_view::npos || hash <= component || std::filesystem::exists(text, ignored)) return whole;
  Location parts = Split(text, hash);
  const bool plain = detail::FormatBySuffix(text, IsPlain) != nullptr && !HoldsNamedAtlases(parts.path);
  return plain ? whole : parts;
}

bool Location::is_server() const { return detail::IsServer(path); }

std::string Location::ToString() const {
  const std::string shown = detail::WithoutPassword(path);
  return name.empty() ? shown : shown + "#" + name;
}

}  // namespace slamdb
