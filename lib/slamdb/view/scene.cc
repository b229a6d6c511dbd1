// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/view/detail/scene.h"

#include <algorithm>
#include <numeric>

#include "slamdb/base/detail/parallel.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/diff/detail/diff_pair.h"

namespace slamdb::view {
namespace {

constexpr std::size_t kKeyFramesPerBlock = 8, kPointsPerBlock = 2048;

using Status = SceneDiff::Status;

bool HasOther(std::uint32_t aspects, std::size_t moving) { return (aspects & ~(1U << moving)) != 0; }

Status StatusOf(const detail::KeyFramePairDiff& diff) {
  if (diff.Has(detail::kPose)) return Status::kMoved;
  const bool links = std::ranges::any_of(
      diff.links, [](const detail::LinkCounts& link) { return link.removed + link.added + link.changed > 0; });
  return links || HasOther(diff.aspects, detail::kPose) ? Status::kChanged : Status::kSame;
}

Status StatusOf(const detail::PointPairDiff& diff) {
  if (diff.Has(detail::kPosition)) return Status::kMoved;
  const detail::LinkCounts& seen = diff.observations;
  const bool links = seen.removed + seen.added + seen.changed > 0;
  return links || HasOther(diff.aspects, detail::kPosition) ? Status::kChanged : Status::kSame;
}

// compare(number in the first) -> status of a pair. The second atlas' rows follow the first's.
template <class Compare>
SceneDiff::Kind CompareKind(const detail::Pairing& pairing, std::size_t grain, int threads, const Compare& compare) {
  SceneDiff::Kind kind;
  const std::size_t before = pairing.before_size(), after = pairing.after_size();
  kind.status.assign(before + after, Status::kSame);
  detail::ParallelFor(before, grain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      const auto number = static_cast<std::uint32_t>(n);
      kind.status[n] = pairing.AfterOf(number) == kNoRow ? Status::kRemoved : compare(number);
    }
  });
  for (std::size_t n = 0; n < before; ++n) {
    kind.removed += kind.status[n] == Status::kRemoved ? 1 : 0;
    kind.moved += kind.status[n] == Status::kMoved ? 1 : 0;
    kind.changed += kind.status[n] == Status::kChanged ? 1 : 0;
  }
  for (std::size_t n = 0; n < after; ++n) {
    const std::uint32_t partner = pairing.BeforeOf(static_cast<std::uint32_t>(n));
    const Status status = kind.status[before + n] = partner == kNoRow ? Status::kAdded : kind.status[partner];
    kind.added += status == Status::kAdded ? 1 : 0;
    if (status == Status::kMoved) kind.moved_from.push_back(partner);
  }
  return kind;
}

}  // namespace

Scene::Scene(std::span<const ViewInput> inputs) {
  std::uint32_t cameras = 0;
  for (const ViewInput& input : inputs) {
    const SceneAtlas& added = atlases_.emplace_back(input, maps_, keyframes_, points_, cameras);
    maps_ += static_cast<std::uint32_t>(added.atlas().maps.size());
    keyframes_ += static_cast<std::uint32_t>(added.numbered.keyframes.size());
    points_ += static_cast<std::uint32_t>(added.numbered.points.size());
    cameras += static_cast<std::uint32_t>(added.atlas().cameras.size());
  }
}

SceneDiff CompareAtlases(const Scene& scene, int threads) {
  if (scene.atlases().size() != 2)
    throw Error(ErrorKind::kUsage, "a diff shows two atlases, not " + std::to_string(scene.atlases().size()));
  const detail::NumberedAtlas &before = scene.atlases()[0].numbered, &after = scene.atlases()[1].numbered;
  const detail::AtlasPairing pairing = detail::PairEntities(before, after, threads);
  const detail::PairComparison comparison(before, after, pairing, detail::Sameness(0));
  return {.keyframes = CompareKind(pairing.keyframes, kKeyFramesPerBlock, threads,
                                   [&](std::uint32_t number) { return StatusOf(comparison.CompareKeyFrame(number)); }),
          .points = CompareKind(pairing.points, kPointsPerBlock, threads,
                                [&](std::uint32_t number) { return StatusOf(comparison.ComparePoint(number)); })};
}

}  // namespace slamdb::view
