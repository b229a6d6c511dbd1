// SPDX-License-Identifier: BSD-3-Clause
// What the map holds that sessions were joined into.
#include "slamdb/align/join_aligned.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <functional>
#include <set>

#include "slamdb/edit/merge/merge.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/statistics.h"
#include "tests/align/trial.h"
#include "tests/align/worlds.h"

namespace slamdb::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

const KeyFrame* Find(const Map& map, KeyFrameId id) {
  const auto found = std::ranges::find(map.keyframes, id, &KeyFrame::id);
  return found == map.keyframes.end() ? nullptr : &*found;
}

bool Has(const Column<KeyFrameId>& list, KeyFrameId id) { return std::ranges::find(list, id) != list.end(); }

std::set<MapPointId> PointsOf(const Map& map) {
  std::set<MapPointId> ids;
  for (const MapPoint& point : map.points) ids.insert(point.id);
  return ids;
}

// As of one camera alone, or of one with depth, without IMU.
void ForgetImu(Map& map) { map.imu_initialized = map.inertial = map.imu_ba1 = map.imu_ba2 = false; }
void ForgetDepth(Map& map) {
  for (KeyFrame& keyframe : map.keyframes) {
    std::ranges::fill(keyframe.features.right_x, -1.0F);
    std::ranges::fill(keyframe.features.depth, -1.0F);
  }
}

// Sessions, of which some may know less of their frame, made one; only points that were matched are fused.
class Joined {
 public:
  explicit Joined(const SyntheticOptions& options, const std::function<void(Atlas&)>& change = {})
      : sessions(SynthesizeSessions(options)) {
    if (change) change(sessions.atlas);
    before = sessions.atlas;
    report = JoinAlignedMaps(sessions.atlas, {.threads = 1},
                             {.fuse = FuseOptions{.radius = 1e-3, .hamming = 0}, .threads = 1});
  }
  Joined(const Joined&) = delete;
  Joined& operator=(const Joined&) = delete;

  const Map& map() const { return sessions.atlas.maps.at(0); }

  // The row of the map that the others went into; all rows when there is none.
  std::size_t Root() const {
    std::size_t root = 0;
    while (root < before.maps.size() && before.maps[root].id != map().id) ++root;
    return root;
  }

  // How far the worst camera is from where it truly is, in metres.
  double WorstPlace() const {
    const std::size_t root = Root();
    double worst = 0;
    for (std::size_t row = 0; row < before.maps.size(); ++row)
      for (const KeyFrame& keyframe : before.maps[row].keyframes) {
        const Eigen::Vector3d truth = sessions.room_from_map[row] * CameraCenter(keyframe).cast<double>();
        const Eigen::Vector3d is = CameraCenter(*Find(map(), keyframe.id)).cast<double>();
        worst = std::max(worst, (sessions.room_from_map[root] * is - truth).norm());
      }
    return worst;
  }

  SyntheticSessions sessions;
  Atlas before;
  JoinAlignedReport report;
};

// Each edge is in both lists, between keyframes of the two maps that a verified pair names, and no keyframe is in two.
void ExpectMergeEdges(const Joined& joined, const MapLink& link) {
  const std::vector<AlignedPair>& pairs = link.alignment.pairs;
  std::size_t edges = 0;
  for (const KeyFrame& keyframe : joined.map().keyframes) {
    EXPECT_LE(keyframe.merge_edges.size(), 1U);
    for (const KeyFrameId other : keyframe.merge_edges) {
      const KeyFrame* end = Find(joined.map(), other);
      ASSERT_NE(end, nullptr);
      EXPECT_TRUE(Has(end->merge_edges, keyframe.id)) << keyframe.id.value();
      EXPECT_TRUE(keyframe.not_erase && end->not_erase);
      EXPECT_TRUE(std::ranges::any_of(pairs, [&](const AlignedPair& pair) {
        return (pair.first == keyframe.id && pair.second == other) ||
               (pair.second == keyframe.id && pair.first == other);
      }));
      ++edges;
    }
  }
  EXPECT_EQ(edges % 2, 0U);
  EXPECT_GE(edges, 2 * 3U);
  EXPECT_TRUE(Has(Find(joined.map(), pairs.front().first)->merge_edges, pairs.front().second)) << "the strongest pair";
}

// Nearly all pairs are one point afterwards, that of the root, and nothing else was fused.
void ExpectFused(const Joined& joined, const MapLink& link, bool second_stays) {
  const std::set<MapPointId> points = PointsOf(joined.map());
  const std::vector<MatchedPoints>& matches = link.alignment.matches;
  std::size_t one = 0;
  for (const MatchedPoints& match : matches) {
    const auto [stays, goes] =
        second_stays ? std::pair{match.second, match.first} : std::pair{match.first, match.second};
    one += points.contains(stays) && !points.contains(goes) ? 1 : 0;
  }
  EXPECT_GE(matches.size(), 50U);
  EXPECT_GE(one, matches.size() * 9 / 10);
  const FuseReport& fused = *joined.report.joins.at(0).fused;
  EXPECT_LE(fused.fused, matches.size());
  EXPECT_EQ(points.size(), joined.before.maps[0].points.size() + joined.before.maps[1].points.size() - fused.fused);
}

TEST(JoinAlignedMaps, MakesOneMapOfTwoWithEdgesAndCommonPoints) {
  const Joined joined(SmallPair());
  ASSERT_THAT(joined.sessions.atlas.maps, SizeIs(1));
  ASSERT_THAT(joined.report.joins, SizeIs(1));
  EXPECT_EQ(joined.Root(), 0U) << "of two that say as much, the first";
  EXPECT_THAT(joined.map().keyframes, SizeIs(28));
  EXPECT_LT(joined.WorstPlace(), 0.03);
  const MapLink& link = joined.report.aligned.links.at(0);
  ExpectMergeEdges(joined, link);
  ExpectFused(joined, link, false);
  const KeyFramePair strongest{link.alignment.pairs[0].first, link.alignment.pairs[0].second};
  EXPECT_EQ(joined.report.joins[0].link, strongest);
  EXPECT_EQ(Find(joined.map(), strongest.second)->parent, strongest.first);
  EXPECT_THAT(joined.report.apart, IsEmpty());
}

TEST(JoinAlignedMaps, KeepsPointsApartWhereAskedTo) {
  SyntheticSessions sessions = SynthesizeSessions(SmallPair());
  const std::size_t points = sessions.atlas.maps[0].points.size() + sessions.atlas.maps[1].points.size();
  const JoinAlignedReport report = JoinAlignedMaps(sessions.atlas, {.threads = 1}, {.fuse = {}, .threads = 1});
  EXPECT_FALSE(report.joins.at(0).fused);
  EXPECT_THAT(sessions.atlas.maps.at(0).points, SizeIs(points));
}

// The link's second map is the root, and keeps its frame, its id and its points.
void ExpectTurned(const Joined& joined) {
  ASSERT_THAT(joined.sessions.atlas.maps, SizeIs(1));
  ASSERT_EQ(joined.Root(), 1U);
  const MapLink& link = joined.report.aligned.links.at(0);
  EXPECT_EQ(link.first, 0U);
  for (const KeyFrame& keyframe : joined.before.maps[1].keyframes)
    EXPECT_EQ(CameraCenter(*Find(joined.map(), keyframe.id)), CameraCenter(keyframe));
  EXPECT_LT(joined.WorstPlace(), 0.03);
  ExpectMergeEdges(joined, link);
  ExpectFused(joined, link, true);
  const AlignedPair& strongest = link.alignment.pairs.front();
  EXPECT_EQ(Find(joined.map(), strongest.first)->parent, strongest.second);
}

TEST(JoinAlignedMaps, OfAMonocularAndAMetricMapTheMetricOneIsTheRoot) {
  const Joined joined(SmallPair(Sensor::kRgbd), [](Atlas& atlas) { ForgetDepth(atlas.maps[0]); });
  ASSERT_FALSE(IsMetric(joined.before.maps[0]));
  ExpectTurned(joined);
}

TEST(JoinAlignedMaps, OfAMonocularAndAnInertialMapTheInertialOneIsTheRoot) {
  const Joined joined(SmallPair(Sensor::kMonocular, true), [](Atlas& atlas) { ForgetImu(atlas.maps[0]); });
  ASSERT_FALSE(IsMetric(joined.before.maps[0]));
  ExpectTurned(joined);
}

TEST(JoinAlignedMaps, OfTwoMetricMapsTheInertialOneIsTheRoot) {
  const Joined joined(SmallPair(Sensor::kRgbd, true), [](Atlas& atlas) { ForgetImu(atlas.maps[0]); });
  ASSERT_TRUE(IsMetric(joined.before.maps[0]));
  ExpectTurned(joined);
}

// A monocular one, a metric one and an upright one: each says more than the one before.
TEST(JoinAlignedMaps, OfThreeTheUprightOneIsTheRoot) {
  SyntheticOptions options = SmallPair(Sensor::kRgbd, true);
  options.maps = 3;
  const Joined joined(options, [](Atlas& atlas) {
    ForgetImu(atlas.maps[0]);
    ForgetDepth(atlas.maps[0]);
    ForgetImu(atlas.maps[1]);
  });
  ASSERT_THAT(joined.sessions.atlas.maps, SizeIs(1));
  EXPECT_EQ(joined.Root(), 2U);
  ASSERT_THAT(joined.report.joins, SizeIs(2));
  EXPECT_EQ(joined.report.joins[0].second, joined.before.maps[1].id) << "the one that is linked to it";
  EXPECT_EQ(joined.report.joins[1].second, joined.before.maps[0].id);
  EXPECT_THAT(joined.map().keyframes, SizeIs(42));
  EXPECT_LT(joined.WorstPlace(), 0.05);
  EXPECT_THAT(joined.report.apart, IsEmpty());
}

TEST(JoinAlignedMaps, OfThreeMetricOnesTheFirstIsTheRoot) {
  SyntheticOptions options = SmallPair();
  options.maps = 3;
  const Joined joined(options);
  ASSERT_THAT(joined.sessions.atlas.maps, SizeIs(1));
  EXPECT_EQ(joined.Root(), 0U);
  EXPECT_THAT(joined.report.joins, SizeIs(2));
  EXPECT_THAT(joined.report.keyframes, ElementsAre(SizeIs(14), SizeIs(14), SizeIs(14)));
  EXPECT_LT(joined.WorstPlace(), 0.05);
}

// A map of another world, and one without keyframes, before those that are joined.
TEST(JoinAlignedMaps, NamesAMapThatLinksToNothingAndLeavesIt) {
  SyntheticOptions stranger = SmallPair();
  stranger.maps = 1;
  stranger.sessions.reset();
  stranger.seed = 77;
  Atlas atlas = MergeAtlases({SynthesizeAtlas(stranger), SynthesizeAtlas(SmallPair())}).atlas;
  Map& empty = *atlas.maps.insert(atlas.maps.begin(), Map{});
  empty.id = MapId(99);
  ASSERT_THAT(atlas.maps, SizeIs(4));
  const Atlas before = atlas;
  const JoinAlignedReport report = JoinAlignedMaps(atlas, {.threads = 1}, {.threads = 1});
  EXPECT_THAT(report.maps, ElementsAre(before.maps[1].id, before.maps[2].id, before.maps[3].id));
  EXPECT_THAT(report.apart, ElementsAre(before.maps[1].id));
  ASSERT_THAT(report.joins, SizeIs(1));
  EXPECT_EQ(report.joins[0].first, before.maps[2].id);
  EXPECT_EQ(report.joins[0].second, before.maps[3].id);
  ASSERT_THAT(atlas.maps, SizeIs(3));
  EXPECT_EQ(atlas.maps[0].id, MapId(99));
  EXPECT_EQ(atlas.maps[1].id, before.maps[1].id);
  ASSERT_THAT(atlas.maps[1].keyframes, SizeIs(14));
  for (std::size_t row = 0; row < 14; ++row) {
    EXPECT_EQ(CameraCenter(atlas.maps[1].keyframes[row]), CameraCenter(before.maps[1].keyframes[row]));
    EXPECT_THAT(atlas.maps[1].keyframes[row].merge_edges, IsEmpty());
  }
  EXPECT_EQ(PointsOf(atlas.maps[1]), PointsOf(before.maps[1]));
  EXPECT_THAT(atlas.maps[2].keyframes, SizeIs(28));
}

}  // namespace
}  // namespace slamdb::testing
