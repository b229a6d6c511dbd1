// SPDX-License-Identifier: BSD-3-Clause
// KeyFrame: covisibility, spanning tree, loop and merge edges, going bad.
#include "slamdb/base/error.h"
#include "tests/live/world.h"

namespace slamdb::live {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

TEST(Covisibility, OrdersByWeightThenId) {
  World world;
  KeyFrame *self = world.AddKeyFrame(), *a = world.AddKeyFrame(), *b = world.AddKeyFrame(), *c = world.AddKeyFrame();
  self->AddConnection(a, 20);
  self->AddConnection(b, 30);
  self->AddConnection(c, 20);
  EXPECT_THAT(self->GetVectorCovisibleKeyFrames(), ElementsAre(b, c, a));
  EXPECT_THAT(self->GetBestCovisibilityKeyFrames(2), ElementsAre(b, c));
  EXPECT_THAT(self->GetCovisiblesByWeight(21), ElementsAre(b));
  EXPECT_THAT(self->GetCovisiblesByWeight(20), ElementsAre(b, c, a));
  EXPECT_THAT(self->GetConnectedKeyFrames(), UnorderedElementsAre(a, b, c));
  self->AddConnection(a, 40);
  EXPECT_THAT(self->GetVectorCovisibleKeyFrames(), ElementsAre(a, b, c));
  EXPECT_EQ(self->GetWeight(a), 40);
  EXPECT_EQ(self->GetWeight(self), 0);
  EXPECT_EQ(a->GetWeight(self), 0) << "one side only";
  self->EraseConnection(a);
  EXPECT_THAT(self->GetVectorCovisibleKeyFrames(), ElementsAre(b, c));
}

TEST(UpdateConnections, KeepsThoseThatShareFifteen) {
  World world;
  KeyFrame *root = world.AddKeyFrame(), *strong = world.AddKeyFrame(), *weak = world.AddKeyFrame();
  world.Share({root, strong}, 16, 0);
  world.Share({root, weak}, 14, 16);
  root->UpdateConnections();
  EXPECT_THAT(root->GetVectorCovisibleKeyFrames(), ElementsAre(strong));
  EXPECT_EQ(root->GetWeight(strong), 16);
  EXPECT_EQ(root->GetWeight(weak), 14) << "known, though not a covisible";
  EXPECT_EQ(strong->GetWeight(root), 16) << "told of it";
  EXPECT_EQ(weak->GetWeight(root), 0) << "not told";
  EXPECT_EQ(root->GetParent(), nullptr) << "the map's initial keyframe has none";
  strong->UpdateConnections();
  EXPECT_EQ(strong->GetParent(), root);
  EXPECT_TRUE(root->hasChild(strong));
}

TEST(UpdateConnections, TakesTheBestWhenNoneSharesFifteen) {
  World world;
  KeyFrame *root = world.AddKeyFrame(), *a = world.AddKeyFrame(), *b = world.AddKeyFrame();
  world.Share({b, root}, 3, 0);
  world.Share({b, a}, 3, 3);
  b->UpdateConnections();
  EXPECT_THAT(b->GetVectorCovisibleKeyFrames(), ElementsAre(root)) << "the first with the most";
  EXPECT_EQ(b->GetParent(), root);
  EXPECT_EQ(root->GetWeight(b), 3);
  EXPECT_EQ(a->GetWeight(b), 0);
  EXPECT_EQ(b->GetWeight(a), 3);
  b->UpdateConnections();
  EXPECT_THAT(root->GetChilds(), ElementsAre(b));
}

TEST(UpdateConnections, LeavesOutBadKeyFramesAndOtherMaps) {
  World world;
  KeyFrame *root = world.AddKeyFrame(), *self = world.AddKeyFrame(), *elsewhere = world.AddKeyFrame();
  world.Share({self, elsewhere}, 20, 0);
  world.Share({self, root}, 2, 20);
  world.atlas.CreateNewMap();
  elsewhere->UpdateMap(world.map());
  self->UpdateConnections();
  EXPECT_THAT(self->GetConnectedKeyFrames(), UnorderedElementsAre(root));
}

TEST(UpdateConnections, ChangesNothingWithoutSharedPoints) {
  World world;
  KeyFrame *root = world.AddKeyFrame(), *self = world.AddKeyFrame();
  self->AddConnection(root, 5);
  self->UpdateConnections();
  EXPECT_EQ(self->GetWeight(root), 5);
  EXPECT_EQ(self->GetParent(), nullptr);
}

TEST(SpanningTree, ChangesParents) {
  World world;
  KeyFrame *a = world.AddKeyFrame(), *b = world.AddKeyFrame(), *c = world.AddKeyFrame();
  c->ChangeParent(a);
  EXPECT_EQ(c->GetParent(), a);
  EXPECT_TRUE(a->hasChild(c));
  c->ChangeParent(b);
  EXPECT_TRUE(a->hasChild(c)) << "leaving the old parent's children is the caller's, as in ORB-SLAM3";
  a->EraseChild(c);
  EXPECT_THAT(a->GetChilds(), IsEmpty());
  EXPECT_THROW(c->ChangeParent(c), Error);
}

TEST(Edges, HoldTheKeyFrame) {
  World world;
  KeyFrame *root = world.AddKeyFrame(), *a = world.AddKeyFrame();
  a->AddLoopEdge(root);
  a->AddLoopEdge(root);
  a->AddMergeEdge(root);
  EXPECT_THAT(a->GetLoopEdges(), ElementsAre(root));
  EXPECT_THAT(a->GetMergeEdges(), ElementsAre(root));
  a->SetBadFlag();
  EXPECT_FALSE(a->isBad());
  a->SetErase();
  EXPECT_FALSE(a->isBad()) << "loop edges hold it for good";
}

TEST(SetErase, CullsWhatWasToBeCulled) {
  World world;
  world.AddKeyFrame();
  KeyFrame* keyframe = world.AddKeyFrame();
  keyframe->SetNotErase();
  keyframe->SetBadFlag();
  EXPECT_FALSE(keyframe->isBad());
  keyframe->SetErase();
  EXPECT_TRUE(keyframe->isBad());
}

TEST(SetBadFlag, SparesTheInitialKeyFrame) {
  World world;
  KeyFrame* root = world.AddKeyFrame();
  root->SetBadFlag();
  EXPECT_FALSE(root->isBad());
}

TEST(SetBadFlag, LeavesConnectionsPointsAndMap) {
  World world;
  KeyFrame *root = world.AddKeyFrame(), *a = world.AddKeyFrame({2, 0, 0}), *b = world.AddKeyFrame(),
           *c = world.AddKeyFrame();
  const std::vector<MapPoint*> shared = world.Share({root, a, b, c}, 16, 0);
  MapPoint* only_two = world.Share({a, b}, 1, 20).front();
  for (KeyFrame* keyframe : {a, b, c}) {
    keyframe->ChangeParent(root);
    keyframe->SetFirstConnection(false);
    keyframe->UpdateConnections();
  }
  ASSERT_EQ(a->GetParent(), root);
  a->SetBadFlag();
  EXPECT_TRUE(a->isBad());
  EXPECT_THAT(world.map()->GetAllKeyFrames(), ElementsAre(root, b, c));
  EXPECT_EQ(root->GetWeight(a), 0);
  EXPECT_FALSE(root->hasChild(a));
  EXPECT_THAT(a->GetConnectedKeyFrames(), IsEmpty());
  EXPECT_EQ(shared[0]->Observations(), 3);
  EXPECT_FALSE(shared[0]->IsInKeyFrame(a));
  EXPECT_TRUE(only_two->isBad()) << "one observation left";
  EXPECT_EQ(a->GetParent(), root) << "how trajectories find it";
  EXPECT_LT((a->GetPoseFromParent().translation - Eigen::Vector3f(-2, 0, 0)).norm(), 1e-6F);
}

// root - parent - self - {strong, linked, lone}: strong shares most with the parent, linked with strong only, lone with
// nobody.
TEST(SetBadFlag, FindsNewParentsForChildren) {
  World world;
  KeyFrame *root = world.AddKeyFrame(), *parent = world.AddKeyFrame(), *self = world.AddKeyFrame(),
           *strong = world.AddKeyFrame(), *linked = world.AddKeyFrame(), *lone = world.AddKeyFrame();
  parent->ChangeParent(root);
  self->ChangeParent(parent);
  for (KeyFrame* child : {strong, linked, lone}) child->ChangeParent(self);
  strong->AddConnection(parent, 50);
  linked->AddConnection(strong, 40);
  linked->AddConnection(root, 90);  // not a candidate
  self->SetBadFlag();
  EXPECT_EQ(strong->GetParent(), parent);
  EXPECT_EQ(linked->GetParent(), strong);
  EXPECT_EQ(lone->GetParent(), parent);
  EXPECT_THAT(parent->GetChilds(), UnorderedElementsAre(strong, lone));
  EXPECT_THAT(strong->GetChilds(), UnorderedElementsAre(linked));
}

}  // namespace
}  // namespace slamdb::live
