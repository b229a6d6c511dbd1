// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <optional>
#include <span>
#include <unordered_map>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/postgresql/detail/save.h"
#include "slamdb/formats/rows/detail/landmark_row.h"

namespace slamdb::postgresql {
namespace {

using detail::Concat;
using rows::ListPlan;
using rows::StoredRow;
using rows::Value;

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

// ---- landmarks

void SaveLandmarks(SaveContext& context, const std::vector<MapToSave>& maps, const std::vector<ListPlans>& plans) {
  ListPlaces changed;
  std::vector<std::int64_t> ended;
  for (std::size_t i = 0; i < maps.size(); ++i) {
    const ListPlan& plan = plans[i].landmarks;
    for (std::size_t k = 0; k < plan.entries.size(); ++k) {
      const ListPlan::Entry& entry = plan.entries[k];
      const StoredRow* old = entry.stored;
      const bool same = rows::HasRow(entry, maps[i].hashes.landmarks[k]);
      rows::Count(context.changes["landmark"], same, old == nullptr);
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
  const std::string newest = InNewest(context.atlas);
  context.connection.CopyOut(
      Concat("SELECT row, id, unique_id IS NOT NULL, hash, links_hash, timestamp FROM keyframe WHERE ", newest,
             " ORDER BY row"),
      [&](const Row& row) {
        const std::optional<std::size_t> i = by_map.Of(row.Integer(0));
        if (!i) return;
        lists[*i].keyframes.push_back(ReadStored(row));
        lists[*i].features.push_back({.timestamp = row.Real(5)});
      },
      "table keyframe");
  context.connection.CopyOut(
      Concat("SELECT keyframe, hash, source_hash FROM keyframe_features WHERE ", newest),
      [&](const Row& row) {
        const std::optional<std::size_t> i = by_map.Of(row.Integer(0));
        if (!i) return;
        const auto found = std::ranges::lower_bound(lists[*i].keyframes, row.Integer(0), {}, &StoredRow::row);
        if (found == lists[*i].keyframes.end() || found->row != row.Integer(0)) return;
        StoredFeatures& features = lists[*i].features[static_cast<std::size_t>(found - lists[*i].keyframes.begin())];
        features.hash = row.Integer(1);
        features.source_hash = row.Integer(2);
      },
      "table keyframe_features");
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

std::optional<Result> EndRows(SaveContext& context, std::string_view table, const std::vector<std::int64_t>& rows,
                              std::string_view returning) {
  if (rows.empty()) return std::nullopt;
  const auto versioned = std::ranges::find(VersionedTables(), table, &Versioned::table);
  Result ended =
      context.connection.Query(Concat("UPDATE ", table, " SET until = $2 WHERE atlas = $1 AND until = 2147483647 AND ",
                                      versioned->key, " = ANY ($3)", returning.empty() ? "" : " RETURNING ", returning),
                               {context.atlas, context.revision, std::span(rows)}, Concat("table ", table));
  // Features of a keyframe may be missing, which is why it gets new ones.
  if (table != "keyframe_features")
    RequireTaken(context.connection, table, ended.changed(), static_cast<std::int64_t>(rows.size()));
  return ended;
}

namespace {

std::vector<ListPlans> PlansOf(const std::vector<MapToSave>& maps) {
  std::vector<ListPlans> plans;
  for (const auto& [row, map, hashes, stored] : maps)
    plans.push_back({rows::PlanOf(map.keyframes, stored.keyframes, row), rows::PlanOf(map.points, stored.points, row),
                     rows::PlanOf(map.landmarks, stored.landmarks, row)});
  return plans;
}

}  // namespace

std::vector<ListPlans> SaveLists(SaveContext& context, const std::vector<MapToSave>& maps) {
  std::vector<ListPlans> plans = PlansOf(maps);
  SaveKeyframes(context, maps, plans);
  SaveWords(context, maps, plans);
  SavePoints(context, maps, plans);
  SaveLandmarks(context, maps, plans);
  return plans;
}

void SaveWords(SaveContext& context, const std::vector<MapToSave>& maps) {
  SaveWords(context, maps, PlansOf(maps), true);
}

}  // namespace slamdb::postgresql
