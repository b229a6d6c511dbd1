// SPDX-License-Identifier: BSD-3-Clause
// Steps: with the preset, one map is left and its free features go; keyframes are chosen one by one until the target;
// the rest is removed; last, since joining them over gaps needs them, inertial measurements go.
#include "slamdb/edit/part/shrink.h"

#include <algorithm>
#include <compare>
#include <limits>
#include <queue>
#include <string>

#include "slamdb/base/detail/steps.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/part/detail/archive_size.h"
#include "slamdb/edit/part/detail/free_features.h"

namespace slamdb {
namespace {

// What a keyframe adds: views of points to places that lack them, then points.
struct Gain {
  std::uint64_t views = 0, points = 0;
  friend auto operator<=>(const Gain&, const Gain&) = default;
};

// Chooses keyframes of an atlas. Keyframes and points of all maps are numbered one map behind the other.
class GreedyCoverage {
 public:
  GreedyCoverage(const AtlasIndex& index, const ShrinkOptions& options)
      : index_(index), options_(options), kept_(Subset::Nothing(index.atlas())) {
    for (std::uint32_t map = 0; map < index.atlas().maps.size(); ++map) ListObservations(map);
    views_.assign(begins_.size(), 0);
  }

  // Throws Error when the target leaves no room for a single keyframe.
  Subset Choose() {
    std::uint64_t bytes = BytesAround();
    std::size_t chosen = 0;
    const std::size_t most = options_.target_keyframes.value_or(std::numeric_limits<std::size_t>::max());
    for (std::uint32_t place = 0; place < keyframes_.size(); ++place) queue_.push({GainOf(place), place});
    while (!queue_.empty() && chosen < most) {
      const std::uint32_t place = TakeBest();
      bytes += BytesOf(place);
      if (options_.target_bytes && bytes > *options_.target_bytes) {
        if (chosen == 0) RefuseTarget(bytes);
        break;
      }
      Keep(place);
      ++chosen;
    }
    KeepLandmarks();
    return std::move(kept_);
  }

 private:
  // Those of every map that stays; .osa files, whose size is the target, hold none.
  void KeepLandmarks() {
    for (Subset::MapRows& rows : kept_.maps)
      if (rows.keyframes.empty() || std::ranges::count(rows.keyframes, 1) > 0)
        std::ranges::fill(rows.landmarks, std::uint8_t{1});
  }

  struct Candidate {
    Gain gain;
    std::uint32_t place;
    friend bool operator<(const Candidate& a, const Candidate& b) {
      return a.gain != b.gain ? a.gain < b.gain : a.place > b.place;  // the earlier of equals comes out first
    }
  };

  // The points that each keyframe of a map observes, by way of its points' observations.
  void ListObservations(std::uint32_t map_row) {
    const Map& map = index_.atlas().maps[map_row];
    first_.push_back(static_cast<std::uint32_t>(keyframes_.size()));
    std::vector<std::size_t> counts(map.keyframes.size(), 0);
    const auto visit = [&](const auto& see) {
      for (std::uint32_t row = 0; row < map.points.size(); ++row)
        for (const Observation& observation : map.points[row].observations)
          if (const std::uint32_t observer = index_.KeyFrameRow(map_row, observation.keyframe); observer != kNoRow)
            see(observer, row);
    };
    visit([&](std::uint32_t observer, std::uint32_t) { ++counts[observer]; });
    std::vector<std::size_t> next;
    for (std::uint32_t row = 0; row < map.keyframes.size(); ++row) {
      keyframes_.push_back({map_row, row});
      begins_.push_back(ends_.empty() ? 0 : ends_.back());
      ends_.push_back(begins_.back() + counts[row]);
      next.push_back(begins_.back());
    }
    points_.resize(ends_.empty() ? 0 : ends_.back());
    visit([&](std::uint32_t observer, std::uint32_t row) { points_[next[observer]++] = row; });
  }

  template <class Visit>
  void ForEachNewPoint(std::uint32_t place, const Visit& visit) const {
    const auto& points = index_.atlas().maps[keyframes_[place].map].points;
    for (std::size_t i = begins_[place]; i < ends_[place]; ++i)
      if (!kept_.maps[keyframes_[place].map].points[points_[i]]) visit(points_[i], points[points_[i]]);
  }

  template <class Visit>
  void ForEachObserver(std::uint32_t map, const MapPoint& point, const Visit& visit) const {
    for (const Observation& observation : point.observations)
      if (const std::uint32_t observer = index_.KeyFrameRow(map, observation.keyframe); observer != kNoRow)
        visit(first_[map] + observer);
  }

  Gain GainOf(std::uint32_t place) const {
    Gain gain;
    ForEachNewPoint(place, [&](std::uint32_t, const MapPoint& point) {
      ++gain.points;
      ForEachObserver(keyframes_[place].map, point, [&](std::uint32_t observer) {
        if (views_[observer] < options_.min_points) ++gain.views;
      });
    });
    return gain;
  }

  std::uint32_t TakeBest() {
    for (;;) {
      const std::uint32_t place = queue_.top().place;
      queue_.pop();
      const Candidate now{GainOf(place), place};
      if (queue_.empty() || !(now < queue_.top())) return place;
      queue_.push(now);
    }
  }

  void Keep(std::uint32_t place) {
    const EntityRow keyframe = keyframes_[place];
    const std::uint32_t map = keyframe.map, row = keyframe.row;
    ForEachNewPoint(place, [&](std::uint32_t point_row, const MapPoint& point) {
      kept_.maps[map].points[point_row] = 1;
      ForEachObserver(map, point, [&](std::uint32_t observer) { ++views_[observer]; });
    });
    kept_.maps[map].keyframes[row] = 1;
  }

  // What the file needs beside keyframes and points.
  std::uint64_t BytesAround() const {
    Atlas empty;
    empty.cameras = index_.atlas().cameras;
    empty.maps.resize(index_.atlas().maps.size());
    return detail::ArchiveBytes(empty);
  }

  std::uint64_t BytesOf(std::uint32_t place) const {
    const KeyFrame& keyframe = index_.atlas().maps[keyframes_[place].map].keyframes[keyframes_[place].row];
    std::uint64_t bytes =
        detail::ArchiveBytes(keyframe) + detail::kArchiveBytesPerObservation * (ends_[place] - begins_[place]);
    if (options_.for_localization) bytes -= sizeof(ImuMeasurement) * keyframe.preintegration.measurements.size();
    ForEachNewPoint(place, [&](std::uint32_t, const MapPoint&) { bytes += detail::ArchiveBytes(MapPoint()); });
    return bytes;
  }

  [[noreturn]] void RefuseTarget(std::uint64_t needed) const {
    const auto kilobytes = [](std::uint64_t bytes) { return std::to_string((bytes + 999) / 1000) + " kB"; };
    throw Error(ErrorKind::kNotPossible, "the target of " + kilobytes(*options_.target_bytes) +
                                             " is below what one keyframe with its points takes, " + kilobytes(needed));
  }

  const AtlasIndex& index_;
  const ShrinkOptions& options_;
  std::vector<EntityRow> keyframes_;
  std::vector<std::uint32_t> first_;        // number of the first keyframe of each map
  std::vector<std::size_t> begins_, ends_;  // of each keyframe in points_
  std::vector<std::uint32_t> points_;       // rows in the keyframe's map
  std::vector<std::size_t> views_;          // kept points that each keyframe observes
  std::priority_queue<Candidate> queue_;
  Subset kept_;
};

Subset LargestMap(const Atlas& atlas) {
  const auto largest = std::ranges::max_element(atlas.maps, {}, [](const Map& map) { return map.keyframes.size(); });
  const auto row = static_cast<std::size_t>(largest - atlas.maps.begin());
  Subset subset = Subset::Nothing(atlas);
  subset.maps[row] = Subset::Everything(atlas).maps[row];
  return subset;
}

bool Fits(const Atlas& atlas, const ShrinkOptions& options) {
  return (!options.target_keyframes || CountEntities(atlas).keyframes <= *options.target_keyframes) &&
         (!options.target_bytes || detail::ArchiveBytes(atlas) <= *options.target_bytes);
}

std::uint64_t DropMeasurements(Atlas& atlas) {
  std::uint64_t dropped = 0;
  for (Map& map : atlas.maps)
    for (KeyFrame& keyframe : map.keyframes) {
      dropped += keyframe.preintegration.measurements.size();
      keyframe.preintegration.measurements = {};
    }
  return dropped;
}

}  // namespace

ShrinkReport Shrink(Atlas& atlas, const ShrinkOptions& options) {
  if (!options.target_keyframes && !options.target_bytes && !options.for_localization)
    throw Error(ErrorKind::kUsage, "say how small: a number of keyframes, a size, or what the atlas is for");
  detail::Steps steps(options.progress, "shrinking", 2);
  ShrinkReport report{.bytes_before = detail::ArchiveBytes(atlas), .removed = {.before = CountEntities(atlas)}};
  report.coverage = MeasureCoverage(AtlasIndex(atlas), Subset::Everything(atlas), options.min_points);
  if (options.for_localization) {
    if (atlas.maps.empty()) throw Error(ErrorKind::kNotPossible, "the atlas has no map to localise in");
    report.removed += KeepSubset(atlas, LargestMap(atlas), options.threads);
    report.features_dropped = detail::DropFreeFeatures(atlas, options.threads);
  }
  steps.Next();
  const AtlasIndex index(atlas);
  Subset kept = Subset::Everything(atlas);
  if (!Fits(atlas, options)) {
    kept = GreedyCoverage(index, options).Choose();
    SettleBorder(index, Border::kStrict, kept, options.threads);
  }
  report.coverage.covered = MeasureCoverage(index, kept, options.min_points).covered;
  report.removed += KeepSubset(atlas, kept, options.threads);
  if (options.for_localization) report.measurements_dropped = DropMeasurements(atlas);
  report.bytes_after = detail::ArchiveBytes(atlas);
  steps.Next();
  return report;
}

}  // namespace slamdb
