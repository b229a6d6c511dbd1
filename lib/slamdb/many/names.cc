// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/names.h"

#include <filesystem>

#include "slamdb/formats/formats.h"

namespace slamdb {

std::string SuffixOf(const std::string& path) {
  std::string found = std::filesystem::path(path).extension().string();
  for (const Format& format : Formats())
    for (const std::string_view suffix : format.suffixes)
      if (path.ends_with(suffix) && suffix.size() > found.size()) found = suffix;
  return found;
}

std::string StemOf(const std::string& path) {
  const std::string name = std::filesystem::path(path).filename().string();
  return name.substr(0, name.size() - SuffixOf(name).size());
}

std::string NameOf(const Location& atlas) { return atlas.name.empty() ? StemOf(atlas.path) : atlas.name; }

}  // namespace slamdb
