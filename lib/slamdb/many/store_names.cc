// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/detail/store_names.h"

#include <algorithm>
#include <filesystem>
#include <map>

#include "slamdb/many/names.h"

namespace slamdb::detail {
namespace {

namespace fs = std::filesystem;
using Parts = std::vector<std::string>;

// The folders of a path, without `..` and the root, and the stem of its file; behind it the name in a store.
Parts PartsOf(const fs::path& path, const std::string& name) {
  Parts parts;
  for (const fs::path& folder : path.parent_path())
    if (folder != ".." && folder != "." && folder != "/" && !folder.empty()) parts.push_back(folder.string());
  parts.push_back(StemOf(path.string()));
  if (!name.empty()) parts.push_back(name);
  return parts;
}

std::string Joined(const Parts& parts, std::size_t count) {
  std::string name;
  for (std::size_t i = parts.size() - count; i < parts.size(); ++i) name += (name.empty() ? "" : "_") + parts[i];
  return name;
}

// As many parts of each path, from its end, as make the names differ, where that can be.
std::vector<StoreName> NamesByStem(const std::vector<AtlasInput>& inputs) {
  std::vector<Parts> parts;
  for (const AtlasInput& input : inputs) {
    std::error_code ignored;
    const fs::path whole = fs::absolute(input.location.path, ignored).lexically_normal();
    parts.push_back(PartsOf(whole, input.location.name));
  }
  std::vector<std::size_t> counts(inputs.size(), 1);
  std::vector<StoreName> names(inputs.size());
  for (bool changed = true; changed;) {
    std::map<std::string, std::vector<std::size_t>> alike;
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      names[i] = {Joined(parts[i], counts[i]), counts[i] > 1};
      alike[names[i].name].push_back(i);
    }
    changed = false;
    for (const auto& [name, places] : alike) {
      const auto is_same = [&](std::size_t i) { return parts[i] == parts[places[0]]; };
      if (std::ranges::all_of(places, is_same)) continue;
      for (const std::size_t i : places)
        if (counts[i] < parts[i].size()) ++counts[i], changed = true;
    }
  }
  return names;
}

std::string NameByPath(const AtlasInput& input) {
  const fs::path path = input.below.empty() ? input.location.path : input.below;
  const Parts parts = PartsOf(path.lexically_normal(), input.location.name);
  return input.below.empty() && !input.location.name.empty() ? input.location.name : Joined(parts, parts.size());
}

}  // namespace

std::vector<StoreName> StoreNamesOf(const std::vector<AtlasInput>& inputs, const AddOptions& options) {
  if (!options.name.empty()) return std::vector<StoreName>(inputs.size(), {options.name});
  std::vector<StoreName> names;
  if (options.name_from == AddOptions::NameFrom::kStem)
    names = NamesByStem(inputs);
  else
    for (const AtlasInput& input : inputs) names.push_back({NameByPath(input)});
  for (std::size_t i = 0; i < inputs.size(); ++i)
    if (inputs[i].location.path == "-") names[i] = {};  // standard input has none
  return names;
}

}  // namespace slamdb::detail
