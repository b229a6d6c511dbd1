// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/names.h"

#include <filesystem>
#include <vector>

#include "slamdb/base/detail/server.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/store/store.h"

namespace slamdb {
namespace {

// The name of an atlas that its location tells; empty when it tells none.
std::string NameOfAtlas(const Location& input) {
  std::error_code missing;
  if (!input.name.empty()) return WithoutRevision(input).name;
  if (!input.is_server() && !std::filesystem::is_regular_file(input.path, missing)) return {};
  const Format* format = FindFormatOfInput(input);
  if (format == nullptr || !format->named) return StemOf(input.path);
  const std::vector<std::string> names = Store::Open(input.path).Names();
  return names.size() == 1 ? names.front() : std::string();
}

}  // namespace

std::string SuffixOf(const std::string& path) {
  if (detail::IsServer(path)) return {};
  std::string found = std::filesystem::path(path).extension().string();
  for (const Format& format : Formats())
    for (const std::string_view suffix : format.suffixes)
      if (path.ends_with(suffix) && suffix.size() > found.size()) found = suffix;
  return found;
}

std::string StemOf(const std::string& path) {
  if (detail::IsServer(path)) return detail::NameOfDatabase(path);
  const std::string name = std::filesystem::path(path).filename().string();
  return name.substr(0, name.size() - SuffixOf(name).size());
}

std::string NameOf(const Location& atlas) { return atlas.name.empty() ? StemOf(atlas.path) : atlas.name; }

Location WithoutRevision(const Location& atlas) {
  if (atlas.name.find('@') == std::string::npos) return atlas;
  try {
    return {atlas.path, Store::Open(atlas.path).FindRevision(atlas.name).atlas};
  } catch (const Error&) {
    return atlas;  // what is wrong with it is said where it is read
  }
}

std::string NamedOutput(const std::string& input, const std::string& output, const std::string& format) {
  const Location target(output);
  if (output.empty() || output == "-" || !target.name.empty()) return output;
  try {
    if (!FormatOfOutput(target, format).named) return output;
    const std::string name = NameOfAtlas(Location(input));
    return IsNameOfAtlas(name) ? output + "#" + name : output;
  } catch (const Error&) {
    return output;  // what is wrong with it is said where it is read and written
  }
}

}  // namespace slamdb
