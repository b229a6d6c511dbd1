// SPDX-License-Identifier: BSD-3-Clause
// 1. Pairs that are known are fused.
// 2. The uncertainty of every point, and the points of the first part in a hash by place.
// 3. For each point of the second part the most alike one near it; these are fused, the most alike first.
// 4. What went is erased; what survives gets its descriptor and normal, covisibility is counted anew.
#include "slamdb/edit/merge/fuse.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <tuple>
#include <vector>

#include "slamdb/base/detail/median.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/base/detail/steps.h"
#include "slamdb/edit/landmarks/landmarks.h"
#include "slamdb/edit/merge/detail/fused_landmarks.h"
#include "slamdb/edit/merge/detail/refresh_points.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/index.h"

namespace slamdb {
namespace {

constexpr float kLargestUncertainty = 4;  // in medians: bounds how many cells are searched

using Cell = Eigen::Vector3i;

// Points by the cell of a regular grid that they are in: a chain for each hash value.
class PlaceTable {
 public:
  PlaceTable(float width, std::size_t count) : width_(width), heads_(std::bit_ceil(2 * count + 1), kNoRow) {}

  Cell CellOf(const Eigen::Vector3f& position) const {
    return (position / width_).array().floor().max(-1e9F).min(1e9F).cast<int>();
  }

  void Insert(const Eigen::Vector3f& position, std::uint32_t row) {
    std::uint32_t& head = heads_[PlaceOf(CellOf(position))];
    entries_.push_back({CellOf(position), row, head});
    head = static_cast<std::uint32_t>(entries_.size() - 1);
  }

  template <class Visit>
  void VisitCell(const Cell& cell, const Visit& visit) const {
    for (std::uint32_t at = heads_[PlaceOf(cell)]; at != kNoRow; at = entries_[at].next)
      if (entries_[at].cell == cell) visit(entries_[at].row);
  }

 private:
  struct Entry {
    Cell cell;
    std::uint32_t row, next;
  };

  std::size_t PlaceOf(const Cell& cell) const {
    std::uint64_t hash = 0;
    for (int axis = 0; axis < 3; ++axis) hash = (hash ^ static_cast<std::uint32_t>(cell[axis])) * 0x9E3779B97F4A7C15U;
    return (hash >> 20) & (heads_.size() - 1);
  }

  float width_;
  std::vector<std::uint32_t> heads_;
  std::vector<Entry> entries_;
};

struct Pair {
  std::uint32_t first = kNoRow, second = kNoRow;  // rows of points
  int hamming = 0;
  float distance = 0;

  friend bool operator<(const Pair& a, const Pair& b) {
    return std::tie(a.hamming, a.distance, a.first, a.second) < std::tie(b.hamming, b.distance, b.first, b.second);
  }
};

class Fuser {
 public:
  Fuser(Map& map, std::size_t second, const FuseOptions& options)
      : map_(map), second_(second), options_(options), keyframes_(KeyFrameTable(map)) {}

  FuseReport Run() {
    survivor_.assign(map_.points.size(), kNoRow);
    FuseKnown();
    std::vector<Pair> pairs = FindPairs();
    report_.candidates = pairs.size() + options_.known.size();
    std::ranges::sort(pairs, std::less<>());
    for (const Pair& pair : pairs)
      if (survivor_[pair.second] == kNoRow) Fuse(SurvivorOf(pair.first), pair.second);
    return Finish();
  }

 private:
  FuseReport Finish() {
    if (report_.fused == 0) return report_;
    report_.mean_distance /= static_cast<double>(report_.fused);
    for (std::uint32_t& survivor : survivor_)
      if (survivor != kNoRow) survivor = SurvivorOf(survivor);
    RedirectTheRest();
    EraseFused();
    std::vector<MapPointId> survivors;
    for (const auto& [gone, survivor] : report_.replaced) survivors.push_back(survivor);
    report_.keyframes = detail::RefreshPoints(map_, survivors);
    return report_;
  }

  // Where a point has gone to, through others; itself if it is there.
  std::uint32_t SurvivorOf(std::uint32_t row) const {
    while (survivor_[row] != kNoRow) row = survivor_[row];
    return row;
  }

  // max_distance is the distance from the reference keyframe times the scale of the level that it saw the point at.
  void FindUncertainties() {
    uncertainty_.assign(map_.points.size(), 0);
    std::vector<float> known;
    for (std::size_t row = 0; row < map_.points.size(); ++row) {
      const MapPoint& point = map_.points[row];
      const std::uint32_t reference = keyframes_.Find(point.reference.value());
      if (reference == kNoRow || point.bad || !point.has_descriptor() || !point.position.allFinite()) continue;
      const float sigma = point.max_distance / map_.keyframes[reference].intrinsics.fx;
      if (!(sigma > 0 && std::isfinite(sigma))) continue;
      uncertainty_[row] = sigma;
      known.push_back(sigma);
    }
    const float median = detail::MedianOf(std::move(known));
    cell_width_ = static_cast<float>(options_.radius) * median;
    for (float& sigma : uncertainty_) sigma = std::min(sigma, kLargestUncertainty * median);
  }

  void FuseKnown() {
    if (options_.known.empty()) return;
    const IdTable points = PointTable(map_);
    for (const auto& [first, second] : options_.known) {
      const std::uint32_t a = points.Find(first.value()), b = points.Find(second.value());
      if (a == kNoRow || b == kNoRow) continue;
      if (const std::uint32_t kept = SurvivorOf(a), gone = SurvivorOf(b); kept != gone) Fuse(kept, gone);
    }
  }

  std::vector<Pair> FindPairs() {
    std::vector<Pair> pairs;
    if (second_ >= map_.points.size()) return pairs;
    FindUncertainties();
    if (!(cell_width_ > 0)) return pairs;
    PlaceTable places(cell_width_, second_);
    for (std::uint32_t row = 0; row < second_; ++row)
      if (uncertainty_[row] > 0) places.Insert(map_.points[row].position, row);
    std::vector<Pair> best(map_.points.size() - second_);
    detail::ParallelFor(best.size(), 256, options_.threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) best[i] = FindBest(places, static_cast<std::uint32_t>(second_ + i));
    });
    std::ranges::copy_if(best, std::back_inserter(pairs), [](const Pair& pair) { return pair.first != kNoRow; });
    return pairs;
  }

  Pair FindBest(const PlaceTable& places, std::uint32_t row) const {
    Pair best;
    if (!(uncertainty_[row] > 0)) return best;
    const MapPoint& point = map_.points[row];
    const float reach = static_cast<float>(options_.radius) * uncertainty_[row];
    const Cell low = places.CellOf(point.position.array() - reach),
               high = places.CellOf(point.position.array() + reach);
    const auto look = [&](std::uint32_t other) {
      const float distance = (map_.points[other].position - point.position).norm();
      if (distance > static_cast<float>(options_.radius) * std::min(uncertainty_[row], uncertainty_[other])) return;
      const Pair pair{other, row, HammingDistance(map_.points[other].descriptor, point.descriptor), distance};
      if (pair.hamming <= options_.hamming && (best.first == kNoRow || pair < best)) best = pair;
    };
    for (int x = low.x(); x <= high.x(); ++x)
      for (int y = low.y(); y <= high.y(); ++y)
        for (int z = low.z(); z <= high.z(); ++z) places.VisitCell({x, y, z}, look);
    return best;
  }

  bool SeenTogether(const MapPoint& a, const MapPoint& b) const {
    return std::ranges::any_of(b.observations, [&](const Observation& observation) {
      return std::ranges::binary_search(a.observations, observation.keyframe, {}, &Observation::keyframe);
    });
  }

  // As ORB-SLAM3's MapPoint::Replace does. A count that is recorded on one side alone is the count of both.
  static void AddCount(std::int32_t gone, std::int32_t& kept) {
    if (gone == MapPoint::kNoCount) return;
    if (kept == MapPoint::kNoCount) kept = 0;
    constexpr std::int64_t kLargest = std::numeric_limits<std::int32_t>::max();
    kept = static_cast<std::int32_t>(std::min(kLargest, std::int64_t{kept} + gone));
  }

  void Fuse(std::uint32_t kept_row, std::uint32_t gone_row) {
    MapPoint &kept = map_.points[kept_row], &gone = map_.points[gone_row];
    if (SeenTogether(kept, gone)) {
      ++report_.seen_together;
      return;
    }
    for (const Observation& observation : gone.observations) {
      const std::uint32_t row = keyframes_.Find(observation.keyframe.value());
      if (row == kNoRow) continue;
      KeyFrame& keyframe = map_.keyframes[row];
      for (const std::int32_t keypoint : {observation.left, observation.right}) {
        if (keypoint < 0 || static_cast<std::size_t>(keypoint) >= keyframe.features.map_points.size()) continue;
        MapPointId& slot = keyframe.features.map_points[static_cast<std::size_t>(keypoint)];
        if (!slot || slot == gone.id) slot = kept.id;  // who sees a third point goes on seeing it
      }
      kept.observations.insert(
          std::ranges::lower_bound(kept.observations, observation.keyframe, {}, &Observation::keyframe), observation);
      kept.observation_count += ObservationWeight(keyframe, observation);
      ++report_.observations;
    }
    AddCount(gone.visible_count, kept.visible_count);
    AddCount(gone.found_count, kept.found_count);
    survivor_[gone_row] = kept_row;
    report_.mean_distance += static_cast<double>((kept.position - gone.position).norm());
    ++report_.fused;
  }

  // Slots that hold a fused point though it does not record them are emptied, as nothing says that they see the other.
  void RedirectTheRest() {
    const IdTable points = PointTable(map_);
    const auto survivor_of = [&](MapPointId id) {
      const std::uint32_t row = points.Find(id.value());
      return row == kNoRow ? kNoRow : survivor_[row];
    };
    for (KeyFrame& keyframe : map_.keyframes)
      for (MapPointId& slot : keyframe.features.map_points) {
        if (survivor_of(slot) == kNoRow) continue;
        slot = {};
        ++report_.cleared_slots;
      }
    for (MapPoint& point : map_.points)
      if (const std::uint32_t survivor = survivor_of(point.replaced_by); survivor != kNoRow)
        point.replaced_by = map_.points[survivor].id;
  }

  void EraseFused() {
    for (std::size_t row = 0; row < map_.points.size(); ++row)
      if (survivor_[row] != kNoRow) report_.replaced.emplace_back(map_.points[row].id, map_.points[survivor_[row]].id);
    std::ranges::sort(report_.replaced);
    std::size_t kept = 0;
    for (std::size_t row = 0; row < map_.points.size(); ++row) {
      if (survivor_[row] != kNoRow) continue;
      if (kept != row) map_.points[kept] = std::move(map_.points[row]);
      ++kept;
    }
    map_.points.resize(kept);
  }

  Map& map_;
  const std::size_t second_;
  const FuseOptions& options_;
  const IdTable keyframes_;
  FuseReport report_;
  std::vector<float> uncertainty_;  // by point row; 0: not to be fused
  float cell_width_ = 0;
  std::vector<std::uint32_t> survivor_;  // by point row: the point it went into, or kNoRow
};

}  // namespace

void detail::FollowFusedPoints(const FuseReport& fused, Map& map) {
  std::vector<Landmark> moved;
  std::erase_if(map.landmarks, [&](Landmark& landmark) {
    const MapPointId id(landmark.id.value());
    const auto found = std::ranges::lower_bound(fused.replaced, id, {}, &std::pair<MapPointId, MapPointId>::first);
    if (found == fused.replaced.end() || found->first != id) return false;
    landmark.id = LandmarkId(found->second.value());
    moved.push_back(landmark);
    return true;
  });
  TakeLandmarks(map.landmarks, moved);
}

FuseReport FusePoints(Map& map, std::size_t second, const FuseOptions& options) {
  FuseReport report = Fuser(map, second, options).Run();
  detail::Steps(options.progress, "fusing points", 1).Next();
  return report;
}

FuseReport FusePairs(Map& map, std::vector<std::pair<MapPointId, MapPointId>> pairs) {
  FuseOptions options;
  options.known = std::move(pairs);
  FuseReport report = Fuser(map, map.points.size(), options).Run();
  detail::FollowFusedPoints(report, map);
  return report;
}

}  // namespace slamdb
