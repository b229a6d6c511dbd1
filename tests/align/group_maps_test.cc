// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/detail/group_maps.h"

#include <gmock/gmock.h>

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

}  // namespace
}  // namespace slamdb
