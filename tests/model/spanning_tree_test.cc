// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/detail/spanning_tree.h"

#include <gmock/gmock.h>

#include <initializer_list>

#include "slamdb/synthetic/synthesize.h"
#include "tests/support/equals_atlas.h"

namespace slamdb {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr int kNone = -1;

KeyFrameId IdOf(int id) { return id == kNone ? KeyFrameId() : KeyFrameId(static_cast<std::uint64_t>(id)); }

// A map whose keyframe `i` has id `i` and the i-th of `parents`, with the children to match; the root is the first.
Map Tree(std::initializer_list<int> parents) {
  Map map;
  map.first_keyframe = IdOf(0);
  for (const int parent : parents) {
    KeyFrame& keyframe = map.keyframes.emplace_back();
    keyframe.id = KeyFrameId(map.keyframes.size() - 1);
    keyframe.parent = IdOf(parent);
  }
  for (const KeyFrame& keyframe : map.keyframes)
    if (keyframe.parent.value() < map.keyframes.size())
      map.keyframes[keyframe.parent.value()].children.push_back(keyframe.id);
  return map;
}

void Connect(Map& map, std::size_t from, int to, int weight) {
  map.keyframes[from].connections.push_back({IdOf(to), weight});
}

std::vector<int> Parents(const Map& map) {
  std::vector<int> parents;
  for (const KeyFrame& keyframe : map.keyframes)
    parents.push_back(keyframe.parent ? static_cast<int>(keyframe.parent.value()) : kNone);
  return parents;
}

std::vector<int> Children(const Map& map, std::size_t row) {
  std::vector<int> children;
  for (const KeyFrameId child : map.keyframes[row].children) children.push_back(static_cast<int>(child.value()));
  return children;
}

TEST(RerootTree, TurnsTheChainOfParentsRound) {
  //   0 - 1 - 2 - 3        4 hangs on 1, 5 on 2
  Map map = Tree({kNone, 0, 1, 2, 1, 2});
  map.keyframes[0].first_connection = true;
  detail::RerootTree(map, KeyFrameId(2));
  EXPECT_THAT(Parents(map), ElementsAre(1, 2, kNone, 2, 1, 2));
  EXPECT_THAT(Children(map, 2), ElementsAre(3, 5, 1));
  EXPECT_THAT(Children(map, 1), ElementsAre(4, 0));
  EXPECT_THAT(Children(map, 0), IsEmpty());
  EXPECT_FALSE(map.keyframes[0].first_connection);
  EXPECT_EQ(map.first_keyframe, KeyFrameId(0));  // the caller's business
}

TEST(RerootTree, ThereAndBackIsTheSameTree) {
  Map map = Tree({kNone, 0, 1, 2, 1, 2});
  detail::RerootTree(map, KeyFrameId(3));
  detail::RerootTree(map, KeyFrameId(0));
  EXPECT_EQ(Parents(map), Parents(Tree({kNone, 0, 1, 2, 1, 2})));
}

TEST(RerootTree, LeavesARootAndTheUnknownAlone) {
  Map map = Tree({kNone, 0, 1});
  detail::RerootTree(map, KeyFrameId(0));
  detail::RerootTree(map, KeyFrameId(77));
  EXPECT_THAT(Parents(map), ElementsAre(kNone, 0, 1));
  EXPECT_THAT(Children(map, 0), ElementsAre(1));
}

TEST(RerootTree, CutsACycleWhereItCloses) {
  // 0 -> 1 -> 2 -> 3 -> 1
  Map map = Tree({1, 2, 3, 1});
  detail::RerootTree(map, KeyFrameId(0));
  EXPECT_THAT(Parents(map), ElementsAre(kNone, 0, 1, 2));
  EXPECT_THAT(Children(map, 0), ElementsAre(1));
  EXPECT_THAT(Children(map, 1), ElementsAre(2));
  EXPECT_THAT(Children(map, 3), IsEmpty());
}

TEST(RerootTree, FreesARootThatIsItsOwnParent) {
  Map map = Tree({0, 0});
  detail::RerootTree(map, KeyFrameId(0));
  EXPECT_THAT(Parents(map), ElementsAre(kNone, 0));
  EXPECT_THAT(Children(map, 0), ElementsAre(1));
}

TEST(AdoptOrphans, LeavesASoundTreeAlone) {
  const Atlas sound = SynthesizeAtlas({.keyframes = 15, .points = 300, .features = 200});
  Atlas atlas = sound;
  EXPECT_EQ(detail::AdoptOrphans(atlas.maps[0]), 0U);
  EXPECT_THAT(atlas, EqualsAtlas(sound));
}

TEST(AdoptOrphans, TakesTheStrongestCovisibilityFirst) {
  // 2 and 3 lost their parent. 3 is closest to 2, 2 closest to 1: 2 goes first, and 3 may then hang on it.
  Map map = Tree({kNone, 0, kNone, kNone});
  Connect(map, 2, 0, 20);
  Connect(map, 2, 1, 50);
  Connect(map, 3, 0, 30);
  Connect(map, 3, 2, 80);
  EXPECT_EQ(detail::AdoptOrphans(map), 2U);
  EXPECT_THAT(Parents(map), ElementsAre(kNone, 0, 1, 2));
  EXPECT_THAT(Children(map, 1), ElementsAre(2));
  EXPECT_THAT(Children(map, 2), ElementsAre(3));
}

TEST(AdoptOrphans, BringsAlongWhatHangsOnAnOrphan) {
  // 1 lost its parent; 2 and 3 hang on it and keep their parents, though they share more points with 0.
  Map map = Tree({kNone, 9, 1, 2});
  Connect(map, 1, 0, 15);
  Connect(map, 2, 0, 99);
  Connect(map, 3, 0, 99);
  EXPECT_EQ(detail::AdoptOrphans(map), 1U);
  EXPECT_THAT(Parents(map), ElementsAre(kNone, 0, 1, 2));
}

TEST(AdoptOrphans, NeverHangsAnOrphanOnItsOwnDescendant) {
  Map map = Tree({kNone, kNone, 1});
  Connect(map, 1, 2, 99);
  Connect(map, 1, 0, 1);
  EXPECT_EQ(detail::AdoptOrphans(map), 1U);
  EXPECT_THAT(Parents(map), ElementsAre(kNone, 0, 1));
}

TEST(AdoptOrphans, CutsCycles) {
  // 0 is alone; 1 -> 2 -> 3 -> 1 in a circle, 4 hangs on it; 5 is its own parent.
  Map map = Tree({kNone, 2, 3, 1, 3, 5});
  Connect(map, 1, 0, 7);
  Connect(map, 5, 4, 3);
  EXPECT_EQ(detail::AdoptOrphans(map), 2U);
  EXPECT_THAT(Parents(map), ElementsAre(kNone, 0, 3, 1, 3, 4));
  EXPECT_THAT(Children(map, 5), IsEmpty());
}

TEST(AdoptOrphans, WithoutCovisibilityTakesTheOneMadeBefore) {
  // The root has the highest id, as after merges.
  Map map = Tree({kNone, kNone, kNone, kNone});
  map.first_keyframe = IdOf(2);
  EXPECT_EQ(detail::AdoptOrphans(map), 3U);
  EXPECT_THAT(Parents(map), ElementsAre(2, 0, kNone, 2));
}

TEST(AdoptOrphans, FreesARootWithAParentAndMakesChildrenAgree) {
  Map map = Tree({1, 0, 0});
  map.keyframes[2].children.push_back(KeyFrameId(1));  // a lie
  map.keyframes[0].children.clear();
  EXPECT_EQ(detail::AdoptOrphans(map), 0U);
  EXPECT_THAT(Parents(map), ElementsAre(kNone, 0, 0));
  EXPECT_THAT(Children(map, 0), ElementsAre(1, 2));
  EXPECT_THAT(Children(map, 1), IsEmpty());
  EXPECT_THAT(Children(map, 2), IsEmpty());
}

TEST(AdoptOrphans, DoesNothingWithoutItsRoot) {
  Map map = Tree({kNone, kNone});
  map.first_keyframe = IdOf(9);
  EXPECT_EQ(detail::AdoptOrphans(map), 0U);
  EXPECT_THAT(Parents(map), ElementsAre(kNone, kNone));
}

}  // namespace
}  // namespace slamdb
