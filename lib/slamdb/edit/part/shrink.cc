// SPDX-License-Identifier: BSD-3-Clause
// Steps: if asked, one map is left; with the preset its free features go; keyframes are chosen up to the target; the
// rest is removed; last, since joining them over gaps needs them, inertial measurements go.
#include "slamdb/edit/part/shrink.h"

#include <algorithm>

#include "slamdb/base/detail/steps.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/part/detail/archive_size.h"
#include "slamdb/edit/part/detail/choose_keyframes.h"
#include "slamdb/edit/part/detail/free_features.h"

namespace slamdb {
namespace {

// The keyframes to keep, and the points that stay with them.
Subset Choose(const AtlasIndex& index, const ShrinkOptions& options) {
  Atlas around;
  around.cameras = index.atlas().cameras;
  around.maps.resize(index.atlas().maps.size());
  const detail::Sights sights(index);
  detail::KeyFrameBudget budget{.min_points = std::max<std::size_t>(options.min_points, 1),
                                .keyframes = options.target_keyframes,
                                .bytes = options.target_bytes,
                                .bytes_around = detail::ArchiveBytes(around)};
  for (std::uint32_t number = 0; number < sights.keyframes(); ++number) {
    const KeyFrame& keyframe = sights.KeyFrameOf(number);
    const std::uint64_t measurements = sizeof(ImuMeasurement) * keyframe.preintegration.measurements.size();
    budget.keyframe_bytes.push_back(detail::ArchiveBytes(keyframe) - measurements);
    if (!options.for_localization) budget.bytes_around += measurements;  // joined over gaps, all may stay
  }
  return detail::ChooseKeyFrames(sights, budget);
}

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
  if (!options.target_keyframes && !options.target_bytes && !options.for_localization && !options.largest_map)
    throw Error(ErrorKind::kUsage, "say how small: a number of keyframes, a size, or what the atlas is for");
  detail::Steps steps(options.progress, "shrinking", 2);
  ShrinkReport report{.bytes_before = detail::ArchiveBytes(atlas), .removed = {.before = CountEntities(atlas)}};
  report.coverage = MeasureCoverage(AtlasIndex(atlas), Subset::Everything(atlas), options.min_points);
  if (options.for_localization && atlas.maps.empty())
    throw Error(ErrorKind::kNotPossible, "the atlas has no map to localise in");
  if (options.largest_map && atlas.maps.size() > 1)
    report.removed += KeepSubset(atlas, LargestMap(atlas), options.threads);
  if (options.for_localization) report.features_dropped = detail::DropFreeFeatures(atlas, options.threads);
  steps.Next();
  const AtlasIndex index(atlas);
  Subset kept = Subset::Everything(atlas);
  if (!Fits(atlas, options)) {
    kept = Choose(index, options);
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
