// SPDX-License-Identifier: BSD-3-Clause
// What SQLite can still read of a damaged store is what was saved, row by row.
#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <random>

#include "slamdb/formats/sqlite/detail/salvage.h"
#include "tests/formats/store/atlases.h"
#include "tests/support/equals_atlas.h"

namespace slamdb::store_test {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

class StoreSalvage : public ::testing::Test {
 protected:
  StoreSalvage() { SaveIn(path_, atlas_); }
  Salvage Salvaged() { return detail::SalvageStore(path_, "a", {}); }

  // Every entity equals the one of its id in what was saved.
  void ExpectTrue(const Salvage& salvage) const {
    Atlas expected = atlas_;
    for (const Map& map : salvage.atlas.maps) {
      const auto of = std::ranges::find(expected.maps, map.id, &Map::id);
      ASSERT_NE(of, expected.maps.end());
      of->keyframes = Kept(of->keyframes, map.keyframes);
      of->points = Kept(of->points, map.points);
    }
    EXPECT_EQ(FirstDifference(salvage.atlas, expected), "");
  }

  TemporaryFolder folder_;
  std::string path_ = folder_ / "s.db";
  Atlas atlas_ = SoundAtlas();

 private:
  template <class List>
  static List Kept(const List& all, const List& some) {
    List kept;
    for (const auto& entity : all)
      if (std::ranges::any_of(some, [&](const auto& other) { return other.id == entity.id; })) kept.push_back(entity);
    return kept;
  }
};

TEST_F(StoreSalvage, WholeStores) {
  const Salvage salvage = Salvaged();
  EXPECT_THAT(salvage.damage, IsEmpty());
  EXPECT_THAT(salvage.atlas, EqualsAtlas(atlas_));
  EXPECT_EQ(salvage.maps[0].points.listed, atlas_.maps[0].points.size());
}

// A store that somebody has not migrated yet is the one that most needs to be saved.
TEST_F(StoreSalvage, ReadsOlderVersionsToo) {
  const std::string old = folder_ / "old.db";
  std::filesystem::copy_file(SLAMDB_FIXTURES "/store/version2.db", old);
  const Salvage whole = detail::SalvageStore(old, "tiny", {});
  EXPECT_THAT(whole.damage, IsEmpty());
  const std::string migrated = folder_ / "migrated.db";
  std::filesystem::copy_file(old, migrated);
  MigrateStore(migrated, {.backup = false});
  EXPECT_THAT(whole.atlas, EqualsAtlas(LoadFrom(migrated, "tiny")));

  MigrateStore(path_, {.back = true, .backup = false});
  std::filesystem::resize_file(path_, std::filesystem::file_size(path_) * 3 / 4);
  const Salvage cut = Salvaged();
  EXPECT_THAT(cut.damage, Not(IsEmpty()));
  EXPECT_FALSE(cut.atlas.maps.empty());
  ExpectTrue(cut);
}

TEST_F(StoreSalvage, AsksWhichAtlasByTheNameOfTheStore) {
  const std::string old = folder_ / "old.db";
  std::filesystem::copy_file(SLAMDB_FIXTURES "/store/version2.db", old);
  try {
    static_cast<void>(detail::SalvageStore(old, "", {}));
    FAIL() << "took one of two";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kUsage);
    EXPECT_EQ(error.path(), old);
    EXPECT_THAT(error.problem(), HasSubstr("holds 2 atlases: odd, tiny; say which, as " + old + "#NAME"));
  }
}

TEST_F(StoreSalvage, LeavesOutTheRowThatDiffers) {
  Sql(path_, "UPDATE map_point SET x = x + 1 WHERE row = 4294967299");
  Sql(path_, "DELETE FROM keyframe_features WHERE keyframe = 4294967298");
  const Salvage salvage = Salvaged();
  EXPECT_THAT(salvage.damage, SizeIs(3));  // and that the atlas' own row cannot be held against its hash
  EXPECT_THAT(salvage.damage[0], HasSubstr("table keyframe_features, row 4294967298"));
  EXPECT_EQ(salvage.maps[0].points.read + 1, atlas_.maps[0].points.size());
  EXPECT_EQ(salvage.maps[0].keyframes.read + 1, atlas_.maps[0].keyframes.size());
  ExpectTrue(salvage);
}

TEST_F(StoreSalvage, MissesLastRowsThatWereDeleted) {
  Sql(path_, "DELETE FROM map_point WHERE row >= (SELECT max(row) FROM map_point) - 2");
  const Salvage salvage = Salvaged();
  std::size_t points = 0;
  for (const Map& map : atlas_.maps) points += map.points.size();
  EXPECT_THAT(salvage.damage, Contains("the store records " + std::to_string(points) + " points and lists " +
                                       std::to_string(points - 3) + ": rows were deleted"));
  ExpectTrue(salvage);
}

// What was removed by a save leaves gaps between the rows, which are no damage.
TEST_F(StoreSalvage, GapsAreNoDamage) {
  atlas_.maps[0].points.erase(atlas_.maps[0].points.begin() + 10, atlas_.maps[0].points.begin() + 200);
  atlas_.maps[0].keyframes.erase(atlas_.maps[0].keyframes.begin() + 3);
  SaveIn(path_, atlas_);
  const Salvage salvage = Salvaged();
  EXPECT_THAT(salvage.damage, IsEmpty());
  EXPECT_THAT(salvage.atlas, EqualsAtlas(atlas_));
}

// A stranger's store may have rows far apart, and maps where there can be none.
TEST_F(StoreSalvage, RowsFarApartTakeNoTime) {
  Sql(path_, "UPDATE map_point SET row = row + 4000000000 WHERE row = (SELECT max(row) FROM map_point)");
  EXPECT_EQ(Salvaged().maps.back().points.listed, atlas_.maps.back().points.size());
  Sql(path_, "UPDATE map SET row = -5 WHERE row = 1");
  EXPECT_THAT(Salvaged().damage, Contains(HasSubstr("table map, row -5")));
}

TEST_F(StoreSalvage, ReadsAroundOverwrittenPages) {
  Store::OpenForWriting(path_, {.sync = false}).Vacuum();
  const std::string good = FileBytes(path_);
  std::mt19937 random(5);
  int read = 0;
  for (int i = 0; i < 60; ++i) {
    std::string bad = good;
    const std::size_t page = 4096 * (1 + random() % (bad.size() / 4096 - 1));
    for (std::size_t k = page; k < page + 4096; ++k) bad[k] = static_cast<char>(random());
    std::ofstream(path_, std::ios::binary) << bad;
    Salvage salvage;
    if (!ErrorOf([&] { salvage = Salvaged(); }).empty()) continue;  // a page of the schema or of the list of atlases
    for (const Map& map : salvage.atlas.maps) {
      const auto of = std::ranges::find(atlas_.maps, map.id, &Map::id);
      ASSERT_NE(of, atlas_.maps.end());
      for (const MapPoint& point : map.points)
        EXPECT_EQ(std::ranges::find(of->points, point.id, &MapPoint::id)->position, point.position);
    }
    read += salvage.atlas.maps.size() == atlas_.maps.size();
  }
  EXPECT_GT(read, 40);
}

TEST_F(StoreSalvage, ReadsWhatIsLeftOfAStoreThatWasCut) {
  Store::OpenForWriting(path_, {.sync = false}).Vacuum();
  const std::string good = FileBytes(path_);
  std::size_t keyframes = 0;
  for (const double share : {0.5, 0.8, 0.95}) {
    const auto left = static_cast<std::size_t>(share * static_cast<double>(good.size()));
    std::ofstream(path_, std::ios::binary) << good.substr(0, left);
    Salvage salvage;
    if (!ErrorOf([&] { salvage = Salvaged(); }).empty()) continue;  // the list of atlases stood behind the cut
    EXPECT_THAT(salvage.damage[0], HasSubstr("the file ends after " + std::to_string(left) + " of "));
    for (const Map& map : salvage.atlas.maps) keyframes += map.keyframes.size();
    EXPECT_EQ(FileBytes(path_).size(), left) << "the input is never changed";
  }
  EXPECT_GT(keyframes, 0U);
}

// The pages of the schema lie before all content, vacuumed or not, so that a store that was cut has lost content alone.
TEST_F(StoreSalvage, TheSchemaIsNotWhatACutTakes) {
  Store::OpenForWriting(path_, {.sync = false}).Vacuum();
  EXPECT_LT(std::stoi(Sql(path_, "SELECT max(pageno) FROM dbstat WHERE name = 'sqlite_schema'")), 60);
  const std::string good = FileBytes(path_);
  std::ofstream(path_, std::ios::binary) << good.substr(0, good.size() - 8192);
  std::size_t lost = 0;
  for (const char* name : {"a", ""}) {
    const Salvage salvage = detail::SalvageStore(path_, name, {});
    ASSERT_EQ(salvage.atlas.maps.size(), atlas_.maps.size());
    for (std::size_t i = 0; i < atlas_.maps.size(); ++i) {
      lost += atlas_.maps[i].keyframes.size() - salvage.atlas.maps[i].keyframes.size();
      EXPECT_EQ(salvage.atlas.maps[i].points.size(), atlas_.maps[i].points.size());
    }
  }
  EXPECT_LE(lost, 2U) << "that of the last picture, each time";
}

// Rows without a hash of their own are held against that of the atlas.
TEST_F(StoreSalvage, MissesChangesOfRowsWithoutAHash) {
  const std::string good = FileBytes(path_);
  for (const char* change : {"UPDATE camera SET parameters = '[500,500,320,240]'", "UPDATE camera SET precision = 7",
                             "DELETE FROM camera", "UPDATE atlas SET vocabulary_name = 'foo', next_map = 77",
                             "INSERT INTO repeated_entry VALUES (1, 'cameras', 0, 0, 1, 0, 0)"}) {
    SCOPED_TRACE(change);
    std::ofstream(path_, std::ios::binary) << good;
    Sql(path_, change);
    const Salvage salvage = Salvaged();
    ASSERT_THAT(salvage.damage, SizeIs(1));
    EXPECT_THAT(salvage.damage[0], HasSubstr("table atlas, row 1: this row (vocabulary, next ids, encoding), or one of "
                                             "table camera or repeated_entry, was changed"));
    EXPECT_THAT(ErrorOf([&] { LoadFrom(path_); }),
                HasSubstr("edited outside slamdb, or damaged: the row of table atlas, or some of table camera or "
                          "repeated_entry, which have one hash"));
    Sql(path_, "DELETE FROM map_point WHERE row = (SELECT max(row) FROM map_point)");
    EXPECT_THAT(Salvaged().damage, Contains(HasSubstr("are as they were saved cannot be told")));
  }
}

// Links can be counted anew, so that only they are lost.
TEST_F(StoreSalvage, DamagedLinksCostTheLinksAlone) {
  Sql(path_, "DELETE FROM keyframe_link WHERE kind = 'covisible' AND keyframe < 4294967300");
  const Salvage salvage = Salvaged();
  ASSERT_EQ(salvage.atlas.maps.size(), atlas_.maps.size());
  ASSERT_EQ(salvage.atlas.maps[0].keyframes.size(), atlas_.maps[0].keyframes.size());
  const std::vector<KeyFrameId>& lost = salvage.maps[0].lost_links;
  EXPECT_FALSE(lost.empty());
  EXPECT_LT(lost.size(), atlas_.maps[0].keyframes.size());
  EXPECT_THAT(salvage.damage, SizeIs(lost.size()));
  EXPECT_THAT(salvage.damage[0], HasSubstr("table keyframe_link, row "));
  for (KeyFrame& keyframe : atlas_.maps[0].keyframes) {
    if (std::ranges::find(lost, keyframe.id) == lost.end()) continue;
    keyframe.connections.clear();
    keyframe.children.clear();
    keyframe.loop_edges.clear();
    keyframe.merge_edges.clear();
  }
  EXPECT_EQ(FirstDifference(salvage.atlas, atlas_), "");
}

TEST_F(StoreSalvage, NeedsTheAtlas) {
  EXPECT_THAT(ErrorOf([&] { detail::SalvageStore(path_, "b", {}); }), HasSubstr("no atlas named 'b'"));
  EXPECT_EQ(ErrorOf([&] { detail::SalvageStore(path_, "", {}); }), "");
}

}  // namespace
}  // namespace slamdb::store_test
