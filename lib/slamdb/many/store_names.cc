// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/detail/store_names.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/server.h"
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

fs::path WholePath(const AtlasInput& input) {
  std::error_code ignored;
  if (input.location.is_server()) return Concat("/", DatabaseOfServer(input.location.path));
  return fs::absolute(input.location.path, ignored).lexically_normal();
}

// As many parts of each path, from its end, as make the names differ, where that can be. Paths whose names are the same
// to the root get no longer ones by each other: `a_b/c` and `a/b_c`, `map.osa` and `map.osa.txt`.
std::vector<StoreName> NamesByStem(const std::vector<AtlasInput>& inputs) {
  std::vector<Parts> parts;
  for (const AtlasInput& input : inputs) parts.push_back(PartsOf(WholePath(input), input.location.name));
  std::vector<std::size_t> counts(inputs.size(), 1);
  std::vector<StoreName> names(inputs.size());
  for (bool changed = true; changed;) {
    std::map<std::string, std::vector<std::size_t>> alike;
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      names[i] = {Joined(parts[i], counts[i]), counts[i] > 1};
      alike[names[i].name].push_back(i);
    }
    changed = false;
    for (const auto& entry : alike) {
      const std::vector<std::size_t>& places = entry.second;
      const auto whole = [&](std::size_t i) { return Joined(parts[i], parts[i].size()); };
      if (std::ranges::all_of(places, [&](std::size_t i) { return whole(i) == whole(places[0]); })) continue;
      for (const std::size_t i : places)
        if (counts[i] < parts[i].size()) ++counts[i], changed = true;
    }
  }
  for (std::size_t i = 0; i < inputs.size(); ++i)
    for (std::size_t count = 1; count <= parts[i].size(); ++count) names[i].derived.push_back(Joined(parts[i], count));
  return names;
}

// Numbers those that still have the name of another path.
void Number(const std::vector<AtlasInput>& inputs, std::vector<StoreName>& names) {
  using Path = std::pair<fs::path, std::string>;
  std::set<std::string> wanted;
  for (const StoreName& name : names) wanted.insert(name.name);
  std::map<std::string, Path> owners;
  std::map<Path, std::string> numbered;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const Path path(WholePath(inputs[i]), inputs[i].location.name);
    if (owners.emplace(names[i].name, path).first->second == path) continue;
    std::string& name = numbered[path];
    for (std::size_t number = 2; name.empty(); ++number)
      if (std::string free = Concat(names[i].name, "-", number); wanted.insert(free).second) name = std::move(free);
    names[i].name = name;
  }
}

std::string NameByPath(const AtlasInput& input) {
  const fs::path path = input.below.empty() ? input.location.path : input.below;
  const Parts parts = PartsOf(path.lexically_normal(), input.location.name);
  return input.below.empty() && !input.location.name.empty() ? input.location.name : Joined(parts, parts.size());
}

}  // namespace

void HeldNames::Add(const std::string& name) {
  by_stem_[name].insert(name);
  const std::size_t last = name.find_last_not_of("0123456789");
  if (last != std::string::npos && last + 1 < name.size() && name[last] == '-')
    by_stem_[name.substr(0, last)].insert(name);
}

std::vector<std::string> HeldNames::DerivedOf(const StoreName& name) const {
  std::vector<std::string> found;
  for (const std::string& stem : name.derived)
    if (const auto names = by_stem_.find(stem); names != by_stem_.end())
      found.insert(found.end(), names->second.begin(), names->second.end());
  return found;
}

std::vector<StoreName> StoreNamesOf(const std::vector<AtlasInput>& inputs, const AddOptions& options) {
  if (!options.name.empty()) return std::vector<StoreName>(inputs.size(), {options.name});
  std::vector<StoreName> names;
  std::vector<AtlasInput> atlases = inputs;  // that revisions are of
  for (AtlasInput& atlas : atlases) atlas.location = WithoutRevision(atlas.location);
  if (options.name_from == AddOptions::NameFrom::kStem)
    names = NamesByStem(atlases);
  else
    for (const AtlasInput& atlas : atlases) names.push_back({NameByPath(atlas), false, {NameByPath(atlas)}});
  Number(inputs, names);
  for (std::size_t i = 0; i < inputs.size(); ++i)
    if (inputs[i].location.path == "-") names[i] = {};  // standard input has none
  return names;
}

}  // namespace slamdb::detail
