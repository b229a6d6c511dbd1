// SPDX-License-Identifier: BSD-3-Clause
// Matching points of two local maps by their descriptors.
#include "slamdb/align/detail/match_points.h"

#include <gmock/gmock.h>

#include <set>

#include "tests/align/worlds.h"

namespace slamdb::testing {
namespace {

using detail::LocalMap;
using detail::MatchPoints;
using detail::PointMatch;
using detail::Search;

// One map of the pair with itself, of which single points are given descriptors.
class Matching : public ::testing::Test {
 protected:
  Matching() {
    for (std::uint32_t point = 0; point < 6; ++point) {
      first_.points.push_back({point, {}});
      second_.points.push_back({point, {}});
      first_.descriptors.push_back(With(point, 0));
      second_.descriptors.push_back(With(point, 0));
      first_.nodes.push_back(point % 2);
      second_.nodes.push_back(point % 2);
    }
  }

  // Descriptor `number`, with its first bits turned; two numbers differ in 128 bits.
  static Descriptor With(std::uint32_t number, int turned) {
    Descriptor descriptor{};
    for (std::size_t byte = 0; byte < 32; ++byte)
      descriptor[byte] = (byte / 4 & (number + 1)) % 2 == (byte & 1) ? 0xFF : 0;
    for (std::size_t byte = 0; byte < 32; ++byte)
      descriptor[byte] ^= static_cast<std::uint8_t>(number * 37 + byte * number);
    for (int bit = 0; bit < turned; ++bit)
      descriptor[static_cast<std::size_t>(bit / 8)] ^= static_cast<std::uint8_t>(1U << bit % 8);
    return descriptor;
  }

  std::set<std::pair<std::uint32_t, std::uint32_t>> Matched(Search search = Search::kAll) const {
    std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (const PointMatch& match : MatchPoints(Views(), first_, Views(), second_, search))
      EXPECT_TRUE(pairs.emplace(match.first.point, match.second.point).second);
    return pairs;
  }

  const detail::MapViews& Views() const { return two_.maps[0].views; }
  bool Has(std::uint32_t first, std::uint32_t second) const { return Matched().contains({first, second}); }

  PreparedPair two_{SmallPair()};
  LocalMap first_, second_;
};

TEST_F(Matching, EqualDescriptorsMatch) {
  EXPECT_EQ(Matched().size(), 6U);
  EXPECT_TRUE(Has(3, 3));
}

TEST_F(Matching, TooManyBitsAreNoMatch) {
  second_.descriptors[3] = With(3, detail::kMostBits);
  EXPECT_TRUE(Has(3, 3));
  second_.descriptors[3] = With(3, detail::kMostBits + 1);
  EXPECT_FALSE(Has(3, 3));
}

TEST_F(Matching, ARivalElsewhereMakesItDoubtful) {
  first_.descriptors[3] = second_.descriptors[3] = With(3, 20);
  second_.descriptors[4] = With(3, 1);  // 19 bits off, where the best is equal: no rival of 0
  EXPECT_TRUE(Has(3, 3));
  second_.descriptors[3] = With(3, 0);  // 20 bits off now, and the other 19
  EXPECT_FALSE(Has(3, 3));
  EXPECT_FALSE(Has(3, 4));
}

TEST_F(Matching, TheSameThingTwiceIsNoRival) {
  second_.points[4].point = second_.points[3].point;  // at one place
  first_.descriptors[3] = With(3, 20);
  second_.descriptors[3] = With(3, 0);
  second_.descriptors[4] = With(3, 1);
  const auto pairs = Matched();
  EXPECT_TRUE(pairs.contains({3, 3}));
}

TEST_F(Matching, OnlyMutualBestMatch) {
  first_.descriptors[2] = With(3, 30);
  second_.descriptors[3] = With(3, 0);
  EXPECT_FALSE(Has(2, 3)) << "3 is nearer";
  EXPECT_TRUE(Has(3, 3));
}

TEST_F(Matching, NodesKeepApartWhatIsNotInOne) {
  EXPECT_EQ(Matched(Search::kNodes).size(), 6U);
  second_.nodes[3] = 0;
  EXPECT_FALSE(Matched(Search::kNodes).contains({3, 3}));
  second_.nodes[3] = first_.nodes[3] = LocalMap::kNoNode;
  EXPECT_FALSE(Matched(Search::kNodes).contains({3, 3})) << "unknown is not one node";
  EXPECT_TRUE(Has(3, 3));
}

TEST_F(Matching, OfNothing) {
  EXPECT_TRUE(MatchPoints(Views(), {}, Views(), second_, Search::kAll).empty());
  EXPECT_TRUE(MatchPoints(Views(), first_, Views(), {}, Search::kNodes).empty());
}

TEST(LocalMap, HoldsEachPointOfTheNeighbourhoodOnce) {
  const PreparedPair two(SmallPair());
  const detail::MapViews& map = two.maps[0].views;
  const LocalMap alone = detail::MakeLocalMap(two.maps[0], 5, 0), with = detail::MakeLocalMap(two.maps[0], 5, 4);
  EXPECT_EQ(alone.points.size(), map.SeenBy(5).size());
  std::set<std::uint32_t> points, expected;
  for (const detail::LocalPoint& point : with.points) EXPECT_TRUE(points.insert(point.point).second);
  for (const detail::Seen& seen : map.SeenBy(5)) expected.insert(seen.point);
  for (const std::uint32_t view : map.BestCovisibles(5, 4))
    for (const detail::Seen& seen : map.SeenBy(view)) expected.insert(seen.point);
  EXPECT_EQ(points, expected);
  for (std::size_t i = 0; i < with.points.size(); ++i)
    EXPECT_EQ(map.PointAt(with.points[i].sighting), with.points[i].point);
}

}  // namespace
}  // namespace slamdb::testing
