// SPDX-License-Identifier: BSD-3-Clause
// The options of all edits are of one mould: they tell their progress, on one thread or several.
#include <gmock/gmock.h>

#include <functional>
#include <stdexcept>

#include "slamdb/edit/diff/diff.h"
#include "slamdb/edit/frame/transform_atlas.h"
#include "slamdb/edit/ids/renumber.h"
#include "slamdb/edit/landmarks/landmarks.h"
#include "slamdb/edit/merge/merge.h"
#include "slamdb/edit/part/cull.h"
#include "slamdb/edit/part/extract.h"
#include "slamdb/edit/part/fragments.h"
#include "slamdb/edit/part/shrink.h"
#include "slamdb/edit/part/split.h"
#include "slamdb/edit/repair/recover.h"
#include "slamdb/model/digest.h"
#include "slamdb/synthetic/synthesize.h"

namespace slamdb {
namespace {

struct Verb {
  const char* name;
  std::function<void(Atlas&, int threads, const Progress&)> run;
};
void PrintTo(const Verb& verb, std::ostream* out) { *out << verb.name; }

const Verb kVerbs[] = {
    {"Check",
     [](Atlas& atlas, int threads, const Progress& progress) {
       static_cast<void>(CheckAtlas(atlas, {.threads = threads, .progress = progress}));
     }},
    {"Repair", [](Atlas& atlas, int threads,
                  const Progress& progress) { RepairAtlas(atlas, {.threads = threads, .progress = progress}); }},
    {"Undo",
     [](Atlas& atlas, int threads, const Progress& progress) {
       UndoRepair(atlas, RepairAtlas(atlas).journal, {.threads = threads, .progress = progress});
     }},
    {"Recover", [](Atlas& atlas, int threads,
                   const Progress& progress) { RecoverAtlas(atlas, {.threads = threads, .progress = progress}); }},
    {"Cull", [](Atlas& atlas, int threads,
                const Progress& progress) { Cull(atlas, {.max_error = 2, .threads = threads, .progress = progress}); }},
    {"Shrink",
     [](Atlas& atlas, int threads, const Progress& progress) {
       Shrink(atlas, {.target_keyframes = 3, .threads = threads, .progress = progress});
     }},
    {"Extract",
     [](Atlas& atlas, int threads, const Progress& progress) {
       Extract(atlas, {.part = {.every = 2}, .threads = threads, .progress = progress});
     }},
    {"Fragments", [](Atlas& atlas, int threads,
                     const Progress& progress) { DropFragments(atlas, {.threads = threads, .progress = progress}); }},
    {"Transform",
     [](Atlas& atlas, int threads, const Progress& progress) {
       TransformAtlas(atlas, {.to = Similarity3d{.scale = 2}, .threads = threads, .progress = progress});
     }},
    {"Renumber", [](Atlas& atlas, int threads,
                    const Progress& progress) { Renumber(atlas, {.threads = threads, .progress = progress}); }},
    {"Merge",
     [](Atlas& atlas, int threads, const Progress& progress) {
       atlas = MergeAtlases({atlas, atlas}, {.threads = threads, .progress = progress}).atlas;
     }},
    {"Join",
     [](Atlas& atlas, int threads, const Progress& progress) {
       JoinMaps(atlas, {.first = atlas.maps[0].id,
                        .second = atlas.maps[1].id,
                        .first_from_second = Similarity3d(),
                        .fuse = FuseOptions(),
                        .threads = threads,
                        .progress = progress});
     }},
    {"Diff",
     [](Atlas& atlas, int threads, const Progress& progress) {
       static_cast<void>(DiffAtlases(atlas, atlas, {.threads = threads, .progress = progress}));
     }},
    {"MakeLandmarks",
     [](Atlas& atlas, int threads, const Progress& progress) {
       MakeLandmarks(atlas, {.threads = threads, .progress = progress});
     }},
};

class EveryVerb : public ::testing::TestWithParam<Verb> {
 protected:
  Atlas atlas_ = SynthesizeAtlas({.sensor = Sensor::kStereo, .maps = 2, .keyframes = 6, .points = 60, .features = 60});
};
std::string NameOfVerb(const ::testing::TestParamInfo<Verb>& verb) { return verb.param.name; }
INSTANTIATE_TEST_SUITE_P(All, EveryVerb, ::testing::ValuesIn(kVerbs), NameOfVerb);

TEST_P(EveryVerb, TellsItsProgressToTheEnd) {
  for (const int threads : {1, 3}) {
    Atlas atlas = atlas_;
    std::vector<double> fractions;
    GetParam().run(atlas, threads, [&](std::string_view stage, double fraction) {
      EXPECT_FALSE(stage.empty());
      fractions.push_back(fraction);
    });
    ASSERT_FALSE(fractions.empty());
    EXPECT_EQ(fractions.back(), 1);
    for (const double fraction : fractions) EXPECT_TRUE(fraction > 0 && fraction <= 1) << fraction;
  }
}

TEST_P(EveryVerb, IsCancelledByItsListener) {
  const auto cancel = [](std::string_view, double) { throw std::runtime_error("cancelled"); };
  EXPECT_THROW(GetParam().run(atlas_, 1, cancel), std::runtime_error);
}

// Who cancels at the first word has an atlas as it was.
TEST(EditOptions, ACancelledRepairHasChangedNothing) {
  Atlas broken = SynthesizeAtlas({.keyframes = 5, .points = 60, .features = 90});
  broken.next_ids = {};
  const std::uint64_t before = HashOf(broken);
  const Progress cancel = [](std::string_view, double) { throw std::runtime_error("cancelled"); };
  EXPECT_THROW(RepairAtlas(broken, {.progress = cancel}), std::runtime_error);
  EXPECT_EQ(HashOf(broken), before);
  EXPECT_THROW(RecoverAtlas(broken, {.progress = cancel}), std::runtime_error);
  EXPECT_EQ(HashOf(broken), before);
  EXPECT_FALSE(RepairAtlas(broken).applied.empty()) << "there was something to change";
}

}  // namespace
}  // namespace slamdb
