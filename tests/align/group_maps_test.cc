// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/detail/group_maps.h"

#include <gmock/gmock.h>

#include <numbers>

namespace slamdb {
namespace {

using ::testing::ElementsAre;

MapLink Link(std::size_t first, std::size_t second, double along_x, double scale = 1) {
  MapLink link{.first = first, .second = second, .alignment = {}};
  link.alignment.verdict = AlignmentVerdict::kAligned;
  link.alignment.first_from_second = Similarity3d{scale, Eigen::Quaterniond::Identity(), {along_x, 0, 0}};
  return link;
}

std::vector<std::size_t> GroupsOf(std::vector<MapLink>& links, std::size_t maps, bool metric = true) {
  std::vector<std::size_t> groups;
  for (const MapPlace& place : detail::GroupMaps(links, std::vector<detail::MapTraits>(maps, {metric, 1.0})))
    groups.push_back(place.group);
  return groups;
}

TEST(GroupMaps, LinksJoinAndClose) {
  std::vector<MapLink> links = {Link(0, 1, 1), Link(1, 2, 1), Link(0, 2, 2.01)};
  EXPECT_THAT(GroupsOf(links, 4), ElementsAre(0, 0, 0, 3));
  EXPECT_EQ(links[0].use, LinkUse::kJoins);
  EXPECT_EQ(links[2].use, LinkUse::kCloses);
}

// One of three is wrong, and nothing says which.
TEST(GroupMaps, ATriangleThatDoesNotCloseIsNoGroup) {
  std::vector<MapLink> links = {Link(0, 1, 1), Link(1, 2, 1), Link(0, 2, 2.3)};
  EXPECT_THAT(GroupsOf(links, 3), ElementsAre(0, 1, 2));
  for (const MapLink& link : links) EXPECT_EQ(link.use, LinkUse::kContradicts);
}

// Map 3 is bent: the others say the same of each other without it, whichever links come first.
TEST(GroupMaps, TheMapThatContradictsAllOthersIsSetApart) {
  const std::vector<MapLink> sound = {Link(0, 1, 1), Link(0, 2, 2), Link(1, 2, 1)},
                             bent = {Link(0, 3, 3), Link(1, 3, 2.5), Link(2, 3, 0.5)};
  for (const bool bent_first : {false, true}) {
    std::vector<MapLink> links = bent_first ? bent : sound;
    links.insert(links.end(), (bent_first ? sound : bent).begin(), (bent_first ? sound : bent).end());
    EXPECT_THAT(GroupsOf(links, 4), ElementsAre(0, 0, 0, 3)) << bent_first;
  }
}

// Maps that do not meet the cycle keep their group.
TEST(GroupMaps, OtherGroupsStay) {
  std::vector<MapLink> links = {Link(0, 1, 1), Link(1, 2, 1), Link(0, 2, 2.3), Link(3, 4, 1), Link(4, 5, 1)};
  EXPECT_THAT(GroupsOf(links, 6), ElementsAre(0, 1, 2, 3, 3, 3));
}

// 1.02 * 0.99: each is within what a map without scale may be off by, and neither is a metre any more.
TEST(GroupMaps, MetricMapsHaveOneScale) {
  std::vector<MapLink> links = {Link(0, 1, 0, 1.02), Link(1, 2, 0, 0.99)};
  const std::vector<MapPlace> places = detail::GroupMaps(links, {{true, 1}, {false, 1}, {true, 1}});
  EXPECT_NEAR(places[2].group_from_map.scale, 1, 1e-12);
  EXPECT_NEAR(places[1].group_from_map.scale, 1.02, 1e-12);
}

TEST(GroupMaps, MetricMapsOfTwoScalesAreNotJoined) {
  std::vector<MapLink> links = {Link(0, 1, 0, 2), Link(1, 2, 0, 0.7)};
  const std::vector<MapPlace> places = detail::GroupMaps(links, {{true, 1}, {false, 1}, {true, 1}});
  EXPECT_EQ(places[1].group, 0U);
  EXPECT_EQ(places[2].group, 2U);
  EXPECT_EQ(links[1].use, LinkUse::kContradicts);
}

Eigen::Quaterniond Turn(double degrees, const Eigen::Vector3d& axis) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis));
}

// What the second link sees is at (1, 2, 3) of map 2. A quarter turn about x makes (1, -3, 2) of it, and 0.99 of that
// with the shift (5, -3, 2) of map 1. There a quarter turn about z, 1.02 and a shift make (4.06, 7.1, 5.04) of map 0.
// That stays when map 2 gets the scale of map 0, whichever of the link's maps is its first.
TEST(GroupMaps, ScalesAboutWhatBothMapsSee) {
  const Similarity3d zero_from_one{1.02, Turn(90, Eigen::Vector3d::UnitZ()), {1, 2, 3}};
  const Similarity3d one_from_two{0.99, Turn(90, Eigen::Vector3d::UnitX()), {4.01, -0.03, 0.02}};
  MapLink to_one = Link(1, 2, 0), to_two = Link(2, 1, 0), base = Link(0, 1, 0);
  base.alignment.first_from_second = zero_from_one;
  to_one.alignment.first_from_second = one_from_two;
  to_one.alignment.center = {5, -3, 2};
  to_two.alignment.first_from_second = one_from_two.Inverse();
  to_two.alignment.center = {1, 2, 3};
  for (const MapLink& link : {to_one, to_two}) {
    std::vector<MapLink> links = {base, link};
    const std::vector<MapPlace> places = detail::GroupMaps(links, {{true, 1}, {false, 1}, {true, 1}});
    EXPECT_THAT(places, ElementsAre(::testing::Field(&MapPlace::group, 0), ::testing::Field(&MapPlace::group, 0),
                                    ::testing::Field(&MapPlace::group, 0)));
    EXPECT_NEAR(places[2].group_from_map.scale, 1, 1e-12);
    EXPECT_LT((places[2].group_from_map * Eigen::Vector3d(1, 2, 3) - Eigen::Vector3d(4.06, 7.1, 5.04)).norm(), 1e-12);
    EXPECT_LT((places[1].group_from_map * Eigen::Vector3d(5, -3, 2) - Eigen::Vector3d(4.06, 7.1, 5.04)).norm(), 1e-12);
  }
}

// A link that is a degree off closes where what both maps see stays, and not where it goes 10 * 1 degree = 0.17 away.
TEST(GroupMaps, ACycleClosesWhereBothMapsSee) {
  const Similarity3d turn{1, Turn(1, Eigen::Vector3d::UnitZ()), Eigen::Vector3d::Zero()};
  const Eigen::Vector3d center(10, 0, 0);
  for (const bool about_center : {true, false}) {
    std::vector<MapLink> links = {Link(0, 1, 1), Link(1, 2, 1), Link(0, 2, 2)};
    Alignment& last = links[2].alignment;
    last.center = center;
    last.first_from_second = turn * *last.first_from_second;
    if (about_center) last.first_from_second->translation += center - turn * center;
    detail::GroupMaps(links, {{true, 1}, {true, 1}, {true, 1}});
    EXPECT_EQ(links[2].use == LinkUse::kCloses, about_center);
  }
}

}  // namespace
}  // namespace slamdb
