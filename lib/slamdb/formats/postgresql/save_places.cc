// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstring>
#include <map>
#include <set>
#include <unordered_map>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/postgresql/detail/save.h"
#include "slamdb/formats/rows/detail/place_words.h"

namespace slamdb::postgresql {
namespace {

using detail::Concat;
using rows::PlaceWords;

constexpr std::size_t kOfAPlace = 8;  // keyframes

using PlaceKey = std::pair<std::int64_t, std::int64_t>;  // row of the map, number of the place
using PlacesByKey = std::map<PlaceKey, PlaceWords>;

// Which keyframes of each map have other words than the store has, by their indices.
struct ChangedWords {
  std::vector<std::vector<std::size_t>> by_map;
  std::vector<std::int64_t> gone;  // rows that have none any more, or other ones
};

ChangedWords FindChangedWords(SaveContext& context, const std::vector<MapToSave>& maps,
                              const std::vector<ListPlans>& plans) {
  std::unordered_map<std::int64_t, std::int64_t> stored;  // row to hash
  if (!context.is_new)
    context.connection.CopyOut(
        Concat("SELECT keyframe, hash FROM keyframe_words WHERE atlas = ", context.atlas),
        [&](const Row& row) { stored[row.Integer(0)] = row.Integer(1); }, "table keyframe_words");
  ChangedWords changed{.by_map = std::vector<std::vector<std::size_t>>(maps.size()), .gone = {}};
  for (std::size_t i = 0; i < maps.size(); ++i) {
    for (std::size_t k = 0; k < plans[i].keyframes.entries.size(); ++k) {
      const auto found = stored.find(plans[i].keyframes.entries[k].row);
      const bool same = found != stored.end() && found->second == maps[i].hashes.features[k];
      if (!same) changed.by_map[i].push_back(k);
      if (same) stored.erase(found);
    }
  }
  for (const auto& [row, hash] : stored) changed.gone.push_back(row);
  return changed;
}

void WriteWords(SaveContext& context, const std::vector<MapToSave>& maps, const std::vector<ListPlans>& plans,
                const ChangedWords& changed) {
  if (!changed.gone.empty())
    context.connection.Query("DELETE FROM keyframe_words WHERE atlas = $1 AND keyframe = ANY ($2)",
                             {context.atlas, std::span<const std::int64_t>(changed.gone)}, "table keyframe_words");
  if (std::ranges::all_of(changed.by_map, [](const auto& indices) { return indices.empty(); })) return;
  CopyIn copy(context.connection, WordsTable().target, WordsTable().types, context.way());
  for (std::size_t i = 0; i < maps.size(); ++i) {
    const std::vector<std::size_t>& indices = changed.by_map[i];
    const std::vector<PlaceWords> words = rows::PlaceWordsOf(maps[i].map, indices, context.options.threads);
    for (std::size_t n = 0; n < words.size(); ++n)
      copy.Add(std::array<Value, 4>{context.atlas, plans[i].keyframes.entries[indices[n]].row,
                                    maps[i].hashes.features[indices[n]], std::as_bytes(std::span(words[n]))});
  }
  copy.Finish();
}

// Of the keyframes that the store has by now.
PlacesByKey PlacesOf(SaveContext& context, const std::string& maps) {
  PlacesByKey places;
  std::vector<PlaceWords> place;
  PlaceKey key{0, 0};
  const auto end = [&] {
    if (!place.empty()) places[key] = rows::SharedWords(place);
    place.clear();
    ++key.second;
  };
  context.connection.CopyOut(
      Concat("SELECT map, words FROM ", context.partition.Table("keyframe"), " JOIN ",
             context.partition.Table("keyframe_words"),
             " ON keyframe_words.atlas = keyframe.atlas AND keyframe_words.keyframe = row WHERE ",
             InNewest(context.atlas, "keyframe."), " AND map IN (", maps, ") ORDER BY map, id, row"),
      [&](const Row& row) {
        if (row.Integer(0) != key.first || place.size() == kOfAPlace) end();
        if (row.Integer(0) != key.first) key = {row.Integer(0), 0};
        PlaceWords& words = place.emplace_back();
        const Bytes bytes = row.Blob(1);
        std::memcpy(words.data(), bytes.data(), std::min(bytes.size(), sizeof words));
      },
      "table keyframe_words");
  end();
  return places;
}

// Writes the places of some maps that are not as they were.
void WritePlaces(SaveContext& context, const std::set<std::int64_t>& of_maps) {
  if (of_maps.empty()) return;
  const std::string maps = ListOf(of_maps);
  PlacesByKey places = PlacesOf(context, maps);
  std::vector<std::int64_t> old_maps, old_numbers;
  if (!context.is_new)
    context.connection.CopyOut(
        Concat("SELECT map, number, words FROM ", context.partition.Table("place"), " WHERE atlas = ", context.atlas,
               " AND map IN (", maps, ")"),
        [&](const Row& row) {
          const auto found = places.find({row.Integer(0), row.Integer(1)});
          if (found != places.end() && std::ranges::equal(std::as_bytes(std::span(found->second)), row.Bits(2))) {
            places.erase(found);
            return;
          }
          old_maps.push_back(row.Integer(0));
          old_numbers.push_back(row.Integer(1));
        },
        "table place");
  if (!old_maps.empty())
    context.connection.Query(
        "DELETE FROM place WHERE atlas = $1 AND (map, number) IN (SELECT * FROM unnest ($2::bigint[], $3::bigint[]))",
        {context.atlas, std::span<const std::int64_t>(old_maps), std::span<const std::int64_t>(old_numbers)},
        "table place");
  if (places.empty()) return;
  CopyIn copy(context.connection, PlaceTable().target, PlaceTable().types, context.way());
  for (const auto& [key, words] : places) {
    copy.Add(std::array<Value, 5>{context.atlas, key.first, key.second, std::int64_t{rows::CountOf(words)},
                                  std::as_bytes(std::span(words))});
  }
  copy.Finish();
}

}  // namespace

void SaveWords(SaveContext& context, const std::vector<MapToSave>& maps, const std::vector<ListPlans>& plans,
               bool all_places) {
  const ChangedWords changed = FindChangedWords(context, maps, plans);
  WriteWords(context, maps, plans, changed);
  std::set<std::int64_t> changed_maps;
  for (std::size_t i = 0; i < maps.size(); ++i)
    if (all_places || !changed.by_map[i].empty()) changed_maps.insert(maps[i].row);
  for (const std::int64_t row : changed.gone) changed_maps.insert(rows::MapOfRow(row));
  WritePlaces(context, changed_maps);
}

bool HasAllWords(SaveContext& context, const Atlas& atlas) {
  std::int64_t keyframes = 0, places = 0;
  for (const Map& map : atlas.maps) {
    keyframes += static_cast<std::int64_t>(map.keyframes.size());
    places += static_cast<std::int64_t>((map.keyframes.size() + kOfAPlace - 1) / kOfAPlace);
  }
  return context.connection.Integer(
             "SELECT ((SELECT count(*) FROM keyframe_words WHERE atlas = $1) = $2 AND (SELECT count(*) FROM place "
             "WHERE "
             "atlas = $1) = $3)::integer",
             {context.atlas, keyframes, places}) != 0;
}

}  // namespace slamdb::postgresql
