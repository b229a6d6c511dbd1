// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/location.h"

#include <strings.h>

#include <algorithm>
#include <filesystem>

#include "slamdb/formats/formats.h"

namespace slamdb {
namespace {

// Whether the path has the suffix of files that hold one atlas, without a name.
bool NamesPlainFile(std::string_view path) {
  const auto ends_path = [path](std::string_view suffix) {
    return path.size() > suffix.size() &&
           ::strncasecmp(path.substr(path.size() - suffix.size()).data(), suffix.data(), suffix.size()) == 0;
  };
  return std::ranges::any_of(Formats(), [&](const Format& format) {
    return !format.named && std::ranges::any_of(format.suffixes, ends_path);
  });
}

}  // namespace

Location Location::Parse(std::string_view text) {
  const std::size_t slash = text.rfind('/');
  const std::size_t component = slash == std::string_view::npos ? 0 : slash + 1;
  const std::size_t hash = text.rfind('#');
  const Location whole(std::string(text), {});
  std::error_code ignored;
  if (hash == std::string_view::npos || hash <= component || std::filesystem::exists(text, ignored)) return whole;
  const Location parts(std::string(text.substr(0, hash)), std::string(text.substr(hash + 1)));
  return NamesPlainFile(text) && !HoldsNamedAtlases(parts.path) ? whole : parts;
}

}  // namespace slamdb
