// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/maps_to_align.h"

#include <algorithm>
#include <utility>

#include "slamdb/base/detail/run_files.h"
#include "slamdb/base/detail/server.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/location.h"
#include "slamdb/many/likely_maps.h"
#include "slamdb/model/statistics.h"

namespace slamdb {
namespace {

// Atlases of the store that are inputs themselves.
std::vector<std::string> NamedOf(const Store& store, const std::vector<std::string>& inputs) {
  std::vector<std::string> names;
  for (const std::string& input : inputs) {
    const Location location(input);
    if (!location.name.empty() && detail::IsSameFile(location.path, std::nullopt, store.path(), std::nullopt))
      names.push_back(location.name);
  }
  return names;
}

void AddMaps(std::shared_ptr<const Atlas> atlas, const std::string& name, MapsToAlign& to) {
  for (std::size_t row = 0; row < atlas->maps.size(); ++row) {
    const Map& map = atlas->maps[row];
    if (map.keyframes.empty()) continue;
    to.maps.push_back({atlas.get(), row});
    to.names.push_back({name, map.id});
    to.metric.push_back(IsMetric(map));
  }
  to.atlases.push_back(std::move(atlas));
}

}  // namespace

void MapsToAlign::Add(std::shared_ptr<const Atlas> atlas, const std::string& name) {
  AddMaps(std::move(atlas), name, *this);
  asked = maps.size();
}

void MapsToAlign::AddLikely(Store& of, const std::vector<std::string>& inputs, const ReadOptions& options,
                            Notices& notices) {
  if (maps.empty())
    throw Error(ErrorKind::kNotPossible, of.path(), "",
                "is a store of several atlases; name another one to align with them");
  const LikelyMaps likely = FindLikelyMaps(of, maps, {.without = NamedOf(of, inputs), .threads = options.threads});
  for (const LikelyMap& map : likely.maps) {
    ReadOptions read = options;
    read.selection.map = map.map;
    try {
      AddMaps(std::make_shared<const Atlas>(of.Load(map.atlas, read)), Location(of.path(), map.atlas).ToString(),
              *this);
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::kDamaged) throw;
      notices.Warn(std::string("not compared: ") + error.what());
    }
  }
  store = {detail::WithoutPassword(of.path()), likely.unlike, likely.unknown, likely.unreachable};
}

AlignedMaps MapsToAlign::Align(const AlignOptions& options) const {
  if (asked == 0) throw Error(ErrorKind::kNotPossible, "has no map with keyframes");
  if (asked < 2 && !store)
    throw Error(ErrorKind::kNotPossible, names.front().input, "",
                "has only one map with keyframes; name another atlas to align it with");
  return AlignWithOthers(maps, asked, options);
}

bool MapsToAlign::AreSure(const AlignedMaps& aligned) const {
  if (!store) return std::ranges::all_of(aligned.places, [](const MapPlace& place) { return place.group == 0; });
  for (std::size_t map = 0; map < asked; ++map)
    if (std::ranges::none_of(aligned.links, [&](const MapLink& link) {
          return link.first == map && link.second >= asked && link.is_used();
        }))
      return false;
  return true;
}

std::string MapsToAlign::ToJson(const AlignedMaps& aligned) const { return slamdb::ToJson(aligned, names, store); }

}  // namespace slamdb
