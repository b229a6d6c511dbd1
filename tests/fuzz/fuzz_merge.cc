// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/merge/merge.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/osa_mutator.h"
#include "tests/fuzz/require.h"

// Any atlas can be merged with one that is like it, and joined with it, or is refused; the merge proves by itself that
// nothing is lost (kInternal otherwise).
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slamdb;
  const std::optional<Atlas> atlas = fuzz::AtlasOf(std::as_bytes(std::span(data, size)));
  if (!atlas) return 0;
  const Atlas other = fuzz::VariationOf(*atlas, size);
  const auto merge = [&](const MergeOptions& options) {
    fuzz::MayRefuse([&] {
      const MergeResult merged = MergeAtlases({*atlas, other}, options);
      fuzz::Require(!ToJson(merged.report).empty(), "a merge can be told");
      fuzz::MayRefuse([&] { return EncodeOrbslam3(merged.atlas); });
    });
  };
  merge({.ignore_vocabulary = true, .id_maps = true, .threads = 1});
  merge({.same_map = SameMap::kKeepFirst, .threads = 1});
  JoinOptions join;
  if (!atlas->maps.empty()) join.first = atlas->maps[0].id;
  if (!other.maps.empty()) join.second = other.maps[0].id;
  join.first_from_second = Similarity3d{.translation = {0.1, 0, 0}};
  join.fuse = FuseOptions{};
  merge({.ignore_vocabulary = true, .join = join, .threads = 1});
  join.first_from_second.reset();
  if (!atlas->maps.empty())
    for (const KeyFrame& keyframe : atlas->maps[0].keyframes) join.anchors.push_back({keyframe.id, keyframe.id});
  merge({.ignore_vocabulary = true, .join = join, .threads = 1});
  return 0;
}
