// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/align.h"
#include "slamdb/align/close_loops.h"
#include "slamdb/align/join_aligned.h"
#include "slamdb/align/locate.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/optimize/optimize.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/osa_mutator.h"
#include "tests/fuzz/require.h"

namespace slamdb {
namespace {

constexpr std::size_t kMostKeyFrames = 12;  // of an atlas, so that an input takes no second

std::size_t KeyFramesOf(const Atlas& atlas) {
  std::size_t count = 0;
  for (const Map& map : atlas.maps) count += map.keyframes.size();
  return count;
}

void LocateAll(const Atlas& atlas) {
  const Locator locator(atlas, {.threads = 1});
  for (std::size_t map = 0; map < atlas.maps.size(); ++map)
    for (std::size_t row = 0; row < atlas.maps[map].keyframes.size(); ++row) {
      const Localization found = locator.LocateLeftOut({map, row});
      fuzz::Require(found.verdict != LocateVerdict::kFound || found.position.allFinite(), "a found pose is a pose");
    }
}

void AlignWithItself(const Atlas& atlas) {
  for (std::size_t map = 0; map < atlas.maps.size(); ++map) {
    const Alignment alignment = AlignMaps({&atlas, map}, {&atlas, map}, {.threads = 1});
    fuzz::Require(
        alignment.verdict != AlignmentVerdict::kAligned || alignment.first_from_second->translation.allFinite(),
        "an aligned map has a transform");
  }
}

// Works on a copy; what it gives can be written, as any atlas.
template <class Change>
void Changed(const Atlas& atlas, const Change& change) {
  fuzz::MayRefuse([&] {
    Atlas changed = atlas;
    change(changed);
    fuzz::MayRefuse([&] { return EncodeOrbslam3(changed); });
  });
}

}  // namespace
}  // namespace slamdb

// Any atlas can be aligned with itself, joined, closed, optimised and searched for its own pictures, or is refused.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slamdb;
  const std::optional<Atlas> atlas = fuzz::AtlasOf(std::as_bytes(std::span(data, size)));
  if (!atlas || KeyFramesOf(*atlas) > kMostKeyFrames) return 0;
  fuzz::MayRefuse([&] { AlignWithItself(*atlas); });
  fuzz::MayRefuse([&] { LocateAll(*atlas); });
  Changed(*atlas, [](Atlas& changed) { JoinAlignedMaps(changed, {.threads = 1}); });
  Changed(*atlas, [](Atlas& changed) { CloseLoops(changed, {.threads = 1}); });
  Changed(*atlas, [](Atlas& changed) { OptimizeMaps(changed, {.iterations = 5, .threads = 1}); });
  return 0;
}
