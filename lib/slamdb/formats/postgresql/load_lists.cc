// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <deque>
#include <optional>
#include <utility>

#include "slamdb/base/detail/task_queue.h"
#include "slamdb/formats/postgresql/detail/big_endian.h"
#include "slamdb/formats/postgresql/detail/loader.h"
#include "slamdb/formats/rows/detail/keyframe_row.h"
#include "slamdb/formats/rows/detail/landmark_row.h"
#include "slamdb/formats/rows/detail/plan.h"
#include "slamdb/formats/rows/detail/point_row.h"

namespace slamdb::postgresql {
namespace {

using detail::Concat;

constexpr std::size_t kRowsAtOnce = 4096;                           // that are asked for by their numbers
constexpr std::size_t kRowsOfPiece = 512, kBytesOfPiece = 1 << 20;  // that a thread decodes at once

// What of a keyframe of the base its row does not have is left out.
void LeaveFeatures(KeyFrame& keyframe) {
  const Features& all = keyframe.features;
  keyframe.features = Features{.count = all.count, .left_count = all.left_count, .right_count = all.right_count};
}
void LeaveFeatures(const MapPoint&) {}
void LeaveFeatures(const Landmark&) {}

}  // namespace

// ---- rows

bool Loader::Decode(const Row& row, Buffers& buffers, Decoded<KeyFrame>& decoded) const {
  const std::int64_t number = row.Integer(0);
  KeyFrame& keyframe = decoded.entity;
  const bool same = At("keyframe", number, [&] { return rows::ReadKeyframe(row, keyframe); });
  if (!selection_.Has(keyframe)) return false;
  auto& ids = buffers.ids;
  auto& weights = buffers.left;
  const auto read = [&](std::size_t column, auto& list) {
    static_assert(sizeof(KeyFrameId) == sizeof(std::int64_t));
    ids.clear();
    row.Integers64(column, ids);
    const auto* begin = reinterpret_cast<const KeyFrameId*>(ids.data());
    list.assign(begin, begin + ids.size());
  };
  read(39, keyframe.children);
  read(42, keyframe.loop_edges);
  read(43, keyframe.merge_edges);
  ids.clear();
  weights.clear();
  row.Integers64(40, ids);
  row.Integers32(41, weights);
  RequireSame("keyframe", number, ids.size() == weights.size());
  for (std::size_t k = 0; k < ids.size(); ++k)
    keyframe.connections.push_back({KeyFrameId(static_cast<std::uint64_t>(ids[k])), weights[k]});
  keyframe.carried = CarriedIn(row, 44, "keyframe", number);
  decoded.row = {number, detail::HashOfRow(keyframe), detail::HashOfLinks(keyframe)};
  RequireSame("keyframe", number, same && decoded.row.hash == row.Integer(2) && decoded.row.details == row.Integer(3));
  return true;
}

bool Loader::Decode(const Row& row, Buffers& buffers, Decoded<MapPoint>& decoded) const {
  const std::int64_t number = row.Integer(0);
  MapPoint& point = decoded.entity;
  const bool same = rows::ReadPoint(row, point, [&] { return Damaged("map_point", number, "blob of wrong length"); });
  if (!selection_.Has(point)) return false;
  auto& [seen_by, left, right] = buffers;
  seen_by.clear();
  left.clear();
  right.clear();
  row.Integers64(24, seen_by);
  row.Integers32(25, left);
  row.Integers32(26, right);
  RequireSame("map_point", number, left.size() == seen_by.size() && right.size() == seen_by.size());
  point.observations.reserve(seen_by.size());
  for (std::size_t k = 0; k < seen_by.size(); ++k)
    point.observations.push_back({KeyFrameId(static_cast<std::uint64_t>(seen_by[k])), left[k], right[k]});
  point.carried = CarriedIn(row, 27, "map_point", number);
  decoded.row = {number, detail::HashOfRow(point), detail::HashOf(point.observations)};
  RequireSame("map_point", number, same && decoded.row.hash == row.Integer(2) && decoded.row.details == row.Integer(3));
  return true;
}

bool Loader::Decode(const Row& row, Buffers&, Decoded<Landmark>& decoded) const {
  const std::int64_t number = row.Integer(0);
  Landmark& landmark = decoded.entity;
  const bool same = At("landmark", number, [&] {
    return rows::ReadLandmark(row, landmark, [&] { return Damaged("landmark", number, "blob of wrong length"); });
  });
  const std::int64_t hash = detail::HashOf(landmark);
  RequireSame("landmark", number, same && hash == row.Integer(2));
  decoded.row = {number, hash, hash};
  return !selection_.box || selection_.box->contains(landmark.mean.cast<float>());
}

void Loader::Append(Decoded<KeyFrame>&& decoded) {
  detail::AtlasHashes::OfMap& hashes = hashes_.maps[decoded.map];
  hashes.keyframes.push_back(decoded.row.hash);
  hashes.links.push_back(decoded.row.details);
  maps_[decoded.map].keyframes.push_back(decoded.row.row);
  atlas_.maps[decoded.map].keyframes.push_back(std::move(decoded.entity));
}

void Loader::Append(Decoded<MapPoint>&& decoded) {
  detail::AtlasHashes::OfMap& hashes = hashes_.maps[decoded.map];
  hashes.points.push_back(decoded.row.hash);
  hashes.observations.push_back(decoded.row.details);
  maps_[decoded.map].points.push_back(decoded.row.row);
  atlas_.maps[decoded.map].points.push_back(std::move(decoded.entity));
}

void Loader::Append(Decoded<Landmark>&& decoded) {
  hashes_.maps[decoded.map].landmarks.push_back(decoded.row.hash);
  maps_[decoded.map].landmarks.push_back(decoded.row.row);
  atlas_.maps[decoded.map].landmarks.push_back(std::move(decoded.entity));
}

// ---- all of a list

// Of the maps that are selected.
template <class Entity>
std::vector<Decoded<Entity>> Loader::DecodeAll(const KeptRows& rows) const {
  std::vector<Decoded<Entity>> all;
  all.reserve(rows.size());
  Buffers buffers;
  std::int64_t map = 0;
  std::size_t i = maps_.size();
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Row row = rows[k];
    if (const std::int64_t of = rows::MapOfRow(row.Integer(0)); of != map) {
      map = of;
      i = IndexOf(map);
    }
    if (i == maps_.size()) continue;
    Decoded<Entity>& each = all.emplace_back();
    each.map = i;
    if (!Decode(row, buffers, each)) all.pop_back();
  }
  return all;
}

template <class Entity>
void Loader::LoadAll(std::string_view columns, std::string_view table) {
  std::deque<std::vector<Decoded<Entity>>> pieces;
  CopyReader reader(connection_,
                    Concat("SELECT ", columns, " FROM ", table, " WHERE ", Mine(), OfMap(), " ORDER BY row"),
                    Concat("table ", table));
  detail::TaskQueue queue(options_.threads);
  auto kept = std::make_shared<KeptRows>();
  const auto decode = [&] {
    auto* piece = &pieces.emplace_back();
    queue.Do(
        [this, piece, rows = std::exchange(kept, std::make_shared<KeptRows>())] { *piece = DecodeAll<Entity>(*rows); });
  };
  while (reader.Next()) {
    kept->Keep(reader);
    if (kept->size() == kRowsOfPiece || kept->bytes() >= kBytesOfPiece) decode();
  }
  decode();
  queue.Finish();
  for (auto& piece : pieces)
    for (Decoded<Entity>& each : piece) Append(std::move(each));
}

// ---- what the base does not have

// 24 bytes each, many in one value.
std::vector<HashedRow> Loader::ReadHashes(std::string_view table, std::string_view key, std::string_view details) {
  std::vector<HashedRow> rows;
  connection_.CopyOut(
      Concat("SELECT string_agg(int8send(", key, ") || int8send(hash) || int8send(", details, "), ''::bytea ORDER BY ",
             key, ") FROM ", table, " WHERE ", Mine(), OfMap(key), " GROUP BY ", key, " >> 12 ORDER BY ", key,
             " >> 12"),
      [&](const Row& row) {
        const Bytes bytes = row.Blob(0);
        for (std::size_t at = 0; at + 24 <= bytes.size(); at += 24)
          rows.push_back({BigEndian<std::int64_t>(&bytes[at]), BigEndian<std::int64_t>(&bytes[at + 8]),
                          BigEndian<std::int64_t>(&bytes[at + 16])});
      },
      Concat("table ", table));
  return rows;
}

template <class Entity>
void Loader::LoadMissing(std::string_view columns, std::string_view table, std::string_view details,
                         const ByHash<Entity>& there) {
  const std::vector<HashedRow> rows = ReadHashes(table, "row", details);
  const auto find = [&](const HashedRow& row) { return there.Find(row.hash, row.details); };
  Buffers buffers;
  for (std::size_t begin = 0, end = 0; begin < rows.size(); begin = end) {
    std::vector<std::int64_t> missing;
    for (end = begin; end < rows.size() && missing.size() < kRowsAtOnce; ++end)
      if (find(rows[end]) == nullptr) missing.push_back(rows[end].row);
    std::optional<Result> sent;
    if (!missing.empty())
      sent = connection_.Query(
          Concat("SELECT ", columns, " FROM ", table, " WHERE ", Mine(), " AND row = ANY ($1) ORDER BY row"),
          {std::span<const std::int64_t>(missing)}, Concat("table ", table));
    if (sent && sent->rows() != missing.size()) throw Damaged(table, missing.front(), "rows are missing behind it");
    std::size_t next = 0, i = maps_.size();
    for (std::size_t k = begin; k < end; ++k) {
      if (const std::int64_t map = rows::MapOfRow(rows[k].row); i == maps_.size() || maps_[i].row != map)
        i = IndexOf(map);
      if (i == maps_.size()) throw Damaged(table, rows[k].row, "of no map");
      Decoded<Entity> each{.row = rows[k], .map = i, .entity = {}};
      if (const Entity* entity = find(rows[k])) {
        each.entity = *entity;
        LeaveFeatures(each.entity);
      } else {
        Decode((*sent)[next++], buffers, each);  // all is selected
      }
      Append(std::move(each));
    }
  }
}

void Loader::LoadKeyframes() {
  const std::string columns =
      Concat(rows::kKeyframeColumns, ", children, connections, weights, loop_edges, merge_edges, carried");
  if (base_ == nullptr)
    LoadAll<KeyFrame>(columns, "keyframe");
  else
    LoadMissing(columns, "keyframe", "links_hash", base_->keyframes);
  for (std::size_t i = 0; i < maps_.size(); ++i) hashes_.maps[i].features.resize(maps_[i].keyframes.size());
}

void Loader::LoadPoints() {
  const std::string columns = Concat(rows::kPointColumns, ", ", rows::kPointTrackingColumns,
                                     ", seen_by, left_keypoints, right_keypoints, carried");
  if (base_ == nullptr)
    LoadAll<MapPoint>(columns, "map_point");
  else
    LoadMissing(columns, "map_point", "observations_hash", base_->points);
}

void Loader::LoadLandmarks() {
  if (base_ == nullptr)
    LoadAll<Landmark>(rows::kLandmarkColumns, "landmark");
  else
    LoadMissing(rows::kLandmarkColumns, "landmark", "hash", base_->landmarks);
}

}  // namespace slamdb::postgresql
