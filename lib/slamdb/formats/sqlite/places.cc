// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/places.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <numeric>

#include "slamdb/formats/rows/detail/place_table.h"

namespace slamdb::sqlite {
namespace {

using rows::PlaceKeyframe;
using rows::PlaceMap;

std::map<std::int64_t, PlaceMap> ReadMaps(Database& database) {
  Statement statement(database, "SELECT map.row, name, id FROM map JOIN atlas ON atlas.row = map.atlas", "table map");
  std::map<std::int64_t, PlaceMap> maps;
  while (statement.Step())
    maps[statement.Integer(0)] = {statement.Text(1), MapId(static_cast<std::uint64_t>(statement.Integer(2)))};
  return maps;
}

// By row.
std::vector<PlaceKeyframe> ReadKeyframes(Database& database) {
  Statement ids(database, "SELECT map, row, id FROM keyframe", "table keyframe");  // from keyframe_by_id alone
  std::vector<PlaceKeyframe> keyframes;
  std::vector<std::int64_t> rows;
  while (ids.Step()) {
    keyframes.push_back({.map = ids.Integer(0), .id = static_cast<std::uint64_t>(ids.Integer(2))});
    rows.push_back(ids.Integer(1));
  }
  std::vector<std::size_t> by_row(keyframes.size());
  std::iota(by_row.begin(), by_row.end(), std::size_t{0});
  std::ranges::sort(by_row, {}, [&rows](std::size_t i) { return rows[i]; });
  Statement words(database, "SELECT keyframe, words FROM keyframe_words ORDER BY keyframe", "table keyframe_words");
  auto at = by_row.begin();
  while (words.Step()) {
    while (at != by_row.end() && rows[*at] < words.Integer(0)) ++at;
    const Bytes bytes = words.Blob(1);
    if (at == by_row.end() || rows[*at] != words.Integer(0) || bytes.size() != sizeof(rows::PlaceWords)) continue;
    PlaceKeyframe& keyframe = keyframes[*at++];
    std::memcpy(keyframe.words.data(), bytes.data(), bytes.size());
    keyframe.is_unknown = false;
  }
  return keyframes;
}

}  // namespace

StoredPlaces FindPlaces(Database& database, std::span<const std::span<const Descriptor>> pictures,
                        const PlaceOptions& options) {
  return rows::FindPlaces(ReadMaps(database), ReadKeyframes(database), {},
                          rows::PlaceWordsOf(pictures, options.threads), options);
}

}  // namespace slamdb::sqlite
