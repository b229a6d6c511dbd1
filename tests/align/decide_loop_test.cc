// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <functional>

#include "slamdb/align/detail/decide.h"

namespace slamdb::testing {
namespace {

using ::testing::HasSubstr;

constexpr double kDepth = 2;

// As sure as that of a real map (l1 of the second laboratory).
Loop Sure() {
  Loop loop;
  loop.gap = {.translation = 0.5, .path = 20, .degrees = 1, .scale = 0.86};
  loop.evidence = {.agreeing = 16,
                   .first_keyframes = 4,
                   .second_keyframes = 11,
                   .contradicting = 0,
                   .points = 246,
                   .extent = 0.2,
                   .found_share = 0.59,
                   .cell_share = 1,
                   .front_share = 0.003,
                   .views = 31,
                   .agreeing_views = 15};
  return loop;
}

struct Case {
  const char* name;
  LoopVerdict verdict;
  const char* reason;
  std::function<void(Loop&)> change;
};

class DecideLoop : public ::testing::TestWithParam<Case> {};

TEST_P(DecideLoop, GivesItsReason) {
  Loop loop = Sure();
  GetParam().change(loop);
  detail::GiveVerdict(loop, kDepth);
  EXPECT_EQ(loop.verdict, GetParam().verdict) << loop.reason;
  EXPECT_THAT(loop.reason, HasSubstr(GetParam().reason));
}

INSTANTIATE_TEST_SUITE_P(
    All, DecideLoop,
    ::testing::Values(
        Case{"Sure", LoopVerdict::kMissed, "59% of the points", [](Loop&) {}},
        // A corridor whose walls repeat: a map drifts by less.
        Case{"FartherThanDrift", LoopVerdict::kDoubtful, "may repeat itself", [](Loop& loop) { loop.gap.path = 4.9; }},
        Case{"AsFarAsDrift", LoopVerdict::kMissed, "", [](Loop& loop) { loop.gap.path = 5.1; }},
        Case{"NearIdentity", LoopVerdict::kClosed, "where the pictures do",
             [](Loop& loop) { loop.gap = {.translation = 0.01 * kDepth, .degrees = 0.5, .scale = 1.01}; }},
        // A look-alike room: many pairs agree, and the pictures show nothing else of it.
        Case{"LookAlike", LoopVerdict::kRefuted, "the pictures contradict it",
             [](Loop& loop) {
               loop.evidence.found_share = 0.11;
               loop.evidence.cell_share = 0.37;
             }},
        Case{"InFront", LoopVerdict::kRefuted, "would hide", [](Loop& loop) { loop.evidence.front_share = 0.3; }},
        Case{"FewViews", LoopVerdict::kRefuted, "too few pictures",
             [](Loop& loop) { loop.evidence.agreeing_views = 2; }},
        Case{"HalfConfirmed", LoopVerdict::kDoubtful, "half confirm",
             [](Loop& loop) { loop.evidence.found_share = 0.25; }},
        Case{"SmallPatch", LoopVerdict::kDoubtful, "small patch", [](Loop& loop) { loop.evidence.extent = 0.1; }},
        Case{"FewPairs", LoopVerdict::kDoubtful, "too few", [](Loop& loop) { loop.evidence.agreeing = 2; }},
        Case{"OneKeyFrame", LoopVerdict::kDoubtful, "too few", [](Loop& loop) { loop.evidence.first_keyframes = 1; }},
        Case{"OneLaterKeyFrame", LoopVerdict::kDoubtful, "too few",
             [](Loop& loop) { loop.evidence.second_keyframes = 1; }},
        Case{"FewPoints", LoopVerdict::kDoubtful, "too few", [](Loop& loop) { loop.evidence.points = 49; }},
        Case{"Contradicted", LoopVerdict::kDoubtful, "another transform",
             [](Loop& loop) { loop.evidence.contradicting = 6; }}),
    [](const auto& each) { return each.param.name; });

// Just inside of the limits, and just outside.
INSTANTIATE_TEST_SUITE_P(
    Limits, DecideLoop,
    ::testing::Values(
        Case{"Cells", LoopVerdict::kMissed, "in 85%", [](Loop& loop) { loop.evidence.cell_share = 0.85; }},
        Case{"HalfOfTheCells", LoopVerdict::kDoubtful, "half confirm",
             [](Loop& loop) { loop.evidence.cell_share = 0.84; }},
        Case{"PoorCells", LoopVerdict::kDoubtful, "half confirm", [](Loop& loop) { loop.evidence.cell_share = 0.75; }},
        Case{"NoCells", LoopVerdict::kRefuted, "contradict it", [](Loop& loop) { loop.evidence.cell_share = 0.74; }},
        Case{"Share", LoopVerdict::kMissed, "28%", [](Loop& loop) { loop.evidence.found_share = 0.28; }},
        Case{"PoorShare", LoopVerdict::kDoubtful, "half confirm", [](Loop& loop) { loop.evidence.found_share = 0.20; }},
        Case{"NoShare", LoopVerdict::kRefuted, "contradict it", [](Loop& loop) { loop.evidence.found_share = 0.19; }},
        Case{"FewInFront", LoopVerdict::kMissed, "", [](Loop& loop) { loop.evidence.front_share = 0.15; }},
        Case{"Fewest", LoopVerdict::kMissed, "",
             [](Loop& loop) {
               loop.evidence.agreeing = 3;
               loop.evidence.first_keyframes = loop.evidence.second_keyframes = 2;
               loop.evidence.points = 50;
               loop.evidence.agreeing_views = 3;
               loop.evidence.extent = 0.15;
               loop.evidence.contradicting = 1;
             }},
        Case{"HardlyContradicted", LoopVerdict::kMissed, "", [](Loop& loop) { loop.evidence.contradicting = 5; }}),
    [](const auto& each) { return each.param.name; });

// Each of the three alone leaves a loop open.
INSTANTIATE_TEST_SUITE_P(
    Gaps, DecideLoop,
    ::testing::Values(
        Case{"Closed", LoopVerdict::kClosed, "",
             [](Loop& loop) {
               loop.gap = {.translation = 0.019 * kDepth, .path = 20, .degrees = 0.99, .scale = 0.981};
             }},
        Case{"Shifted", LoopVerdict::kMissed, "",
             [](Loop& loop) { loop.gap = {.translation = 0.021 * kDepth, .path = 20, .degrees = 0, .scale = 1}; }},
        Case{"Turned", LoopVerdict::kMissed, "",
             [](Loop& loop) { loop.gap = {.translation = 0, .path = 20, .degrees = 1.01, .scale = 1}; }},
        Case{"Larger", LoopVerdict::kMissed, "",
             [](Loop& loop) { loop.gap = {.translation = 0, .path = 20, .degrees = 0, .scale = 1.021}; }},
        Case{"Smaller", LoopVerdict::kMissed, "",
             [](Loop& loop) { loop.gap = {.translation = 0, .path = 20, .degrees = 0, .scale = 0.979}; }}),
    [](const auto& each) { return each.param.name; });

}  // namespace
}  // namespace slamdb::testing
