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
using WordsByRow = std::unordered_map<std::int64_t, PlaceWords>;  // of keyframes

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

// Returns those that it wrote.
WordsByRow WriteWords(SaveContext& context, const std::vector<MapToSave>& maps, const std::vector<ListPlans>& plans,
                      const ChangedWords& changed) {
  WordsByRow written;
  if (!changed.gone.empty())
    context.connection.Query("DELETE FROM keyframe_words WHERE atlas = $1 AND keyframe = ANY ($2)",
                             {context.atlas, std::span<const std::int64_t>(changed.gone)}, "table keyframe_words");
  if (std::ranges::all_of(changed.by_map, [](const auto& indices) { return indices.empty(); })) return written;
  CopyIn copy(context.connection, WordsTable().target, WordsTable().types, context.way());
  for (std::size_t i = 0; i < maps.size(); ++i) {
    const std::vector<std::size_t>& indices = changed.by_map[i];
    const std::vector<PlaceWords> words = rows::PlaceWordsOf(maps[i].map, indices, context.options.threads);
    for (std::size_t n = 0; n < words.size(); ++n) {
      const std::int64_t row = plans[i].keyframes.entries[indices[n]].row;
      copy.Add(std::array<Value, 4>{context.atlas, row, maps[i].hashes.features[indices[n]],
                                    std::as_bytes(std::span(words[n]))});
      written[row] = words[n];
    }
  }
  copy.Finish();
  return written;
}

// Adds those that the store has, of keyframes of some maps.
void ReadWords(SaveContext& context, const std::string& maps, WordsByRow& words) {
  context.connection.CopyOut(
      Concat("SELECT keyframe, words FROM ", context.partition.Table("keyframe_words"),
             " WHERE atlas = ", context.atlas, " AND keyframe >> 32 IN (", maps, ")"),
      [&](const Row& row) {
        const auto [entry, is_new] = words.try_emplace(row.Integer(0));
        const Bytes bytes = row.Blob(1);
        if (is_new) std::memcpy(entry->second.data(), bytes.data(), std::min(bytes.size(), sizeof entry->second));
      },
      "table keyframe_words");
}

// Of each keyframe of a map, in the order of their ids.
std::vector<PlaceWords> WordsInOrder(const Map& map, const rows::ListPlan& plan, const WordsByRow& words) {
  std::vector<std::pair<std::uint64_t, std::int64_t>> order;  // id and row
  for (std::size_t k = 0; k < plan.entries.size(); ++k)
    order.emplace_back(map.keyframes[k].id.value(), plan.entries[k].row);
  std::ranges::sort(order);
  std::vector<PlaceWords> all;
  for (const auto& [id, row] : order)
    if (const auto found = words.find(row); found != words.end()) all.push_back(found->second);
  return all;
}

PlacesByKey PlacesOf(const std::vector<MapToSave>& maps, const std::vector<ListPlans>& plans,
                     const std::set<std::int64_t>& of_maps, const WordsByRow& words) {
  PlacesByKey places;
  for (std::size_t i = 0; i < maps.size(); ++i) {
    if (!of_maps.contains(maps[i].row)) continue;
    const std::vector<PlaceWords> all = WordsInOrder(maps[i].map, plans[i].keyframes, words);
    for (std::size_t begin = 0; begin < all.size(); begin += kOfAPlace)
      places[{maps[i].row, static_cast<std::int64_t>(begin / kOfAPlace)}] =
          rows::SharedWords(std::span(all).subspan(begin, std::min(kOfAPlace, all.size() - begin)));
  }
  return places;
}

// Writes those of some maps that are not as they were.
void WritePlaces(SaveContext& context, const std::string& maps, PlacesByKey places) {
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
  if (!old_maps.empty()) {
    const LocalSetting loops(context.connection, "enable_nestloop", "off");
    context.connection.Query(
        "DELETE FROM place WHERE atlas = $1 AND (map, number) IN (SELECT * FROM unnest ($2::bigint[], $3::bigint[]))",
        {context.atlas, std::span<const std::int64_t>(old_maps), std::span<const std::int64_t>(old_numbers)},
        "table place");
  }
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
  WordsByRow words = WriteWords(context, maps, plans, changed);
  std::set<std::int64_t> changed_maps;
  for (std::size_t i = 0; i < maps.size(); ++i)
    if (all_places || !changed.by_map[i].empty()) changed_maps.insert(maps[i].row);
  for (const std::int64_t row : changed.gone) changed_maps.insert(rows::MapOfRow(row));
  if (changed_maps.empty()) return;
  const std::string rows_of_maps = ListOf(changed_maps);
  if (!context.is_new) ReadWords(context, rows_of_maps, words);
  WritePlaces(context, rows_of_maps, PlacesOf(maps, plans, changed_maps, words));
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
