// SPDX-License-Identifier: BSD-3-Clause
// Steps: if asked, one map is left; keyframes are chosen up to the target, counting on what the preset takes; the rest
// is removed; then the preset's features go, and last, since joining them over gaps needs them, inertial measurements.
#include "slamdb/edit/part/shrink.h"

#include <algorithm>

#include "slamdb/base/detail/steps.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/part/detail/archive_size.h"
#include "slamdb/edit/part/detail/choose_keyframes.h"
#include "slamdb/edit/part/detail/free_features.h"

namespace slamdb {
namespace {

// By number of keyframes and points of Sights.
PointsShown NumberShown(const detail::Sights& sights, const std::vector<PointsShown>& shown) {
  PointsShown numbers(sights.keyframes());
  for (std::uint32_t keyframe = 0; keyframe < numbers.size(); ++keyframe) {
    const EntityRow& row = sights.RowOf(keyframe);
    if (row.map >= shown.size() || row.row >= shown[row.map].size()) continue;
    for (const std::uint32_t point : shown[row.map][row.row])
      if (point < sights.atlas().maps[row.map].points.size())
        numbers[keyframe].push_back(sights.FirstPoint(row.map) + point);
  }
  return numbers;
}

Subset LargestMap(const Atlas& atlas) {
  const auto largest = std::ranges::max_element(atlas.maps, {}, [](const Map& map) { return map.keyframes.size(); });
  const auto row = static_cast<std::size_t>(largest - atlas.maps.begin());
  Subset subset = Subset::Nothing(atlas);
  subset.maps[row] = Subset::Everything(atlas).maps[row];
  return subset;
}

// Whether the budget asks for anything to go.
bool MustChoose(const Atlas& atlas, const detail::Remains& remains) {
  const EntityCounts counts = CountEntities(atlas);
  const detail::KeyFrameBudget& budget = remains.budget();
  if (budget.keyframes && counts.keyframes > *budget.keyframes) return true;
  if (!budget.bytes || detail::ArchiveBytes(atlas) <= *budget.bytes) return false;
  return !budget.lean || !remains.Fits() || remains.keyframes() < counts.keyframes || remains.points() < counts.points;
}

// The keyframes to keep, and the points that stay with them.
Subset Choose(const Atlas& atlas, const detail::KeyFrameBudget& budget, const ShrinkOptions& options) {
  const AtlasIndex index(atlas);
  const detail::Sights sights(index);
  detail::Remains remains(sights, budget);
  if (!MustChoose(atlas, remains)) return Subset::Everything(atlas);
  const std::vector<PointsShown> shown =
      options.looks.before ? options.looks.before(atlas) : std::vector<PointsShown>();
  detail::Finding finding(remains, NumberShown(sights, shown), options.min_points, options.threads);
  detail::ChooseKeyFrames(remains, finding);
  Subset kept = remains.ToSubset();
  SettleBorder(index, Border::kStrict, kept, options.threads);
  return kept;
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
  if (options.for_localization && options.for_mapping)
    throw Error(ErrorKind::kUsage, "the atlas is either for localization or for mapping");
  detail::Steps steps(options.progress, "shrinking", 2);
  ShrinkReport report{.bytes_before = detail::ArchiveBytes(atlas), .removed = {.before = CountEntities(atlas)}};
  report.coverage = MeasureCoverage(AtlasIndex(atlas), Subset::Everything(atlas), options.min_points);
  if (options.for_localization && atlas.maps.empty())
    throw Error(ErrorKind::kNotPossible, "the atlas has no map to localise in");
  if (options.largest_map && atlas.maps.size() > 1)
    report.removed += KeepSubset(atlas, LargestMap(atlas), options.threads);
  const bool is_large = options.target_bytes && detail::ArchiveBytes(atlas) > *options.target_bytes;
  const bool lean = options.for_localization || (is_large && !options.for_mapping);
  steps.Next();
  const Subset kept = Choose(atlas, {options.target_keyframes, options.target_bytes, lean}, options);
  report.coverage.covered = MeasureCoverage(AtlasIndex(atlas), kept, options.min_points).covered;
  const SubsetReport cut = KeepSubset(atlas, kept, options.threads);
  if (options.looks.after && cut.before != cut.after) options.looks.after(atlas);
  report.removed += cut;
  if (lean) report.features_dropped = detail::DropFreeFeatures(atlas, options.threads);
  if (lean) report.measurements_dropped = DropMeasurements(atlas);
  report.bytes_after = detail::ArchiveBytes(atlas);
  steps.Next();
  return report;
}

}  // namespace slamdb
