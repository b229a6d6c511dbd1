// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/frame/transform_atlas.h"
#include "slamdb/edit/part/cull.h"
#include "slamdb/edit/part/extract.h"
#include "slamdb/edit/part/fragments.h"
#include "slamdb/edit/part/shrink.h"
#include "slamdb/edit/part/split.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/osa_mutator.h"
#include "tests/fuzz/require.h"

// Parts can be taken of any atlas, or are refused; counts of what went are those of what is left.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slamdb;
  const std::optional<Atlas> atlas = fuzz::AtlasOf(std::as_bytes(std::span(data, size)));
  if (!atlas) return 0;
  const auto part = [&](const auto& take) {
    fuzz::MayRefuse([&] {
      Atlas taken = *atlas;
      const SubsetReport removed = take(taken);
      fuzz::Require(removed.before == CountEntities(*atlas) && removed.after == CountEntities(taken),
                    "what went is counted");
      fuzz::MayRefuse([&] { return EncodeOrbslam3(taken); });
    });
  };
  for (const Border border : {Border::kSmart, Border::kStrict, Border::kCompletePoints})
    part([&](Atlas& taken) {
      ExtractOptions options;
      options.part.every = 2;
      options.border = border;
      options.threads = 1;
      return Extract(taken, options).removed;
    });
  part([&](Atlas& taken) {
    CullOptions options = CullOptions::Orbslam3();
    options.max_error = 3;
    options.min_parallax = 1;
    options.unseen_since = 0;
    options.threads = 1;
    return Cull(taken, options).removed;
  });
  part([&](Atlas& taken) {
    return Shrink(taken,
                  {
                      .target_keyframes = 2,
                      .min_points = 2,
                  })
        .removed;
  });
  part([&](Atlas& taken) {
    return Shrink(taken, {.target_bytes = 6000, .for_localization = true, .threads = 1}).removed;
  });
  part([&](Atlas& taken) {
    return DropFragments(taken, {.min_keyframes = 2, .order = MapOrder::kSize, .threads = 1}).removed;
  });
  fuzz::MayRefuse([&] {
    const AtlasIndex index(*atlas);
    for (const SplitBy by : {SplitBy::kMap, SplitBy::kSession, SplitBy::kComponent})
      fuzz::MayRefuse([&] {
        for (const Part& taken : SplitAtlas(index, {.by = by})) {
          SubsetReport removed;
          fuzz::Require(!TakePart(index, taken, Border::kSmart, removed, 1).maps.empty(), "a part has a map");
        }
      });
  });
  fuzz::MayRefuse([&] {
    Atlas moved = *atlas;
    TransformAtlas(moved, {.to = Similarity3d{.scale = 2, .translation = {1, 2, 3}}, .threads = 1});
  });
  return 0;
}
