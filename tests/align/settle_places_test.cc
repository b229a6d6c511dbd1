// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/detail/settle_places.h"

#include <gtest/gtest.h>

#include <cmath>

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

}  // namespace
}  // namespace slamdb
