// SPDX-License-Identifier: BSD-3-Clause
// Steps for each map: points drop observations by removed keyframes; preintegrations are joined over removed keyframes
// while these are still there; keyframes drop links to what is removed; rows go; initial keyframe and tree are mended.
#include "slamdb/edit/part/subset.h"

#include <algorithm>
#include <atomic>
#include <set>

#include "slamdb/base/detail/parallel.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/part/detail/gaps.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/detail/irregular_entries.h"
#include "slamdb/model/detail/spanning_tree.h"
#include "slamdb/model/preintegration.h"

namespace slamdb {
namespace {

using Flags = std::vector<std::uint8_t>;
using Count = std::atomic<std::uint64_t>;

constexpr std::size_t kPointGrain = 4096, kKeyFrameGrain = 16;

template <class List>
void KeepRows(List& list, const Flags& kept) {
  auto to = list.begin();
  for (std::size_t row = 0; row < kept.size(); ++row) {
    if (!kept[row]) continue;
    const auto from = list.begin() + static_cast<std::ptrdiff_t>(row);
    if (to != from) *to = std::move(*from);
    ++to;
  }
  list.erase(to, list.end());
}

std::uint64_t CountRemoved(const Flags& kept) { return static_cast<std::uint64_t>(std::ranges::count(kept, 0)); }

// Closes one map of an atlas over the rows that are kept.
class MapClosing {
 public:
  MapClosing(Map& map, const Subset::MapRows& rows, int threads, SubsetReport& report)
      : map_(map),
        kept_keyframes_(rows.keyframes),
        kept_points_(rows.points),
        kept_landmarks_(rows.landmarks),
        threads_(threads),
        report_(report),
        keyframe_rows_(KeyFrameTable(map)),
        point_rows_(PointTable(map)) {}

  void Close() {
    CutPoints();
    BridgeGaps();
    CutKeyFrames();
    report_.keyframes += CountRemoved(kept_keyframes_);
    report_.points += CountRemoved(kept_points_);
    KeepRows(map_.keyframes, kept_keyframes_);
    KeepRows(map_.points, kept_points_);
    report_.landmarks += CountRemoved(kept_landmarks_);
    KeepRows(map_.landmarks, kept_landmarks_);
    if (map_.keyframes.empty())
      map_.origins.clear();
    else
      MendMap();
  }

 private:
  bool Keeps(KeyFrameId id) const {
    const std::uint32_t row = keyframe_rows_.Find(id.value());
    return row != kNoRow && kept_keyframes_[row];
  }
  bool Keeps(MapPointId id) const {
    const std::uint32_t row = point_rows_.Find(id.value());
    return row != kNoRow && kept_points_[row];
  }

  void CutPoints() {
    Count observations = 0, references = 0;
    detail::ParallelFor(map_.points.size(), kPointGrain, threads_, [&](std::size_t begin, std::size_t end) {
      std::uint64_t erased = 0, chosen = 0;
      for (std::size_t row = begin; row < end; ++row) {
        if (!kept_points_[row]) continue;
        MapPoint& point = map_.points[row];
        erased += CutObservations(point);
        if (point.observations.empty()) kept_points_[row] = 0;
        if (point.observations.empty() || Observes(point, point.reference)) continue;
        point.reference = std::ranges::min(point.observations, {}, &Observation::keyframe).keyframe;
        ++chosen;
      }
      observations += erased;
      references += chosen;
    });
    report_.observations += observations;
    report_.new_references += references;
    for (std::size_t row = 0; row < map_.points.size(); ++row)
      if (MapPoint& point = map_.points[row]; kept_points_[row] && point.replaced_by && !Keeps(point.replaced_by))
        point.replaced_by = {};
  }

  static bool Observes(const MapPoint& point, KeyFrameId id) {
    return std::ranges::find(point.observations, id, &Observation::keyframe) != point.observations.end();
  }

  std::uint64_t CutObservations(MapPoint& point) const {
    const std::uint64_t lost =
        std::erase_if(point.observations, [&](const Observation& o) { return !Keeps(o.keyframe); });
    if (lost == 0) return 0;
    point.observation_count = 0;
    for (const Observation& observation : point.observations)
      point.observation_count +=
          ObservationWeight(map_.keyframes[keyframe_rows_.Find(observation.keyframe.value())], observation);
    return lost;
  }

  // Links previous and next keyframes over those that go.
  void BridgeGaps() {
    struct Bridge {
      std::uint32_t previous, next;
    };
    std::vector<Bridge> bridges;
    std::vector<std::uint32_t> between;
    const auto row_of = [&](KeyFrameId id) { return keyframe_rows_.Find(id.value()); };
    for (std::uint32_t row = 0; row < map_.keyframes.size(); ++row) {
      KeyFrame& keyframe = map_.keyframes[row];
      if (!kept_keyframes_[row] || !keyframe.previous || Keeps(keyframe.previous)) continue;
      const std::uint32_t previous = detail::KeptBefore(map_, kept_keyframes_, row, row_of, between);
      const bool bridged = previous != kNoRow && (!map_.inertial || JoinOver(between, keyframe));
      keyframe.previous = {};
      if (!bridged) continue;
      bridges.push_back({previous, row});
      if (map_.inertial) ++report_.joined;
    }
    for (std::uint32_t row = 0; row < map_.keyframes.size(); ++row)
      if (KeyFrame& keyframe = map_.keyframes[row]; kept_keyframes_[row] && keyframe.next && !Keeps(keyframe.next))
        keyframe.next = {};
    for (const Bridge& bridge : bridges) {
      map_.keyframes[bridge.next].previous = map_.keyframes[bridge.previous].id;
      map_.keyframes[bridge.previous].next = map_.keyframes[bridge.next].id;
    }
  }

  // `between`: rows of the removed keyframes before it, newest first.
  bool JoinOver(const std::vector<std::uint32_t>& between, KeyFrame& keyframe) const {
    std::vector<const ImuPreintegration*> earlier;
    for (auto row = between.rbegin(); row != between.rend(); ++row)
      earlier.push_back(&map_.keyframes[*row].preintegration);
    return JoinPreintegrations(earlier, keyframe.preintegration);
  }

  void CutKeyFrames() {
    Count slots = 0, edges = 0;
    detail::ParallelFor(map_.keyframes.size(), kKeyFrameGrain, threads_, [&](std::size_t begin, std::size_t end) {
      std::uint64_t emptied = 0, erased = 0;
      for (std::size_t row = begin; row < end; ++row) {
        if (!kept_keyframes_[row]) continue;
        emptied += EmptySlots(map_.keyframes[row]);
        erased += CutLinks(map_.keyframes[row]);
      }
      slots += emptied;
      edges += erased;
    });
    report_.slots += slots;
    report_.edges += edges;
  }

  std::uint64_t EmptySlots(KeyFrame& keyframe) const {
    std::uint64_t emptied = 0;
    for (MapPointId& slot : keyframe.features.map_points) {
      if (!slot || Keeps(slot)) continue;
      slot = {};
      ++emptied;
    }
    return emptied;
  }

  std::uint64_t CutLinks(KeyFrame& keyframe) const {
    const auto leads_out = [&](KeyFrameId id) { return !Keeps(id); };
    const std::size_t loops = std::erase_if(keyframe.loop_edges, leads_out);
    const std::size_t merges = std::erase_if(keyframe.merge_edges, leads_out);
    // Its last loop or merge edge was what kept it from being culled.
    if (loops + merges > 0 && keyframe.loop_edges.empty() && keyframe.merge_edges.empty()) keyframe.not_erase = false;
    std::erase_if(keyframe.children, leads_out);
    if (keyframe.parent && !Keeps(keyframe.parent)) keyframe.parent = {};
    return loops + merges + std::erase_if(keyframe.connections, [&](const Connection& connection) {
             return !Keeps(connection.keyframe);
           });
  }

  void MendMap() {
    const KeyFrameId lowest = std::ranges::min_element(map_.keyframes, {}, &KeyFrame::id)->id;
    const auto choose = [&](KeyFrameId& id, KeyFrameId instead) {
      if (!Keeps(id)) id = instead;
    };
    if (!Keeps(map_.first_keyframe)) {
      map_.first_keyframe = lowest;
      detail::RerootTree(map_, lowest);
    }
    choose(map_.initial_keyframe, map_.first_keyframe);
    choose(map_.lowest_keyframe, lowest);
    if (std::erase_if(map_.origins, [&](KeyFrameId id) { return !Keeps(id); }) > 0 && map_.origins.empty())
      map_.origins.push_back(map_.first_keyframe);
    report_.new_parents += detail::AdoptOrphans(map_);
  }

  Map& map_;
  const Flags& kept_keyframes_;
  Flags kept_points_;  // those without observers are taken out
  const Flags& kept_landmarks_;
  const int threads_;
  SubsetReport& report_;
  const IdTable keyframe_rows_, point_rows_;  // of the lists as they were
};

std::set<CameraId> UsedCameras(const Atlas& atlas) {
  std::set<CameraId> used;
  for (const Map& map : atlas.maps)
    for (const KeyFrame& keyframe : map.keyframes) used.insert({keyframe.camera, keyframe.right_camera});
  return used;
}

void RefuseOther() {
  throw Error(ErrorKind::kUsage, "the subset is not of this atlas: it has other maps, keyframes, points or landmarks");
}

void RequireSameShape(const Map& map, const Subset::MapRows& rows) {
  if (rows.keyframes.size() != map.keyframes.size() || rows.points.size() != map.points.size() ||
      rows.landmarks.size() != map.landmarks.size())
    RefuseOther();
}

void RequireSameShape(const Atlas& atlas, const Subset& subset) {
  if (atlas.maps.size() != subset.maps.size()) RefuseOther();
  for (std::size_t row = 0; row < atlas.maps.size(); ++row) RequireSameShape(atlas.maps[row], subset.maps[row]);
}

Subset Filled(const Atlas& atlas, std::uint8_t value) {
  Subset subset;
  for (const Map& map : atlas.maps)
    subset.maps.push_back(
        {Flags(map.keyframes.size(), value), Flags(map.points.size(), value), Flags(map.landmarks.size(), value)});
  return subset;
}

// Decides about the points of one map.
class PointBorder {
 public:
  PointBorder(const AtlasIndex& index, std::size_t map_row, const Flags& kept_keyframes)
      : index_(index), row_(map_row), map_(index.atlas().maps[map_row]), kept_keyframes_(kept_keyframes) {}

  bool Holds(const MapPoint& point, Border border) const {
    std::size_t observers = 0;
    std::int32_t weight = 0;
    for (const Observation& observation : point.observations) {
      const std::uint32_t row = index_.KeyFrameRow(row_, observation.keyframe);
      if (row == kNoRow || !kept_keyframes_[row]) continue;
      ++observers;
      weight += ObservationWeight(map_.keyframes[row], observation);
    }
    if (observers == point.observations.size()) return observers > 0;
    return border == Border::kSmart ? weight > kCulledAt : weight >= 2;
  }

 private:
  const AtlasIndex& index_;
  const std::size_t row_;
  const Map& map_;
  const Flags& kept_keyframes_;
};

void AddObservers(const AtlasIndex& index, std::size_t map_row, Subset::MapRows& rows) {
  const Map& map = index.atlas().maps[map_row];
  for (std::size_t row = 0; row < map.points.size(); ++row) {
    if (!rows.points[row]) continue;
    for (const Observation& observation : map.points[row].observations)
      if (const std::uint32_t observer = index.KeyFrameRow(map_row, observation.keyframe); observer != kNoRow)
        rows.keyframes[observer] = 1;
  }
}

}  // namespace

EntityCounts CountEntities(const Atlas& atlas) {
  EntityCounts counts{.maps = atlas.maps.size()};
  for (const Map& map : atlas.maps) {
    counts.keyframes += map.keyframes.size();
    counts.points += map.points.size();
    counts.landmarks += map.landmarks.size();
  }
  return counts;
}

SubsetReport& SubsetReport::operator+=(const SubsetReport& next) {
  after = next.after;
  for (const auto field :
       {&SubsetReport::maps, &SubsetReport::keyframes, &SubsetReport::points, &SubsetReport::landmarks,
        &SubsetReport::cameras, &SubsetReport::observations, &SubsetReport::slots, &SubsetReport::edges,
        &SubsetReport::new_references, &SubsetReport::new_parents, &SubsetReport::joined})
    this->*field += next.*field;
  return *this;
}

Subset Subset::Everything(const Atlas& atlas) { return Filled(atlas, 1); }
Subset Subset::Nothing(const Atlas& atlas) { return Filled(atlas, 0); }

void SettleBorder(const AtlasIndex& index, Border border, Subset& subset, int threads) {
  RequireSameShape(index.atlas(), subset);
  for (std::uint32_t map = 0; map < subset.maps.size(); ++map)
    SettleBorder(index, map, border, subset.maps[map], threads);
}

void SettleBorder(const AtlasIndex& index, std::uint32_t map, Border border, Subset::MapRows& rows, int threads) {
  RequireSameShape(index.atlas().maps.at(map), rows);
  if (border == Border::kCompletePoints) AddObservers(index, map, rows);
  const PointBorder points(index, map, rows.keyframes);
  detail::ParallelFor(rows.points.size(), kPointGrain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row)
      if (rows.points[row] && !points.Holds(index.atlas().maps[map].points[row], border)) rows.points[row] = 0;
  });
}

SubsetReport KeepSubset(Atlas& atlas, const Subset& subset, int threads) {
  RequireSameShape(atlas, subset);
  SubsetReport report{.before = CountEntities(atlas)};
  const std::set<CameraId> used = UsedCameras(atlas);
  for (std::size_t row = 0; row < atlas.maps.size(); ++row)
    MapClosing(atlas.maps[row], subset.maps[row], threads, report).Close();
  report.maps =
      std::erase_if(atlas.maps, [](const Map& map) { return map.keyframes.empty() && map.landmarks.empty(); });
  report.after = CountEntities(atlas);
  if (report.maps + report.keyframes + report.points == 0) return report;
  detail::DropIrregularEntries(atlas);
  const std::set<CameraId> still_used = UsedCameras(atlas);
  report.cameras = std::erase_if(
      atlas.cameras, [&](const Camera& camera) { return used.contains(camera.id) && !still_used.contains(camera.id); });
  return report;
}

}  // namespace slamdb
