// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/postgresql/detail/load.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/postgresql/detail/base_atlas.h"
#include "slamdb/formats/postgresql/detail/loader.h"
#include "slamdb/formats/postgresql/detail/partition.h"
#include "slamdb/formats/postgresql/detail/schema.h"
#include "slamdb/formats/rows/detail/map_rows.h"
#include "slamdb/formats/rows/detail/plan.h"
#include "slamdb/model/detail/record.h"

namespace slamdb::postgresql {

using detail::Concat;

Loader::Loader(Connection& connection, const Named& named, const ReadOptions& options, const BaseAtlas* base)
    : connection_(connection),
      options_(options),
      selection_(options.selection),
      named_(named),
      is_remote_(PartitionOf(connection, named.atlas).is_remote),
      base_(base) {}

Atlas Loader::Run() {
  LoadHeader();
  LoadCameras();
  LoadMaps();
  LoadRepeated();
  LoadKeyframes();
  const bool in_batches = base_ != nullptr || is_remote_ || selection_.has_keyframe_range();
  if (options_.features != FeatureColumns::kNone) in_batches ? LoadFeaturesInBatches() : LoadFeatures();
  LoadPoints();
  LoadLandmarks();
  SortLists();
  if (selection_.everything() && options_.features != FeatureColumns::kNone) CheckHash();
  return std::move(atlas_);
}

std::string Loader::Mine() const {
  return named_.is_newest() && !is_remote_ ? InNewest(named_.atlas) : InRevision(named_.atlas, named_.number);
}

std::string Loader::OfMap(std::string_view row) const {
  if (!selection_.map || maps_.size() != 1) return {};
  return Concat(" AND ", row, " BETWEEN ", rows::FirstRowOfMap(maps_[0].row), " AND ",
                rows::LastRowOfMap(maps_[0].row));
}

std::size_t Loader::IndexOf(std::int64_t map) const {
  return static_cast<std::size_t>(std::ranges::find(maps_, map, &MapRows::row) - maps_.begin());
}

Error Loader::Damaged(std::string_view table, std::int64_t row, const std::string& problem) const {
  return Error(ErrorKind::kDamaged, connection_.path(), Concat("table ", table, ", row ", row),
               problem.empty() ? "differs from its hash: the store is damaged, or was edited by another program"
                               : problem + ": the store is damaged");
}

Boxed<Carried> Loader::CarriedIn(const Row& row, std::size_t column, std::string_view table,
                                 std::int64_t number) const {
  if (row.IsNull(column)) return {};
  return At(table, number, [&] { return detail::DecodeCarried(row.Blob(column)); });
}

void Loader::LoadHeader() {
  const Result found = connection_.Query(
      Concat("SELECT ", rows::kHeaderColumns, ", carried, hash FROM revision WHERE atlas = $1 AND number = $2"),
      {named_.atlas, named_.number}, "table revision");
  if (found.rows() == 0) throw Damaged("revision", named_.number, "missing");
  rows::ReadHeader(found[0], atlas_);
  atlas_.carried = CarriedIn(found[0], 13, "revision", named_.number);
  hash_ = found[0].Integer(14);
}

void Loader::LoadCameras() {
  const Result found = connection_.Query(
      Concat("SELECT ", rows::kCameraColumns, ", carried, hash FROM camera WHERE ", Mine(), " ORDER BY position"), {},
      "table camera");
  for (std::size_t i = 0; i < found.rows(); ++i) {
    const Row row = found[i];
    const auto number = static_cast<std::int64_t>(i);
    atlas_.cameras.push_back(At("camera", number, [&] { return rows::ReadCamera(row); }));
    atlas_.cameras.back().carried = CarriedIn(row, 6, "camera", number);
    RequireSame("camera", number, detail::HashOf(atlas_.cameras.back()) == row.Integer(7));
  }
}

void Loader::LoadMaps() {
  const Result found =
      connection_.Query(Concat("SELECT ", rows::kMapColumns,
                               ", row, origins, keyframe_order, point_order, landmark_order, carried FROM "
                               "map WHERE ",
                               Mine(), " ORDER BY position"),
                        {}, "table map");
  for (std::size_t i = 0; i < found.rows(); ++i) {
    const Row row = found[i];
    const std::int64_t number = row.Integer(11);
    if (number < 1 || number > 0x7fffffff) throw Damaged("map", number, "no row number of a map");
    Map map = rows::ReadMap(row);
    if (selection_.map && *selection_.map != map.id) continue;
    std::vector<std::int64_t> origins;
    row.Integers64(12, origins);
    for (const std::int64_t id : origins) map.origins.push_back(KeyFrameId(static_cast<std::uint64_t>(id)));
    map.carried = CarriedIn(row, 16, "map", number);
    stored_header_hashes_.push_back(row.Integer(10));
    const auto order = [&](std::size_t column) {
      return row.IsNull(column) ? rows::ListOrder()
                                : At("map", number, [&] { return rows::ListOrder(row.Blob(column)); });
    };
    maps_.push_back({number, {}, {}, {}, order(13), order(14), order(15)});
    atlas_.maps.push_back(std::move(map));
  }
  hashes_.maps.resize(maps_.size());
}

void Loader::LoadRepeated() {
  const Result found =
      connection_.Query(Concat("SELECT position, owner_map, entry, list, map FROM repeated_entry WHERE ", Mine(),
                               " ORDER BY list, map, sequence"),
                        {}, "table repeated_entry");
  for (std::size_t i = 0; i < found.rows(); ++i) {
    const Row row = found[i];
    if (auto* list = ListNamed(row.Text(3), row.Integer(4))) list->push_back(rows::ReadRepeated(row));
  }
  for (std::size_t i = 0; i < maps_.size(); ++i)
    RequireSame("map", maps_[i].row, detail::HashOfHeader(atlas_.maps[i]) == stored_header_hashes_[i]);
  if (selection_.everything()) return;
  // Their positions and rows mean those of the whole lists.
  atlas_.repeated_maps.clear();
  atlas_.repeated_cameras.clear();
  for (Map& map : atlas_.maps) {
    map.repeated_keyframes.clear();
    map.repeated_points.clear();
  }
}
std::vector<RepeatedEntry>* Loader::ListNamed(std::string_view list, std::int64_t map) {
  if (list == "maps") return &atlas_.repeated_maps;
  if (list == "cameras") return &atlas_.repeated_cameras;
  const std::size_t i = IndexOf(map);
  if (i == maps_.size()) return nullptr;
  return list == "points" ? &atlas_.maps[i].repeated_points : &atlas_.maps[i].repeated_keyframes;
}
// Brings what came in the order of rows into that of the lists.
void Loader::SortLists() {
  for (std::size_t i = 0; i < maps_.size(); ++i) {
    detail::AtlasHashes::OfMap& of = hashes_.maps[i];
    Map& map = atlas_.maps[i];
    const MapRows& rows = maps_[i];
    At("map", rows.row, [&] {
      rows.keyframe_order.Sort(rows.keyframes, map.keyframes, of.keyframes, of.links, of.features);
      rows.point_order.Sort(rows.points, map.points, of.points, of.observations);
      rows.landmark_order.Sort(rows.landmarks, map.landmarks, of.landmarks);
    });
  }
}

// Where all was read, it has the hash that is stored.
void Loader::CheckHash() {
  hashes_.header = detail::HashOfAtlasHeader(atlas_, atlas_.encoding);
  for (const Camera& camera : atlas_.cameras) hashes_.cameras.push_back(detail::HashOf(camera));
  for (std::size_t i = 0; i < atlas_.maps.size(); ++i) hashes_.maps[i].header = detail::HashOfHeader(atlas_.maps[i]);
  RequireSame("revision", named_.number, hashes_.Combined() == hash_);
}

Atlas LoadAtlas(Connection& connection, const Named& named, const ReadOptions& options) {
  return Loader(connection, named, options).Run();
}

Atlas LoadOnto(Connection& connection, const Named& named, const Atlas& base, const ReadOptions& options) {
  const ReadOptions whole{.threads = options.threads, .progress = options.progress};
  if (base.maps.empty()) return LoadAtlas(connection, named, whole);
  const BaseAtlas at_hand(base, options.threads);
  return Loader(connection, named, whole, &at_hand).Run();
}

}  // namespace slamdb::postgresql
