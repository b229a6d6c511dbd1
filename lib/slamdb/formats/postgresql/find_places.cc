// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/postgresql/detail/find_places.h"

#include <cstring>
#include <memory>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/postgresql/detail/schema.h"
#include "slamdb/formats/rows/detail/plan.h"

namespace slamdb::postgresql {
namespace {

using detail::Concat;

constexpr std::int64_t kPlaces = 256;  // most like a picture, that are looked at
constexpr std::size_t kMaps = 64;      // of these, whose keyframes are compared
constexpr std::int64_t kOthers = 64;   // atlases that stand for all
constexpr std::int64_t kOfAMap = 64;   // keyframes of each of their maps

bool HasFewPlaces(Connection& connection, const Partition& partition) {
  return connection.Integer(Concat("SELECT count(*) FROM (SELECT 1 FROM ", partition.Table("place"), " LIMIT ",
                                   kPlaces + 1, ") AS few")) <= kPlaces;
}

std::vector<std::int64_t> RowsOf(Connection& connection, const std::vector<std::string>& names) {
  if (names.empty()) return {};
  return connection
      .Query("SELECT row FROM atlas WHERE name = ANY ($1)", {std::span<const std::string>(names)}, "table atlas")
      .Integers();
}

bool CopyWords(Bytes bytes, rows::PlaceWords& words) {
  if (bytes.size() != sizeof words) return false;
  std::memcpy(words.data(), bytes.data(), bytes.size());
  return true;
}

// Some keyframes of atlases that hashes choose: any, and the same ones each time.
std::vector<rows::PlaceWords> ReadOthers(Connection& connection, const Partition& partition) {
  const std::vector<std::int64_t> chosen =
      connection
          .Query("SELECT row FROM atlas WHERE keyframes > 0 ORDER BY hash, row LIMIT $1", {kOthers}, "table atlas")
          .Integers();
  const std::set<std::int64_t> atlases(chosen.begin(), chosen.end());
  std::vector<rows::PlaceWords> others;
  if (atlases.empty()) return others;
  const LocalSetting reading_all(connection, "enable_seqscan", "off");
  connection.CopyOut(
      Concat("SELECT words FROM ", partition.Table("keyframe_words"), " WHERE atlas IN (", ListOf(atlases),
             ") AND keyframe & 4294967295 < ", kOfAMap, " ORDER BY atlas, keyframe"),
      [&](const Row& row) {
        if (!CopyWords(row.Blob(0), others.emplace_back())) others.pop_back();
      },
      "table keyframe_words");
  return others;
}

// Of the maps in `like`, which are less than all.
std::string OnlyOf(const std::set<MapKey>& like, std::string_view atlas_column, std::string_view map_column) {
  std::set<std::int64_t> atlases, maps;
  for (const auto& [atlas, map] : like) {
    atlases.insert(atlas);
    maps.insert(map);
  }
  return Concat(" AND ", atlas_column, " IN (", ListOf(atlases), ") AND ", map_column, " IN (", ListOf(maps), ")");
}

}  // namespace

PlaceFinder::PlaceFinder(std::span<const std::span<const Descriptor>> pictures, const PlaceOptions& options)
    : options_(options), pictures_(rows::PlaceWordsOf(pictures, options.threads)) {}

// What a place and a picture have in common beside what chance gives, in standard deviations, as PlaceTable weighs it
// for keyframes: without how rare each word is, which SQL could not look up so fast.
std::set<MapKey> PlaceFinder::MapsLikeAny(Connection& connection, const Partition& partition) const {
  const std::string best =
      Concat("SELECT atlas, map FROM ", partition.Table("place"),
             " WHERE shown > 0 AND atlas <> ALL ($3) ORDER BY (bit_count(words & $1) - shown * $2) / sqrt(shown * $2) "
             "DESC, atlas, map, number LIMIT ",
             kPlaces);
  const std::vector<std::int64_t> without = RowsOf(connection, options_.without);
  const LocalSetting parallel(connection, "max_parallel_workers_per_gather", "DEFAULT", "0");  // all rows are looked at
  std::set<MapKey> maps;
  for (const rows::PlaceWords& picture : pictures_) {
    const double share = rows::CountOf(picture) / (8.0 * sizeof picture);
    if (share == 0) continue;
    const Result found = connection.Query(
        best, {Parameter::Bits(std::as_bytes(std::span(picture))), share, std::span<const std::int64_t>(without)},
        "table place");
    std::set<MapKey> of_picture;
    for (std::size_t i = 0; i < found.rows() && of_picture.size() < kMaps; ++i)
      of_picture.emplace(found[i].Integer(0), found[i].Integer(1));
    maps.merge(of_picture);
  }
  return maps;
}

void PlaceFinder::ReadMaps(Connection& connection, const Partition& partition, const std::set<MapKey>* only,
                           Part& part) {
  const auto reading_all =
      only == nullptr ? nullptr : std::make_unique<const LocalSetting>(connection, "enable_seqscan", "off");
  connection.CopyOut(
      Concat("SELECT atlas, map.row, name, id FROM ", partition.Table("map"),
             " JOIN atlas ON atlas.row = map.atlas WHERE until = 2147483647",
             only == nullptr ? "" : OnlyOf(*only, "map.atlas", "map.row"), " ORDER BY atlas, map.row"),
      [&](const Row& row) {
        const MapKey key{row.Integer(0), row.Integer(1)};
        if (only == nullptr || only->contains(key))
          part.maps[key] = {std::string(row.Text(2)), MapId(static_cast<std::uint64_t>(row.Integer(3)))};
      },
      "table map");
  std::map<MapKey, std::map<std::int64_t, std::size_t>> indices;  // of keyframes, by their rows
  connection.CopyOut(
      Concat("SELECT atlas, map, row, id FROM ", partition.Table("keyframe"), " WHERE until = 2147483647",
             only == nullptr ? "" : OnlyOf(*only, "atlas", "map"), " ORDER BY atlas, row"),
      [&](const Row& row) {
        const MapKey key{row.Integer(0), row.Integer(1)};
        if (!part.maps.contains(key)) return;
        std::vector<rows::PlaceKeyframe>& keyframes = part.keyframes[key];
        indices[key][row.Integer(2)] = keyframes.size();
        keyframes.emplace_back().id = static_cast<std::uint64_t>(row.Integer(3));
      },
      "table keyframe");
  connection.CopyOut(
      Concat("SELECT atlas, keyframe, words FROM ", partition.Table("keyframe_words"), " WHERE true",
             only == nullptr ? "" : OnlyOf(*only, "atlas", "keyframe >> 32")),
      [&](const Row& row) {
        const MapKey key{row.Integer(0), rows::MapOfRow(row.Integer(1))};
        const auto of_map = indices.find(key);
        if (of_map == indices.end()) return;
        const auto found = of_map->second.find(row.Integer(1));
        if (found == of_map->second.end()) return;
        rows::PlaceKeyframe& keyframe = part.keyframes[key][found->second];
        keyframe.is_unknown = !CopyWords(row.Blob(2), keyframe.words);
      },
      "table keyframe_words");
}

void PlaceFinder::Read(Connection& connection, const Partition& partition) {
  Part part;
  if (HasFewPlaces(connection, partition)) {
    ReadMaps(connection, partition, nullptr, part);
  } else if (const std::set<MapKey> like = MapsLikeAny(connection, partition); !like.empty()) {
    ReadMaps(connection, partition, &like, part);
    part.others = ReadOthers(connection, partition);
  }
  for (auto& [key, map] : part.maps) {
    const auto number = static_cast<std::int64_t>(maps_.size());
    maps_[number] = std::move(map);
    for (rows::PlaceKeyframe& keyframe : part.keyframes[key]) {
      keyframe.map = number;
      keyframes_.push_back(keyframe);
    }
  }
  others_.insert(others_.end(), part.others.begin(), part.others.end());
}

StoredPlaces PlaceFinder::Find() && {
  return rows::FindPlaces(maps_, std::move(keyframes_), others_, pictures_, options_);
}

}  // namespace slamdb::postgresql
