// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/detail/settle_places.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace slamdb {
namespace {

MapLink Link(std::size_t first, std::size_t second, double along_x, double scale = 1, std::uint64_t points = 100) {
  MapLink link{.first = first, .second = second, .alignment = {}, .use = LinkUse::kCloses};
  link.alignment.first_from_second =
      Similarity3d{scale, Eigen::Quaterniond::Identity(), Eigen::Vector3d(along_x, 0, 0)};
  link.alignment.evidence.points = points;
  return link;
}

std::vector<MapPlace> InOneFrame(const std::vector<Similarity3d>& places) {
  std::vector<MapPlace> all;
  for (const Similarity3d& place : places) all.push_back({0, place});
  return all;
}

Similarity3d At(double x, double scale = 1) { return {scale, Eigen::Quaterniond::Identity(), {x, 0, 0}}; }

// 1 and 1 make 2, but the third link says 2.3: each takes a third of that.
TEST(SettlePlaces, WhatACycleIsOffByIsSpreadOverItsLinks) {
  std::vector<MapPlace> places = InOneFrame({At(0), At(1), At(2)});
  detail::SettlePlaces({Link(0, 1, 1), Link(1, 2, 1), Link(0, 2, 2.3)}, {{true, 1}, {true, 1}, {true, 1}}, places);
  EXPECT_NEAR(places[0].group_from_map.translation.x(), 0, 1e-12);
  EXPECT_NEAR(places[1].group_from_map.translation.x(), 1.1, 1e-6);
  EXPECT_NEAR(places[2].group_from_map.translation.x(), 2.2, 1e-6);
}

TEST(SettlePlaces, SurerLinksGiveWayLess) {
  std::vector<MapPlace> places = InOneFrame({At(0), At(1), At(2)});
  detail::SettlePlaces({Link(0, 1, 1, 1, 10'000), Link(1, 2, 1, 1, 10'000), Link(0, 2, 2.3, 1, 1)},
                       {{true, 1}, {true, 1}, {true, 1}}, places);
  EXPECT_NEAR(places[2].group_from_map.translation.x(), 2, 1e-3);
}

// The two metric maps keep their scale, and the one between them finds its own.
TEST(SettlePlaces, MetricMapsKeepTheirScale) {
  std::vector<MapPlace> places = InOneFrame({At(0), At(0, 2), At(0)});
  detail::SettlePlaces({Link(0, 1, 0, 2), Link(1, 2, 0, 0.52), Link(0, 2, 0)}, {{true, 1}, {false, 1}, {true, 1}},
                       places);
  EXPECT_EQ(places[0].group_from_map.scale, 1);
  EXPECT_EQ(places[2].group_from_map.scale, 1);
  EXPECT_NEAR(places[1].group_from_map.scale, std::sqrt(2 / 0.52), 1e-6);
}

// Where nothing closes, places are those of the links.
TEST(SettlePlaces, ATreeStaysAsItIs) {
  std::vector<MapPlace> places = InOneFrame({At(0), At(1), At(2.5)});
  std::vector<MapLink> links = {Link(0, 1, 1), Link(1, 2, 1)};
  for (MapLink& link : links) link.use = LinkUse::kJoins;
  detail::SettlePlaces(links, {{true, 1}, {true, 1}, {true, 1}}, places);
  EXPECT_EQ(places[2].group_from_map.translation.x(), 2.5);
}

// Two links of two maps: by one the second map is turned and larger about one place that both see, by the other it is
// turned back and smaller about another. Between them it lies as a quarter turn and a shift say, and both places stay.
class LinksThatTurn : public ::testing::Test {
 protected:
  // Of the first map's `center` and a turn about it.
  MapLink About(const Eigen::Vector3d& center, double degrees, double scale, bool turned) const {
    Similarity3d off{scale, Turn(degrees), Eigen::Vector3d::Zero()};
    off.translation = center - off * center;
    MapLink link = Link(0, 1, 0);
    link.alignment.first_from_second = off * between_;
    link.alignment.center = center;
    if (!turned) return link;
    std::swap(link.first, link.second);
    link.alignment.first_from_second = link.alignment.first_from_second->Inverse();
    link.alignment.center = *link.alignment.first_from_second * center;
    return link;
  }

  static Eigen::Quaterniond Turn(double degrees) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, Eigen::Vector3d::UnitZ()));
  }

  void ExpectBetween(const MapLink& one, const MapLink& other, bool metric_first) const {
    std::vector<MapPlace> places =
        InOneFrame({{}, *About(Eigen::Vector3d::Zero(), 3, 1, false).alignment.first_from_second});
    detail::SettlePlaces({one, other}, {{metric_first, 1}, {!metric_first, 1}}, places);
    const Similarity3d &first = places[0].group_from_map, &second = places[1].group_from_map;
    EXPECT_LT(first.translation.norm() + std::abs(first.scale - 1), 1e-9);
    EXPECT_LT(second.rotation.angularDistance(between_.rotation), 1e-9);
    EXPECT_NEAR(second.scale, 1, 1e-9);
    EXPECT_LT((second.translation - between_.translation).norm(), 1e-9) << second.translation.transpose();
  }

  const Similarity3d between_{1, Turn(90), {1, 2, 3}};
  const Eigen::Vector3d here_{10, -4, 2}, there_{-6, 8, 1};
};

TEST_F(LinksThatTurn, MoveNothingThatBothMapsSee) {
  ExpectBetween(About(here_, 10, 1.1, false), About(there_, -10, 1 / 1.1, false), true);
}

TEST_F(LinksThatTurn, AlsoWhereTheOtherMapIsTheirFirst) {
  ExpectBetween(About(here_, 10, 1.1, true), About(there_, -10, 1 / 1.1, true), true);
  ExpectBetween(About(here_, 10, 1.1, false), About(there_, -10, 1 / 1.1, true), true);
}

// Then the first map moves, and all is told in its frame.
TEST_F(LinksThatTurn, AlsoWhereTheSecondMapStays) {
  ExpectBetween(About(here_, 10, 1.1, false), About(there_, -10, 1 / 1.1, true), false);
}

}  // namespace
}  // namespace slamdb
