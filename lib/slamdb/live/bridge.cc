// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/live/bridge.h"

#include <algorithm>
#include <chrono>

#include "slamdb/base/detail/parallel.h"
#include "slamdb/live/detail/keyframe_record.h"
#include "slamdb/live/detail/link_targets.h"
#include "slamdb/live/detail/map_point_record.h"
#include "slamdb/live/detail/snapshot.h"
#include "slamdb/live/keyframe.h"
#include "slamdb/live/map.h"
#include "slamdb/live/map_point.h"

// Steps of FromModel, map by map: tables id -> row from the records; objects, in parallel; lists; links, in parallel.
namespace slamdb::live {
namespace {

constexpr std::size_t kKeyFrameGrain = 16, kPointGrain = 4096;

using Clock = std::chrono::steady_clock;
double SecondsSince(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

template <class List>
std::uint64_t PastHighestId(const List& list) {
  std::uint64_t past = 0;
  for (const auto& entity : list)
    if (entity.id) past = std::max(past, entity.id.value() + 1);
  return past;
}

// One past the highest id of each kind that is in use.
Counters FloorsOf(const slamdb::Atlas& atlas) {
  Counters floors;
  floors.map = PastHighestId(atlas.maps);
  floors.camera = PastHighestId(atlas.cameras);
  for (const slamdb::Map& map : atlas.maps) {
    floors.keyframe = std::max(floors.keyframe, PastHighestId(map.keyframes));
    floors.map_point = std::max(floors.map_point, PastHighestId(map.points));
  }
  return floors;
}

bool IsFirst(std::uint64_t id, std::size_t row, const IdTable& rows) { return rows.Find(id) == row; }

std::size_t CountObservations(const Column<slamdb::MapPoint>& points, std::size_t first, std::size_t count) {
  std::size_t observations = 0;
  for (std::size_t row = first; row < std::min(points.size(), first + count); ++row)
    observations += points[row].observations.size();
  return observations;
}

// work(row, report) for all rows, in parallel; the reports come together in row order.
template <class Work>
void ForEachRow(std::size_t count, std::size_t grain, int threads, PostLoadReport& report, const Work& work) {
  std::vector<PostLoadReport> reports((count + grain - 1) / grain);
  detail::ParallelFor(count, grain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) work(row, reports[begin / grain]);
  });
  for (const PostLoadReport& block : reports) report.Append(block);
}

}  // namespace

void Bridge::FillMap(Atlas& atlas, slamdb::Map record, int threads, PostLoadReport& report) {
  const Clock::time_point indexing = Clock::now();
  const IdTable keyframe_rows = KeyFrameTable(record), point_rows = PointTable(record);
  report.seconds += SecondsSince(indexing);
  Column<slamdb::KeyFrame> keyframe_records = std::move(record.keyframes);
  const Column<slamdb::MapPoint> point_records = std::move(record.points);
  record.keyframes.clear();
  record.points.clear();
  atlas.maps_.emplace_back(new Map(atlas.runtime_, std::move(record)));
  Map* map = atlas.maps_.back().get();

  std::vector<KeyFrame*> keyframes(keyframe_records.size());
  detail::ParallelFor(keyframes.size(), kKeyFrameGrain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      keyframes[row] = new KeyFrame(std::move(keyframe_records[row]), map);
      keyframes[row]->mpCamera = atlas.FindCamera(keyframes[row]->record_.camera);
      keyframes[row]->mpCamera2 = atlas.FindCamera(keyframes[row]->record_.right_camera);
    }
  });
  std::vector<MapPoint*> points(point_records.size());
  detail::ParallelFor(points.size(), kPointGrain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) points[row] = new MapPoint(point_records[row], map);
  });
  List(*map, map->keyframes_, keyframes);
  List(*map, map->points_, points);
  const Clock::time_point linking = Clock::now();
  LinkMap(atlas, *map, point_records, {keyframe_rows, point_rows, keyframes, points}, threads, report);
  report.seconds += SecondsSince(linking);
}

template <class Objects, class Object>
void Bridge::List(Map& map, Objects& objects, const std::vector<Object*>& all) {
  objects.live.Reserve(all.size());
  for (Object* object : all) {
    objects.live.Add(object);
    map.TakeOver(object);
  }
}

void Bridge::LinkMap(Atlas& atlas, Map& map, const Column<slamdb::MapPoint>& point_records, const LinkTargets& targets,
                     int threads, PostLoadReport& report) {
  ForEachRow(targets.keyframes.size(), kKeyFrameGrain, threads, report, [&](std::size_t row, PostLoadReport& block) {
    KeyFrame& keyframe = *targets.keyframes[row];
    block.bad_keyframes += keyframe.bad_ ? 1 : 0;
    block.duplicate_ids += IsFirst(keyframe.mnId, row, targets.keyframe_rows) ? 0 : 1;
    keyframe.Link(targets, block);
  });
  const std::size_t first_block = atlas.loaded_observers_.size();
  atlas.loaded_observers_.resize(first_block + (targets.points.size() + kPointGrain - 1) / kPointGrain);
  ForEachRow(targets.points.size(), kPointGrain, threads, report, [&](std::size_t row, PostLoadReport& block) {
    Column<Observer>& observers = atlas.loaded_observers_[first_block + row / kPointGrain];
    if (row % kPointGrain == 0) observers.reserve(CountObservations(point_records, row, kPointGrain));
    const slamdb::MapPoint& record = point_records[row];
    block.bad_points += record.bad ? 1 : 0;
    block.duplicate_ids += IsFirst(record.id.value(), row, targets.point_rows) ? 0 : 1;
    targets.points[row]->Link(record, targets, observers, block);
  });
  map.has_unique_ids_ = report.duplicate_ids == 0;
  LinkHeader(map, targets, report);
}

void Bridge::LinkHeader(Map& map, const LinkTargets& targets, PostLoadReport& report) {
  const auto miss = [&](LinkKind kind, KeyFrameId target) {
    report.Add({kind, MapId(map.GetId()), {}, {}, target.value()});
  };
  const auto link = [&](KeyFrameId& id, KeyFrame*& target, LinkKind kind) {
    target = targets.Find(id);
    if (target != nullptr) {
      id = {};
    } else if (!targets.keyframes.empty()) {  // those of empty maps are uninitialised
      miss(kind, id);
    }
  };
  link(map.record_.first_keyframe, map.initial_, LinkKind::kInitialKeyFrame);
  link(map.record_.lowest_keyframe, map.lowest_, LinkKind::kLowestKeyFrame);
  std::vector<KeyFrameId> unresolved;
  for (const KeyFrameId id : map.record_.origins) {
    if (KeyFrame* origin = targets.Find(id); origin != nullptr) {
      map.mvpKeyFrameOrigins.push_back(origin);
    } else {
      unresolved.push_back(id);
      miss(LinkKind::kOrigin, id);
    }
  }
  map.record_.origins = std::move(unresolved);
}

void Bridge::Fill(Atlas& atlas, slamdb::Atlas model, int threads, PostLoadReport& report) {
  const Counters floors = FloorsOf(model);
  std::vector<slamdb::Map> maps = std::move(model.maps);
  for (slamdb::Camera& camera : model.cameras) {
    atlas.cameras_.push_back(std::make_unique<GeometricCamera>(std::move(camera)));
    atlas.cameras_.back()->owner_ = &atlas.runtime_;
  }
  model.maps.clear();
  model.cameras.clear();
  atlas.record_ = std::move(model);
  atlas.lists_as_recorded_ = true;
  for (slamdb::Map& map : maps) FillMap(atlas, std::move(map), threads, report);

  const Counters& next = atlas.record_.next_ids;
  atlas.runtime_.map_ids.Set(next.map, floors.map);
  atlas.runtime_.frame_ids.Set(next.frame, 0);
  atlas.runtime_.keyframe_ids.Set(next.keyframe, std::max(floors.keyframe, report.keyframe_floor));
  atlas.runtime_.point_ids.Set(next.map_point, std::max(floors.map_point, report.point_floor));
  atlas.runtime_.camera_ids.Set(next.camera, floors.camera);
}

LiveAtlas FromModel(slamdb::Atlas model, int threads) {
  LiveAtlas live{std::make_unique<Atlas>(), {}};
  Bridge::Fill(*live.atlas, std::move(model), threads, live.report);
  return live;
}

slamdb::Atlas ToModel(Atlas& atlas, int threads) {
  const ClosedGate closed(atlas.gate());
  return Bridge::Copy(atlas, threads);
}

}  // namespace slamdb::live
