// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <optional>
#include <unordered_map>

#include "slamdb/formats/postgresql/detail/save.h"
#include "slamdb/formats/rows/detail/keyframe_row.h"
#include "slamdb/model/detail/record.h"

namespace slamdb::postgresql {

using rows::ListPlan;
using rows::StoredRow;
using rows::ToColumn;

namespace {

struct KeyframePlaces {
  ListPlaces rows, features;
  std::vector<std::int64_t> ended_rows, ended_features;
};

KeyframePlaces FindChanged(SaveContext& context, const std::vector<MapToSave>& maps,
                           const std::vector<ListPlans>& plans) {
  KeyframePlaces places;
  TableChanges &changes = context.changes["keyframe"], &of_features = context.changes["keyframe_features"];
  for (std::size_t i = 0; i < maps.size(); ++i) {
    const auto& [row, map, hashes, stored] = maps[i];
    const ListPlan& plan = plans[i].keyframes;
    for (std::size_t k = 0; k < plan.entries.size(); ++k) {
      const ListPlan::Entry& entry = plan.entries[k];
      const StoredRow* old = entry.stored;
      const bool same = rows::HasRow(entry, hashes.keyframes[k]) && rows::HasDetails(entry, hashes.links[k]);
      const StoredFeatures* features =
          old == nullptr ? nullptr : &stored.features[static_cast<std::size_t>(old - stored.keyframes.data())];
      const bool same_features = features != nullptr && features->hash == hashes.features[k] &&
                                 (same || features->source_hash == SourceHashOf(map.keyframes[k]));
      rows::Count(changes, same, old == nullptr);
      rows::Count(of_features, same_features, old == nullptr);
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

// Ends them, and counts those that have another pose now.
void EndKeyframes(SaveContext& context, const std::vector<MapToSave>& maps, const std::vector<ListPlans>& plans,
                  const KeyframePlaces& places) {
  const std::optional<Result> ended =
      EndRows(context, "keyframe", places.ended_rows, "row, qw, qx, qy, qz, tx, ty, tz");
  if (!ended) return;
  std::unordered_map<std::int64_t, const KeyFrame*> by_row;
  for (const auto& [i, k] : places.rows) by_row[plans[i].keyframes.entries[k].row] = &maps[i].map.keyframes[k];
  for (std::size_t r = 0; r < ended->rows(); ++r) {
    const Row row = (*ended)[r];
    const auto keyframe = by_row.find(row.Integer(0));
    if (keyframe == by_row.end()) continue;                                  // it is gone
    const detail::KeyframeReals reals = detail::RealsOf(*keyframe->second);  // the pose is in front
    for (std::size_t c = 0; c < 7; ++c) {
      const auto stored = static_cast<float>(row.Real(1 + c));
      if (stored == reals[c] || (std::isnan(stored) && std::isnan(reals[c]))) continue;
      ++context.map.keyframes_moved;
      break;
    }
  }
}

void WriteKeyframes(SaveContext& context, const std::vector<MapToSave>& maps, const std::vector<ListPlans>& plans,
                    const ListPlaces& changed) {
  if (changed.empty()) return;
  CopyIn copy(context.connection, KeyframeTable().target, KeyframeTable().types, context.way());
  rows::KeyframeRow columns;
  CarriedColumn carried;
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
    copy.Put(carried.Of(keyframe.carried));
    copy.Put(context.revision);
    copy.End();
  }
  copy.Finish();
}

}  // namespace

void SaveKeyframes(SaveContext& context, const std::vector<MapToSave>& maps, const std::vector<ListPlans>& plans) {
  const KeyframePlaces places = FindChanged(context, maps, plans);
  EndKeyframes(context, maps, plans, places);
  EndRows(context, "keyframe_features", places.ended_features);
  WriteKeyframes(context, maps, plans, places.rows);
  WriteFeatures(context, maps, plans, places.features);
}

}  // namespace slamdb::postgresql
