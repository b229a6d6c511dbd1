// SPDX-License-Identifier: BSD-3-Clause
// Rows that a person edited in SQL: named, and taken as they are where that is wanted.
#include <gmock/gmock.h>

#include "slamdb/formats/rows/options.h"
#include "slamdb/formats/sqlite/detail/salvage.h"
#include "tests/formats/store/atlases.h"

namespace slamdb::store_test {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class StoreEdits : public ::testing::Test {
 protected:
  StoreEdits() { SaveIn(path_, atlas_); }
  Salvage Accepted() {
    ReadOptions options;
    options.of<StoreReadOptions>().accept_edits = true;
    return detail::SalvageStore(path_, "a", options);
  }

  TemporaryFolder folder_;
  std::string path_ = folder_ / "s.db";
  Atlas atlas_ = SoundAtlas();
};

TEST_F(StoreEdits, AllOfThemAreNamed) {
  Sql(path_, "UPDATE keyframe SET timestamp = timestamp + 100 WHERE map = 1 AND id = 3");
  Sql(path_, "UPDATE map_point SET x = 0.5 WHERE map = 1 AND id IN (5, 7)");
  const std::string error = ErrorOf([&] { LoadFrom(path_); });
  EXPECT_THAT(error, HasSubstr("edited outside slamdb, or damaged: keyframe 3, map_point 5 and map_point 7; "
                               "StoreReadOptions::accept_edits takes them as they are"));
}

TEST_F(StoreEdits, AreTakenAsTheyAre) {
  Sql(path_, "UPDATE keyframe SET timestamp = 100, tx = 2 WHERE map = 1 AND id = 3");
  Sql(path_, "UPDATE map_point SET x = 0.5, y = NULL WHERE map = 1 AND id = 5");
  const Salvage salvage = Accepted();
  EXPECT_THAT(salvage.damage, IsEmpty());
  EXPECT_THAT(salvage.accepted, ElementsAre("keyframe 3", "map_point 5"));
  Map& map = atlas_.maps[0];
  const auto keyframe = std::ranges::find(map.keyframes, KeyFrameId(3), &KeyFrame::id);
  const auto point = std::ranges::find(map.points, MapPointId(5), &MapPoint::id);
  keyframe->timestamp = 100;
  keyframe->camera_from_world.translation.x() = 2;
  point->position.x() = 0.5F;
  const auto found = std::ranges::find(salvage.atlas.maps[0].points, MapPointId(5), &MapPoint::id);
  EXPECT_TRUE(std::isnan(found->position.y()));
  point->position.y() = found->position.y();
  EXPECT_EQ(FirstDifference(salvage.atlas, atlas_), "");
}

TEST_F(StoreEdits, AreNamedAlsoWhereOthersAreGone) {
  Sql(path_, "UPDATE map_point SET x = 0.5 WHERE map = 1 AND id IN (5, 7)");
  Sql(path_, "DELETE FROM map_point WHERE row = (SELECT max(row) FROM map_point)");
  EXPECT_THAT(ErrorOf([&] { LoadFrom(path_); }),
              AllOf(HasSubstr("1 point deleted"), HasSubstr("map_point 5 and map_point 7")));
}

// Numbers that columns cannot hold stand beside them; the edited column counts, and the others keep their bits.
TEST_F(StoreEdits, OfRowsWithExactNumbers) {
  SaveIn(path_, OddAtlas());
  Sql(path_, "UPDATE map_point SET z = 42 WHERE exact IS NOT NULL");
  EXPECT_THAT(ErrorOf([&] { LoadFrom(path_); }), HasSubstr("map_point"));
  const Salvage salvage = Accepted();
  EXPECT_THAT(salvage.damage, IsEmpty());
  ASSERT_FALSE(salvage.accepted.empty());
  Atlas expected = OddAtlas();
  std::size_t edited = 0;
  for (std::size_t m = 0; m < expected.maps.size(); ++m)
    for (std::size_t i = 0; i < expected.maps[m].points.size(); ++i)
      if (salvage.atlas.maps[m].points[i].position.z() == 42) {
        expected.maps[m].points[i].position.z() = 42;
        ++edited;
      }
  EXPECT_EQ(edited, salvage.accepted.size());
  EXPECT_EQ(FirstDifference(salvage.atlas, expected), "");
}

TEST_F(StoreEdits, OfWhatHangsOnRows) {
  Sql(path_,
      "UPDATE observation SET left_keypoint = left_keypoint + 1 WHERE map = 1 AND position = 0 AND point = "
      "(SELECT row FROM map_point WHERE map = 1 AND id = 5)");
  Sql(path_,
      "UPDATE keyframe_link SET weight = weight + 1 WHERE kind = 'covisible' AND position = 0 AND keyframe = "
      "(SELECT row FROM keyframe WHERE map = 1 AND id = 3)");
  const Salvage salvage = Accepted();
  EXPECT_THAT(salvage.accepted, ElementsAre("the links of keyframe 3", "the observations of map_point 5"));
}

// The recorded hashes are those of what is saved, so that nothing but a look at the rows tells.
TEST_F(StoreEdits, AreGoneWhenTheAtlasIsSavedOverThem) {
  Sql(path_, "UPDATE map_point SET x = 0.5 WHERE map = 1 AND id = 5");
  Store::OpenForWriting(path_).Save("a", atlas_, {.verify = true});
  EXPECT_EQ(FirstDifference(LoadFrom(path_), atlas_), "");
}

TEST_F(StoreEdits, OfRowsWithoutAHash) {
  Sql(path_, "UPDATE camera SET parameters = '[500,500,320,240]'");
  Sql(path_, "UPDATE map_point SET x = 0.5 WHERE map = 1 AND id = 5");
  const Salvage salvage = Accepted();
  EXPECT_THAT(salvage.damage, IsEmpty());
  EXPECT_THAT(salvage.accepted,
              ElementsAre("the row of table atlas, or some of table camera or repeated_entry, which have one hash",
                          "map_point 5"));
  EXPECT_EQ(salvage.atlas.cameras.at(0).parameters.at(0), 500);
}

TEST_F(StoreEdits, OfRowsThatAreGone) {
  Sql(path_, "DELETE FROM map_point WHERE map = 1 AND id IN (5, 7)");
  const Salvage salvage = Accepted();
  EXPECT_THAT(salvage.damage, IsEmpty());
  EXPECT_THAT(salvage.accepted, ElementsAre("2 points deleted", HasSubstr("cannot be told")));
}

TEST_F(StoreEdits, DamageStaysDamage) {
  Sql(path_, "UPDATE map_point SET x = 0.5 WHERE map = 1 AND id = 5");
  Sql(path_, "DELETE FROM keyframe_features WHERE keyframe = (SELECT row FROM keyframe WHERE map = 1 AND id = 3)");
  const Salvage salvage = Accepted();
  EXPECT_THAT(salvage.damage, SizeIs(1));
  EXPECT_THAT(salvage.accepted, Contains("map_point 5"));
  EXPECT_THAT(ErrorOf([&] { LoadFrom(path_); }), ::testing::Not(HasSubstr("accept_edits")));
}

}  // namespace
}  // namespace slamdb::store_test
