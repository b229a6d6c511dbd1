// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <tuple>
#include <unordered_map>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/hash.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/base/detail/pipeline.h"
#include "slamdb/formats/postgresql/detail/save.h"
#include "slamdb/formats/rows/detail/features_blob.h"
#include "slamdb/formats/rows/detail/keyframe_row.h"
#include "slamdb/formats/rows/detail/landmark_row.h"
#include "slamdb/formats/rows/detail/point_row.h"
#include "slamdb/model/detail/record.h"

namespace slamdb::postgresql {
namespace {

using detail::Concat;
using rows::ListPlan;
using rows::StoredRow;
using rows::ToColumn;

constexpr std::size_t kReportEvery = 4096;

// Which list of which map a row belongs to.
class ByMap {
 public:
  explicit ByMap(const std::vector<std::int64_t>& maps) {
    for (std::size_t i = 0; i < maps.size(); ++i) index_[maps[i]] = i;
  }
  // Nothing for rows of no map, as of a store that was edited.
  std::optional<std::size_t> Of(std::int64_t row) const {
    const auto found = index_.find(rows::MapOfRow(row));
    return found == index_.end() ? std::nullopt : std::optional(found->second);
  }

 private:
  std::unordered_map<std::int64_t, std::size_t> index_;
};

StoredRow ReadStored(const Row& row) {
  return {row.Integer(0), row.Integer(1), row.Integer(2) != 0, row.Integer(3), row.Integer(4)};
}

template <class Entities>
ListPlan PlanOf(const Entities& entities, const std::vector<StoredRow>& stored, std::int64_t map) {
  std::vector<std::int64_t> ids;
  ids.reserve(entities.size());
  for (const auto& entity : entities) ids.push_back(ToColumn(entity.id));
  return rows::PlanList(ids, stored, rows::FirstRowOfMap(map));
}

// What of the features' packed columns follows from elsewhere (features_blob.h): image bounds and the kind of camera.
std::int64_t SourceHashOf(const KeyFrame& keyframe) {
  detail::ByteWriter out;
  const ImageBounds& bounds = keyframe.bounds;
  static_assert(std::is_trivially_copyable_v<ImageBounds>);
  out.PutBytes(std::as_bytes(std::span(&bounds, 1)));
  out.Put(static_cast<std::uint8_t>(keyframe.features.is_fisheye_stereo()));
  return static_cast<std::int64_t>(detail::HashBytes(out.bytes()));
}

// A NaN is NULL in a column, as in every store; `exact` of the row has it.
template <class Columns>
void PutColumns(CopyIn& copy, const Columns& columns) {
  for (const Value& value : columns) {
    const auto* real = std::get_if<double>(&value);
    real != nullptr&& std::isnan(*real) ? copy.PutNull() : copy.Put(value);
  }
}

void PutCarried(CopyIn& copy, const Boxed<Carried>& carried, detail::ByteWriter& bytes) {
  if (!carried) return copy.PutNull();
  bytes.Clear();
  detail::EncodeCarried(carried, bytes);
  copy.Put(bytes.bytes());
}

// Which entries of a list a save writes: (index of the map, index in the list).
using Places = std::vector<std::pair<std::size_t, std::size_t>>;

void Count(SaveContext& context, const char* table, bool same, bool is_new) {
  TableChanges& changes = context.changes[table];
  ++(same ? changes.unchanged : is_new ? changes.inserted : changes.updated);
}

// ---- keyframes

struct KeyframePlaces {
  Places rows, features;
  std::vector<std::int64_t> ended_rows, ended_features;
};

KeyframePlaces FindChanged(SaveContext& context, const std::vector<MapToSave>& maps,
                           const std::vector<ListPlans>& plans) {
  KeyframePlaces places;
  for (std::size_t i = 0; i < maps.size(); ++i) {
    const auto& [row, map, hashes, stored] = maps[i];
    const ListPlan& plan = plans[i].keyframes;
    for (std::size_t k = 0; k < plan.entries.size(); ++k) {
      const ListPlan::Entry& entry = plan.entries[k];
      const StoredRow* old = entry.stored;
      const bool same = old != nullptr && old->hash == hashes.keyframes[k] && old->unique == entry.unique &&
                        old->details == hashes.links[k];
      const StoredFeatures* features =
          old == nullptr ? nullptr : &stored.features[static_cast<std::size_t>(old - stored.keyframes.data())];
      const bool same_features = features != nullptr && features->hash == hashes.features[k] &&
                                 (same || features->source_hash == SourceHashOf(map.keyframes[k]));
      Count(context, "keyframe", same, old == nullptr);
      Count(context, "keyframe_features", same_features, old == nullptr);
      if (!same) places.rows.emplace_back(i, k);
      if (!same_features) places.features.emplace_back(i, k);
      if (old == nullptr)
        ++context.map.keyframes_added;
      else if (!same)
        places.ended_rows.push_back(entry.row);
      if (old != nullptr && !same_features) places.ended_features.push_back(entry.row);
    }
    context.map.keyframes_removed += plan.removed.size();
    for (const char* table : {"keyframe", "keyframe_features"}) context.changes[table].deleted += plan.removed.size();
    for (auto* ended : {&places.ended_rows, &places.ended_features})
      ended->insert(ended->end(), plan.removed.begin(), plan.removed.end());
  }
  return places;
}

// Counts the keyframes that have another pose than before.
void CountMoved(SaveContext& context, const std::vector<MapToSave>& maps, const std::vector<ListPlans>& plans,
                const Places& changed) {
  std::unordered_map<std::int64_t, const KeyFrame*> by_row;
  for (const auto& [i, k] : changed)
    if (const ListPlan::Entry& entry = plans[i].keyframes.entries[k]; entry.stored != nullptr)
      by_row[entry.row] = &maps[i].map.keyframes[k];
  if (by_row.empty()) return;
  std::vector<std::int64_t> asked;
  for (const auto& [row, keyframe] : by_row) asked.push_back(row);
  const Result found = context.connection.Query(
      "SELECT row, qw, qx, qy, qz, tx, ty, tz FROM keyframe WHERE atlas = $1 AND until = 2147483647 AND row = ANY ($2)",
      {context.atlas, std::span<const std::int64_t>(asked)}, "table keyframe");
  for (std::size_t r = 0; r < found.rows(); ++r) {
    const detail::KeyframeReals reals = detail::RealsOf(*by_row[found[r].Integer(0)]);  // the pose is in front
    for (std::size_t c = 0; c < 7; ++c) {
      const auto stored = static_cast<float>(found[r].Real(1 + c));
      if (stored == reals[c] || (std::isnan(stored) && std::isnan(reals[c]))) continue;
      ++context.map.keyframes_moved;
      break;
    }
  }
}

void WriteKeyframes(SaveContext& context, const std::vector<MapToSave>& maps, const std::vector<ListPlans>& plans,
                    const Places& changed) {
  if (changed.empty()) return;
  CopyIn copy(context.connection, KeyframeTable().target, KeyframeTable().types, context.way());
  rows::KeyframeRow columns;
  detail::ByteWriter carried;
  std::vector<std::int64_t> ids;
  std::vector<std::int32_t> weights;
  const auto put_ids = [&](const Column<KeyFrameId>& list) {
    ids.clear();
    for (const KeyFrameId id : list) ids.push_back(ToColumn(id));
    copy.Put(std::span<const std::int64_t>(ids));
  };
  for (const auto& [i, k] : changed) {
    const KeyFrame& keyframe = maps[i].map.keyframes[k];
    const ListPlan::Entry& entry = plans[i].keyframes.entries[k];
    copy.Begin();
    PutColumns(copy, columns.Of({entry.row, maps[i].row, context.atlas, entry.unique, maps[i].hashes.keyframes[k],
                                 maps[i].hashes.links[k]},
                                keyframe));
    put_ids(keyframe.children);
    ids.clear();
    weights.clear();
    for (const slamdb::Connection& connection : keyframe.connections) {
      ids.push_back(ToColumn(connection.keyframe));
      weights.push_back(connection.weight);
    }
    copy.Put(std::span<const std::int64_t>(ids));
    copy.Put(std::span<const std::int32_t>(weights));
    put_ids(keyframe.loop_edges);
    put_ids(keyframe.merge_edges);
    PutCarried(copy, keyframe.carried, carried);
    copy.Put(context.revision);
    copy.End();
  }
  copy.Finish();
}

// ---- features: packed on all threads, sent by this one

std::set<Uuid> StoredPictures(SaveContext& context) {
  std::set<Uuid> pictures;
  if (context.is_new || context.rewrites) return pictures;
  context.connection.CopyOut(
      Concat("SELECT hash FROM picture WHERE atlas = ", context.atlas),
      [&](const Row& row) {
        Uuid hash;
        std::ranges::copy(row.Blob(0).first(hash.size()), hash.begin());
        pictures.insert(hash);
      },
      "table picture");
  return pictures;
}

Uuid HashOfPicture(const KeyFrame& keyframe) {
  detail::ByteWriter out;
  rows::EncodePicture(keyframe, out);
  return detail::Hash128(out.bytes());
}

// Removes those that are written anew.
void RemovePictures(SaveContext& context, const std::vector<MapToSave>& maps, const Places& changed) {
  std::vector<Uuid> hashes(changed.size());
  detail::ParallelFor(changed.size(), 8, context.options.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n)
      hashes[n] = HashOfPicture(maps[changed[n].first].map.keyframes[changed[n].second]);
  });
  context.connection.Query("DELETE FROM picture WHERE atlas = $1 AND hash = ANY ($2)",
                           {context.atlas, std::span<const Uuid>(hashes)}, "table picture");
}

// Those that the atlas does not have yet; the hash of each that it comes to have.
std::vector<Uuid> WritePictures(SaveContext& context, const std::vector<MapToSave>& maps, const Places& changed) {
  std::vector<Uuid> hashes(changed.size());
  std::set<Uuid> stored = StoredPictures(context);
  // Those of earlier revisions that are not what their hash says, too, are as they were again where this one has them.
  if (context.rewrites) RemovePictures(context, maps, changed);
  CopyIn copy(context.connection, PictureTable().target, PictureTable().types, context.way());
  const auto pack = [&](std::size_t n, std::string& bytes) {
    detail::ByteWriter out(std::move(bytes));
    rows::EncodePicture(maps[changed[n].first].map.keyframes[changed[n].second], out);
    hashes[n] = detail::Hash128(out.bytes());
    bytes = out.Take();
  };
  const auto write = [&](std::size_t n, const std::string& bytes) {
    context.Report(100);
    if (!stored.insert(hashes[n]).second) return;
    copy.Begin();
    copy.Put(context.atlas);
    copy.Put(Bytes(hashes[n]));
    copy.Put(std::as_bytes(std::span(bytes)));
    copy.End();
  };
  detail::ProduceInOrder<std::string>(changed.size(), context.options.threads, pack, write);
  copy.Finish();
  return hashes;
}

void WriteFeatures(SaveContext& context, const std::vector<MapToSave>& maps, const std::vector<ListPlans>& plans,
                   const Places& changed) {
  if (changed.empty()) return;
  const std::vector<Uuid> pictures = WritePictures(context, maps, changed);
  CopyIn copy(context.connection, FeaturesTable().target, FeaturesTable().types, context.way());
  detail::ByteWriter points;
  for (std::size_t n = 0; n < changed.size(); ++n) {
    const auto& [i, k] = changed[n];
    const KeyFrame& keyframe = maps[i].map.keyframes[k];
    points.Clear();
    rows::EncodePoints(keyframe, points);
    copy.Add(std::array<Value, 7>{context.atlas, plans[i].keyframes.entries[k].row, maps[i].hashes.features[k],
                                  SourceHashOf(keyframe), points.bytes(), Bytes(pictures[n]), context.revision});
  }
  copy.Finish();
}

void SaveKeyframes(SaveContext& context, const std::vector<MapToSave>& maps, const std::vector<ListPlans>& plans) {
  const KeyframePlaces places = FindChanged(context, maps, plans);
  CountMoved(context, maps, plans, places.rows);
  EndRows(context, "keyframe", places.ended_rows);
  EndRows(context, "keyframe_features", places.ended_features);
  WriteKeyframes(context, maps, plans, places.rows);
  WriteFeatures(context, maps, plans, places.features);
  SaveWords(context, maps, plans);
}

// ---- points

using SeenKey = std::tuple<std::int64_t, std::int32_t, std::int32_t>;  // keyframe, left and right keypoint

std::vector<SeenKey> KeysOf(const Column<Observation>& observations) {
  std::vector<SeenKey> keys;
  for (const Observation& each : observations) keys.emplace_back(ToColumn(each.keyframe), each.left, each.right);
  std::ranges::sort(keys);
  return keys;
}

std::vector<SeenKey> StoredKeys(const Row& row, std::size_t column) {
  std::vector<std::int64_t> seen_by;
  std::vector<std::int32_t> left, right;
  row.Integers64(column, seen_by);
  row.Integers32(column + 1, left);
  row.Integers32(column + 2, right);
  std::vector<SeenKey> keys;
  for (std::size_t i = 0; i < std::min({seen_by.size(), left.size(), right.size()}); ++i)
    keys.emplace_back(seen_by[i], left[i], right[i]);
  std::ranges::sort(keys);
  return keys;
}

// Counts what became of points that were there before, and of observations.
void CountPointChanges(SaveContext& context, const std::vector<MapToSave>& maps, const std::vector<ListPlans>& plans,
                       const Places& changed, const std::vector<std::int64_t>& ended) {
  std::unordered_map<std::int64_t, const MapPoint*> by_row;
  for (const auto& [i, k] : changed) {
    const ListPlan::Entry& entry = plans[i].points.entries[k];
    const MapPoint& point = maps[i].map.points[k];
    if (entry.stored != nullptr)
      by_row[entry.row] = &point;
    else
      context.map.observations_added += point.observations.size();
  }
  if (ended.empty()) return;
  const Result found = context.connection.Query(
      "SELECT row, x, y, z, seen_by, left_keypoints, right_keypoints FROM map_point WHERE atlas = $1 AND until = "
      "2147483647 AND row = ANY ($2)",
      {context.atlas, std::span(ended)}, "table map_point");
  for (std::size_t r = 0; r < found.rows(); ++r) {
    const Row row = found[r];
    const std::vector<SeenKey> before = StoredKeys(row, 4);
    const auto point = by_row.find(row.Integer(0));
    if (point == by_row.end()) {  // it is gone
      context.map.observations_removed += before.size();
      continue;
    }
    const std::vector<SeenKey> now = KeysOf(point->second->observations);
    std::vector<SeenKey> both;
    std::ranges::set_intersection(before, now, std::back_inserter(both));
    context.map.observations_added += now.size() - both.size();
    context.map.observations_removed += before.size() - both.size();
    const Eigen::Vector3f& position = point->second->position;
    for (int axis = 0; axis < 3; ++axis) {
      const auto stored = static_cast<float>(row.Real(1 + static_cast<std::size_t>(axis)));
      if (stored == position[axis] || (std::isnan(stored) && std::isnan(position[axis]))) continue;
      ++context.map.points_moved;
      break;
    }
  }
}

void WritePoints(SaveContext& context, const std::vector<MapToSave>& maps, const std::vector<ListPlans>& plans,
                 const Places& changed) {
  if (changed.empty()) return;
  CopyIn copy(context.connection, PointTable().target, PointTable().types, context.way());
  rows::PointRow columns;
  detail::ByteWriter carried;
  std::vector<std::int64_t> seen_by;
  std::vector<std::int32_t> left, right;
  std::size_t done = 0;
  for (const auto& [i, k] : changed) {
    const MapPoint& point = maps[i].map.points[k];
    const ListPlan::Entry& entry = plans[i].points.entries[k];
    for (auto* list : {&left, &right}) list->clear();
    seen_by.clear();
    for (const Observation& each : point.observations) {
      seen_by.push_back(ToColumn(each.keyframe));
      left.push_back(each.left);
      right.push_back(each.right);
    }
    copy.Begin();
    PutColumns(copy, columns.Of({entry.row, maps[i].row, entry.unique, maps[i].hashes.points[k],
                                 maps[i].hashes.observations[k]},
                                point));
    copy.Put(std::span<const std::int64_t>(seen_by));
    copy.Put(std::span<const std::int32_t>(left));
    copy.Put(std::span<const std::int32_t>(right));
    PutCarried(copy, point.carried, carried);
    copy.Put(context.atlas);
    copy.Put(context.revision);
    copy.End();
    if (++done % kReportEvery == 0) context.Report(kReportEvery);
  }
  copy.Finish();
}

void SavePoints(SaveContext& context, const std::vector<MapToSave>& maps, const std::vector<ListPlans>& plans) {
  Places changed;
  std::vector<std::int64_t> ended;
  for (std::size_t i = 0; i < maps.size(); ++i) {
    const ListPlan& plan = plans[i].points;
    const AtlasHashes::OfMap& hashes = maps[i].hashes;
    for (std::size_t k = 0; k < plan.entries.size(); ++k) {
      const ListPlan::Entry& entry = plan.entries[k];
      const StoredRow* old = entry.stored;
      const bool same = old != nullptr && old->hash == hashes.points[k] && old->unique == entry.unique &&
                        old->details == hashes.observations[k];
      Count(context, "map_point", same, old == nullptr);
      if (old == nullptr) ++context.map.points_added;
      if (same) continue;
      changed.emplace_back(i, k);
      if (old != nullptr) ended.push_back(entry.row);
    }
    context.map.points_removed += plan.removed.size();
    context.changes["map_point"].deleted += plan.removed.size();
    ended.insert(ended.end(), plan.removed.begin(), plan.removed.end());
  }
  CountPointChanges(context, maps, plans, changed, ended);
  EndRows(context, "map_point", ended);
  WritePoints(context, maps, plans, changed);
}

// ---- landmarks

void SaveLandmarks(SaveContext& context, const std::vector<MapToSave>& maps, const std::vector<ListPlans>& plans) {
  Places changed;
  std::vector<std::int64_t> ended;
  for (std::size_t i = 0; i < maps.size(); ++i) {
    const ListPlan& plan = plans[i].landmarks;
    for (std::size_t k = 0; k < plan.entries.size(); ++k) {
      const ListPlan::Entry& entry = plan.entries[k];
      const StoredRow* old = entry.stored;
      const bool same = old != nullptr && old->hash == maps[i].hashes.landmarks[k] && old->unique == entry.unique;
      Count(context, "landmark", same, old == nullptr);
      if (same) continue;
      changed.emplace_back(i, k);
      if (old != nullptr) ended.push_back(entry.row);
    }
    if (!plan.removed.empty()) context.changes["landmark"].deleted += plan.removed.size();
    ended.insert(ended.end(), plan.removed.begin(), plan.removed.end());
  }
  EndRows(context, "landmark", ended);
  if (changed.empty()) return;
  CopyIn copy(context.connection, LandmarkTable().target, LandmarkTable().types, context.way());
  rows::LandmarkRow columns;
  for (const auto& [i, k] : changed) {
    const ListPlan::Entry& entry = plans[i].landmarks.entries[k];
    copy.Begin();
    PutColumns(copy, columns.Of({entry.row, maps[i].row, entry.unique, maps[i].hashes.landmarks[k]},
                                maps[i].map.landmarks[k]));
    copy.Put(context.atlas);
    copy.Put(context.revision);
    copy.End();
  }
  copy.Finish();
}

}  // namespace

std::vector<StoredLists> ReadStoredLists(SaveContext& context, const std::vector<std::int64_t>& maps) {
  std::vector<StoredLists> lists(maps.size());
  if (maps.empty()) return lists;
  const ByMap by_map(maps);
  const std::string newest = Concat("atlas = ", context.atlas, " AND until = ", kNewest);
  context.connection.CopyOut(
      Concat("SELECT row, id, unique_id IS NOT NULL, keyframe.hash, links_hash, features.hash, source_hash, timestamp "
             "FROM "
             "keyframe LEFT JOIN keyframe_features AS features ON features.atlas = keyframe.atlas AND "
             "features.keyframe = row AND features.until = ",
             kNewest, " WHERE keyframe.", "atlas = ", context.atlas, " AND keyframe.until = ", kNewest,
             " ORDER BY row"),
      [&](const Row& row) {
        const std::optional<std::size_t> i = by_map.Of(row.Integer(0));
        if (!i) return;
        lists[*i].keyframes.push_back(ReadStored(row));
        lists[*i].features.push_back({row.Integer(5), row.Integer(6), row.Real(7)});
      },
      "table keyframe");
  context.connection.CopyOut(
      Concat("SELECT row, id, unique_id IS NOT NULL, hash, observations_hash FROM map_point WHERE ", newest,
             " ORDER BY row"),
      [&](const Row& row) {
        if (const auto i = by_map.Of(row.Integer(0))) lists[*i].points.push_back(ReadStored(row));
      },
      "table map_point");
  context.connection.CopyOut(
      Concat("SELECT row, id, unique_id IS NOT NULL, hash, hash FROM landmark WHERE ", newest, " ORDER BY row"),
      [&](const Row& row) {
        if (const auto i = by_map.Of(row.Integer(0))) lists[*i].landmarks.push_back(ReadStored(row));
      },
      "table landmark");
  return lists;
}

void EndRows(SaveContext& context, std::string_view table, const std::vector<std::int64_t>& rows) {
  if (rows.empty()) return;
  const auto versioned = std::ranges::find(VersionedTables(), table, &Versioned::table);
  const Result ended =
      context.connection.Query(Concat("UPDATE ", table, " SET until = $2 WHERE atlas = $1 AND until = 2147483647 AND ",
                                      versioned->key, " = ANY ($3)"),
                               {context.atlas, context.revision, std::span(rows)}, Concat("table ", table));
  // Features of a keyframe may be missing, which is why it gets new ones.
  if (table != "keyframe_features")
    RequireTaken(context.connection, table, ended.changed(), static_cast<std::int64_t>(rows.size()));
}

namespace {

std::vector<ListPlans> PlansOf(const std::vector<MapToSave>& maps) {
  std::vector<ListPlans> plans;
  for (const auto& [row, map, hashes, stored] : maps)
    plans.push_back({PlanOf(map.keyframes, stored.keyframes, row), PlanOf(map.points, stored.points, row),
                     PlanOf(map.landmarks, stored.landmarks, row)});
  return plans;
}

}  // namespace

std::vector<ListPlans> SaveLists(SaveContext& context, const std::vector<MapToSave>& maps) {
  std::vector<ListPlans> plans = PlansOf(maps);
  SaveKeyframes(context, maps, plans);
  SavePoints(context, maps, plans);
  SaveLandmarks(context, maps, plans);
  return plans;
}

void SaveWords(SaveContext& context, const std::vector<MapToSave>& maps) {
  SaveWords(context, maps, PlansOf(maps), true);
}

}  // namespace slamdb::postgresql
