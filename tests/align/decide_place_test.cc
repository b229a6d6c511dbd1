// SPDX-License-Identifier: BSD-3-Clause
// What is just inside each limit, and just outside of it.
#include <gmock/gmock.h>

#include <functional>
#include <numbers>

#include "slamdb/align/detail/decide.h"

namespace slamdb::testing {
namespace {

using ::testing::HasSubstr;

// Rotation known so well. The position is known badly, which does not count.
void Turn(Localization& place, double degrees) {
  const double deviation = degrees * std::numbers::pi / 180;
  place.covariance.diagonal() << 1e-8, deviation * deviation, 1e-8, 1, 1, 1;
}

Localization Sure() {
  Localization place;
  place.evidence = {.features = 1000,
                    .candidates = 12,
                    .inliers = 60,
                    .visible = 400,
                    .found_share = 0.5,
                    .cell_share = 0.9,
                    .front_share = 0.02,
                    .checked_share = 0.6,
                    .extent = 0.3,
                    .spread = 0.25,
                    .rms = 1,
                    .focal_factor = 1,
                    .focal_deviation = 0.001};
  Turn(place, 0.05);
  return place;
}

struct Case {
  const char* name;
  LocateVerdict verdict;
  const char* reason;
  std::function<void(Localization&, LocateEvidence&)> change;
};

class DecidePlace : public ::testing::TestWithParam<Case> {};

TEST_P(DecidePlace, GivesItsReason) {
  Localization place = Sure();
  GetParam().change(place, place.evidence);
  detail::GiveVerdict(place);
  EXPECT_EQ(place.verdict, GetParam().verdict) << place.reason;
  EXPECT_THAT(place.reason, HasSubstr(GetParam().reason));
}

constexpr LocateVerdict kFound = LocateVerdict::kFound, kDoubtful = LocateVerdict::kDoubtful,
                        kNotFound = LocateVerdict::kNotFound;
constexpr const char* kContradicts = "the picture contradicts it: only ";
constexpr const char* kHalf = "the picture half confirms it: ";
constexpr const char* kOnePart = "in one part of the picture";
constexpr const char* kOtherCamera = "did that camera take the picture?";

std::string NameOf(const ::testing::TestParamInfo<Case>& each) { return each.param.name; }

INSTANTIATE_TEST_SUITE_P(
    Shares, DecidePlace,
    ::testing::Values(
        Case{"Sure", kFound, "50% of the points that the picture must show are found, in 90% of its parts",
             [](auto&, auto&) {}},
        Case{"Cells", kFound, "in 70% of its parts", [](auto&, auto& evidence) { evidence.cell_share = 0.70; }},
        Case{"HalfOfTheCells", kDoubtful, kHalf, [](auto&, auto& evidence) { evidence.cell_share = 0.69; }},
        Case{"PoorCells", kDoubtful, kHalf, [](auto&, auto& evidence) { evidence.cell_share = 0.40; }},
        Case{"NoCells", kNotFound, kContradicts, [](auto&, auto& evidence) { evidence.cell_share = 0.39; }},
        Case{"Share", kFound, "20% of the points", [](auto&, auto& evidence) { evidence.found_share = 0.20; }},
        Case{"HalfOfTheShare", kDoubtful, kHalf, [](auto&, auto& evidence) { evidence.found_share = 0.19; }},
        Case{"PoorShare", kDoubtful, kHalf, [](auto&, auto& evidence) { evidence.found_share = 0.10; }},
        Case{"NoShare", kNotFound, kContradicts, [](auto&, auto& evidence) { evidence.found_share = 0.09; }},
        // 2000 points are at 1000 keypoints: of these twice the share is found.
        Case{"MorePointsThanKeypoints", kFound, "22% of the points",
             [](auto&, auto& evidence) {
               evidence.visible = 2000;
               evidence.found_share = 0.11;
             }},
        Case{"MorePointsThanKeypointsHalf", kDoubtful, "half confirms it: 18% of the points",
             [](auto&, auto& evidence) {
               evidence.visible = 2000;
               evidence.found_share = 0.09;
             }},
        Case{"MorePointsThanKeypointsNone", kNotFound, "contradicts it: only 8% of the points",
             [](auto&, auto& evidence) {
               evidence.visible = 2000;
               evidence.found_share = 0.04;
             }},
        Case{"NoMoreThanAll", kFound, "100% of the points", [](auto&, auto& evidence) { evidence.visible = 3000; }},
        Case{"NoFeatures", kFound, "50% of the points", [](auto&, auto& evidence) { evidence.features = 0; }}),
    NameOf);

INSTANTIATE_TEST_SUITE_P(
    Points, DecidePlace,
    ::testing::Values(
        Case{"Inliers", kFound, "", [](auto&, auto& evidence) { evidence.inliers = 30; }},
        Case{"FewInliers", kDoubtful, "few points agree", [](auto&, auto& evidence) { evidence.inliers = 29; }},
        Case{"PoorInliers", kDoubtful, "few points agree", [](auto&, auto& evidence) { evidence.inliers = 15; }},
        Case{"TooFewInliers", kNotFound, "too few points agree", [](auto&, auto& evidence) { evidence.inliers = 14; }},
        Case{"Extent", kFound, "", [](auto&, auto& evidence) { evidence.extent = 0.10; }},
        Case{"SmallPatch", kDoubtful, "small patch", [](auto&, auto& evidence) { evidence.extent = 0.09; }},
        Case{"HalfContradicted", kFound, "", [](auto&, auto& evidence) { evidence.contradicting = 30; }},
        Case{"Contradicted", kDoubtful, "another place of the map looks the same",
             [](auto&, auto& evidence) { evidence.contradicting = 31; }},
        Case{"FewInFront", kFound, "", [](auto&, auto& evidence) { evidence.front_share = 0.15; }},
        Case{"InFront", kNotFound, "would hide", [](auto&, auto& evidence) { evidence.front_share = 0.16; }},
        Case{"LittleChecked", kFound, "", [](auto&, auto& evidence) { evidence.checked_share = 0.01; }},
        Case{"NothingChecked", kNotFound, "too few points of the map must show",
             [](auto&, auto& evidence) { evidence.checked_share = 0; }}),
    NameOf);

INSTANTIATE_TEST_SUITE_P(Rotation, DecidePlace,
                         ::testing::Values(Case{"KnownInOneCorner", kFound, "",
                                                [](auto& place, auto& evidence) {
                                                  evidence.spread = 0.15;
                                                  Turn(place, 0.21);
                                                }},
                                           Case{"NotKnownInOneCorner", kDoubtful, kOnePart,
                                                [](auto& place, auto& evidence) {
                                                  evidence.spread = 0.15;
                                                  Turn(place, 0.23);
                                                }},
                                           Case{"NotKnownThoughAllOver", kFound, "",
                                                [](auto& place, auto& evidence) {
                                                  evidence.spread = 0.16;
                                                  Turn(place, 0.23);
                                                }},
                                           Case{"KnownInANarrowView", kFound, "",
                                                [](auto& place, auto& evidence) {
                                                  evidence.extent = 0.14;
                                                  Turn(place, 0.27);
                                                }},
                                           Case{"NotKnownInANarrowView", kDoubtful, kOnePart,
                                                [](auto& place, auto& evidence) {
                                                  evidence.extent = 0.14;
                                                  Turn(place, 0.29);
                                                }},
                                           Case{"NotKnownInAWideView", kFound, "",
                                                [](auto& place, auto& evidence) {
                                                  evidence.extent = 0.15;
                                                  Turn(place, 0.29);
                                                }}),
                         NameOf);

INSTANTIATE_TEST_SUITE_P(FocalLength, DecidePlace,
                         ::testing::Values(Case{"Near", kFound, "",
                                                [](auto&, auto& evidence) { evidence.focal_factor = 1.019; }},
                                           Case{"Longer", kDoubtful, kOtherCamera,
                                                [](auto&, auto& evidence) { evidence.focal_factor = 1.021; }},
                                           Case{"Shorter", kDoubtful, "fits best is 95% of the camera's",
                                                [](auto&, auto& evidence) { evidence.focal_factor = 0.95; }},
                                           Case{"JustShorter", kDoubtful, kOtherCamera,
                                                [](auto&, auto& evidence) { evidence.focal_factor = 0.979; }},
                                           // Five deviations of 0.0082 are 0.041, and of 0.0078 they are 0.039.
                                           Case{"NotTold", kFound, "",
                                                [](auto&, auto& evidence) {
                                                  evidence.focal_factor = 1.04;
                                                  evidence.focal_deviation = 0.0082;
                                                }},
                                           Case{"Told", kDoubtful, kOtherCamera,
                                                [](auto&, auto& evidence) {
                                                  evidence.focal_factor = 1.04;
                                                  evidence.focal_deviation = 0.0078;
                                                }}),
                         NameOf);

// Rotation comes first, then translation; each is that of the axis that is known least.
TEST(PosePrecision, IsThatOfTheAxisKnownLeast) {
  Localization place;
  place.covariance.diagonal() << 1e-8, 1e-8, 4e-8, 0.01, 0.04, 0.01;
  place.covariance(0, 1) = place.covariance(1, 0) = 0.6e-8;  // 1.6e-8 along (1, 1, 0), less than 4e-8
  place.covariance(3, 4) = place.covariance(4, 3) = 0.02;    // (0.05 + sqrt(0.03^2 + 0.04^2)) / 2 = 0.05
  EXPECT_NEAR(PrecisionOf(place).rotation_degrees, 2e-4 * 180 / std::numbers::pi, 1e-9);
  EXPECT_NEAR(PrecisionOf(place).position, std::sqrt(0.05), 1e-9);
}

}  // namespace
}  // namespace slamdb::testing
