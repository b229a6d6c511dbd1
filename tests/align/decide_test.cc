// SPDX-License-Identifier: BSD-3-Clause
// What is just inside each limit, and just outside of it.
#include "slamdb/align/detail/decide.h"

#include <gmock/gmock.h>

#include <functional>
#include <numbers>

namespace slamdb::testing {
namespace {

using ::testing::HasSubstr;

// Rotation known so well. Translation and scale are known badly, which does not count.
void Turn(Alignment& alignment, double degrees) {
  const double deviation = degrees * std::numbers::pi / 180;
  alignment.covariance.diagonal() << 1e-8, 1e-8, deviation * deviation, 1, 1, 1, 1;
}

Alignment Sure() {
  Alignment alignment;
  alignment.evidence = {.candidates = 150,
                        .agreeing = 100,
                        .keyframes = 12,
                        .contradicting = 0,
                        .points = 300,
                        .extent = 0.4,
                        .found_share = 0.5,
                        .cell_share = 0.95,
                        .front_share = 0.01,
                        .views = 40,
                        .agreeing_views = 30,
                        .overlap = 0.5,
                        .rms = 1};
  Turn(alignment, 0.05);
  return alignment;
}

struct Case {
  const char* name;
  AlignmentVerdict verdict;
  const char* reason;
  std::function<void(AlignmentEvidence&)> change;
};

class Decide : public ::testing::TestWithParam<Case> {};

TEST_P(Decide, GivesItsReason) {
  Alignment alignment = Sure();
  GetParam().change(alignment.evidence);
  detail::GiveVerdict(alignment);
  EXPECT_EQ(alignment.verdict, GetParam().verdict) << alignment.reason;
  EXPECT_THAT(alignment.reason, HasSubstr(GetParam().reason));
}

constexpr AlignmentVerdict kAligned = AlignmentVerdict::kAligned, kDoubtful = AlignmentVerdict::kDoubtful,
                           kNoOverlap = AlignmentVerdict::kNoOverlap;
constexpr const char* kContradict = "the pictures contradict it: only ";
constexpr const char* kHalf = "the pictures half confirm it: ";
constexpr const char* kTooFew = "too few keyframes or points agree";

std::string NameOf(const ::testing::TestParamInfo<Case>& each) { return each.param.name; }

INSTANTIATE_TEST_SUITE_P(
    Shares, Decide,
    ::testing::Values(
        Case{"Sure", kAligned,
             "50% of the points that pictures of the other map must show are found, in 95% of the parts of these",
             [](auto&) {}},
        Case{"Cells", kAligned, "in 85% of", [](auto& evidence) { evidence.cell_share = 0.85; }},
        Case{"HalfOfTheCells", kDoubtful, kHalf, [](auto& evidence) { evidence.cell_share = 0.84; }},
        Case{"PoorCells", kDoubtful, kHalf, [](auto& evidence) { evidence.cell_share = 0.75; }},
        Case{"NoCells", kNoOverlap, kContradict, [](auto& evidence) { evidence.cell_share = 0.74; }},
        Case{"Share", kAligned, "20% of the points", [](auto& evidence) { evidence.found_share = 0.20; }},
        Case{"HalfOfTheShare", kDoubtful, kHalf, [](auto& evidence) { evidence.found_share = 0.19; }},
        Case{"PoorShare", kDoubtful, kHalf, [](auto& evidence) { evidence.found_share = 0.15; }},
        Case{"NoShare", kNoOverlap, kContradict, [](auto& evidence) { evidence.found_share = 0.14; }},
        Case{"FewInFront", kAligned, "", [](auto& evidence) { evidence.front_share = 0.15; }},
        Case{"InFront", kNoOverlap, "16% of the points would hide",
             [](auto& evidence) { evidence.front_share = 0.16; }}),
    NameOf);

INSTANTIATE_TEST_SUITE_P(
    Counts, Decide,
    ::testing::Values(Case{"Views", kAligned, "", [](auto& evidence) { evidence.agreeing_views = 3; }},
                      Case{"FewViews", kNoOverlap, "too few pictures",
                           [](auto& evidence) { evidence.agreeing_views = 2; }},
                      Case{"Extent", kAligned, "", [](auto& evidence) { evidence.extent = 0.15; }},
                      Case{"SmallPatch", kDoubtful, "small patch", [](auto& evidence) { evidence.extent = 0.14; }},
                      Case{"KeyFrames", kAligned, "", [](auto& evidence) { evidence.keyframes = 3; }},
                      Case{"FewKeyFrames", kDoubtful, kTooFew, [](auto& evidence) { evidence.keyframes = 2; }},
                      Case{"Points", kAligned, "", [](auto& evidence) { evidence.points = 50; }},
                      Case{"FewPoints", kDoubtful, kTooFew, [](auto& evidence) { evidence.points = 49; }},
                      Case{"HardlyContradicted", kAligned, "", [](auto& evidence) { evidence.contradicting = 35; }},
                      Case{"Contradicted", kDoubtful, "agree on another transform",
                           [](auto& evidence) { evidence.contradicting = 36; }}),
    NameOf);

TEST(DecideRotation, MustBeKnownWithinAThirdOfADegree) {
  Alignment alignment = Sure();
  Turn(alignment, 0.29);
  detail::GiveVerdict(alignment);
  EXPECT_EQ(alignment.verdict, kAligned) << alignment.reason;
  Turn(alignment, 0.31);
  detail::GiveVerdict(alignment);
  EXPECT_EQ(alignment.verdict, kDoubtful);
  EXPECT_THAT(alignment.reason, HasSubstr("their rotation is not known well"));
}

TEST(AlignmentPrecision, IsThatOfTheAxisKnownLeast) {
  Alignment alignment;
  alignment.covariance.diagonal() << 1e-8, 1e-8, 4e-8, 0.01, 0.04, 0.01, 9e-4;
  alignment.covariance(3, 4) = alignment.covariance(4, 3) = 0.02;  // (0.05 + sqrt(0.03^2 + 0.04^2)) / 2 = 0.05
  const AlignmentPrecision precision = PrecisionOf(alignment);
  EXPECT_NEAR(precision.rotation_degrees, 2e-4 * 180 / std::numbers::pi, 1e-9);
  EXPECT_NEAR(precision.translation, std::sqrt(0.05), 1e-9);
  EXPECT_NEAR(precision.scale, 0.03, 1e-9);
}

}  // namespace
}  // namespace slamdb::testing
