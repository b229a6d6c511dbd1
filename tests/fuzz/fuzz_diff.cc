// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/checks/check.h"
#include "slamdb/edit/diff/diff.h"
#include "slamdb/edit/ids/renumber.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/osa_mutator.h"
#include "tests/fuzz/require.h"

// Any atlas is the same as itself; what it lost and won against another one is what that one won and lost against it;
// and a sound one stays what it is under new numbers.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slamdb;
  const std::optional<Atlas> atlas = fuzz::AtlasOf(std::as_bytes(std::span(data, size)));
  if (!atlas) return 0;
  const DiffOptions options{.threads = 1};
  fuzz::Require(DiffAtlases(*atlas, *atlas, options).verdict() == AtlasDiff::Verdict::kSame, "an atlas is as itself");
  const Atlas other = fuzz::VariationOf(*atlas, size);
  const AtlasDiff there = DiffAtlases(*atlas, other, options), back = DiffAtlases(other, *atlas, options);
  fuzz::Require((there.verdict() == AtlasDiff::Verdict::kSame) == (back.verdict() == AtlasDiff::Verdict::kSame),
                "the same is the same both ways");
  fuzz::Require(there.keyframes.before == back.keyframes.after && there.points.before == back.points.after,
                "before and after change places");
  fuzz::Require(!ToJson(there).empty(), "a difference can be told");
  CheckOptions check;
  check.threads = 1;
  if (!CheckAtlas(*atlas, check).ok()) return 0;  // what dangles gets other numbers
  fuzz::MayRefuse([&] {
    Atlas renumbered = *atlas;
    const IdMap ids = Renumber(renumbered, {.threads = 1});
    fuzz::Require(DiffAtlases(*atlas, renumbered, options).verdict() != AtlasDiff::Verdict::kDifferent,
                  "new numbers are no difference");
  });
  return 0;
}
