// SPDX-License-Identifier: BSD-3-Clause
// Origins and counters of points, and stores of before there were any.
#include <gmock/gmock.h>

#include "slamdb/formats/sqlite/detail/migrations.h"
#include "slamdb/model/digest.h"
#include "tests/formats/store/atlases.h"

namespace slamdb::store_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kCounts =
    "SELECT count(*), count(origin_map), count(visible_count), count(found_count) FROM map_point";

class StoreTracking : public ::testing::Test {
 protected:
  StoreTracking() : atlas_(SoundAtlas()) {
    Column<MapPoint>& points = atlas_.maps[1].points;
    points[0].origin_map = 0;
    points[1].visible_count = 0;
    points[2].found_count = 7;
    points[3].origin_map = 0xfffffffe;
    points[3].visible_count = std::numeric_limits<std::int32_t>::max();
    points[3].found_count = std::numeric_limits<std::int32_t>::min();
  }

  // As a slamdb of version 3 goes back.
  MigrateReport Back() { return sqlite::Migrate(path_, {.back = true}, sqlite::Migrations().first(3)); }

  TemporaryFolder folder_;
  std::string path_ = folder_ / "s.db";
  Atlas atlas_;
};

TEST_F(StoreTracking, ComesBackEachByItself) {
  SaveIn(path_, atlas_);
  EXPECT_EQ(FirstDifference(LoadFrom(path_), atlas_), "");
  const std::size_t points = atlas_.maps[0].points.size() + atlas_.maps[1].points.size();
  EXPECT_EQ(Sql(path_, kCounts), std::to_string(points) + "|2|2|2");
  EXPECT_EQ(Sql(path_, "SELECT found_count FROM v_map_point WHERE found_count > 0"), "7");
}

TEST_F(StoreTracking, ACountIsOneChangedRow) {
  SaveIn(path_, atlas_);
  ++atlas_.maps[1].points[2].found_count;
  const SaveReport report = SaveIn(path_, atlas_);
  std::vector<std::string> updated;
  for (const TableChanges& changes : report.tables)
    if (changes.updated > 0) updated.push_back(changes.table + " " + std::to_string(changes.updated));
  EXPECT_THAT(updated, ElementsAre("atlas 1", "map_point 1"));
  EXPECT_EQ(FirstDifference(LoadFrom(path_), atlas_), "");
}

TEST_F(StoreTracking, DamageIsFound) {
  SaveIn(path_, atlas_);
  Sql(path_, "UPDATE map_point SET visible_count = 3 WHERE visible_count = 0");
  EXPECT_THAT(ErrorOf([&] { LoadFrom(path_); }), HasSubstr("table map_point, row "));
}

TEST_F(StoreTracking, OneStepBackAndForth) {
  SaveIn(path_, SoundAtlas());
  MigrateBackTo(path_, 3);
  const MigrateReport back = Back();
  EXPECT_EQ(back.from, 3);
  EXPECT_EQ(back.to, 2);
  EXPECT_THAT(back.steps, ElementsAre("0003_tracking.back"));
  EXPECT_EQ(back.backup, path_ + ".v3.bak");
  EXPECT_EQ(Sql(path_, "SELECT count(*) FROM pragma_table_info('map_point') WHERE name LIKE '%\\_count' ESCAPE '\\'"),
            "1");  // observation_count
  EXPECT_THAT(ErrorOf([&] { Store::Open(path_); }), HasSubstr("store version 2, this program needs 7"));
  EXPECT_THAT(ErrorOf([&] { Back(); }), HasSubstr("cannot go further back"));
  EXPECT_THAT(MigrateStore(path_).steps,
              ElementsAre("0003_tracking", "0004_summary", "0005_places", "0006_carried", "0007_revisions"));
  EXPECT_EQ(FirstDifference(LoadFrom(path_), SoundAtlas()), "");
}

TEST_F(StoreTracking, NoStepBackLosesAny) {
  const auto refused = [&](const Atlas& atlas) {
    std::filesystem::remove(path_);  // of several revisions there is no way back
    SaveIn(path_, atlas);
    MigrateBackTo(path_, 3);
    EXPECT_THAT(ErrorOf([&] { Back(); }), HasSubstr("origins or counters"));
    MigrateStore(path_, {.backup = false});
    EXPECT_EQ(FirstDifference(LoadFrom(path_), atlas), "");
  };
  for (const auto member : {&MapPoint::visible_count, &MapPoint::found_count}) {
    Atlas one = SoundAtlas();
    one.maps[0].points[5].*member = 0;
    refused(one);
  }
  Atlas one = SoundAtlas();
  one.maps[0].points[5].origin_map = 0;
  refused(one);
}

// fixtures/store/version2.db was saved by slamdb 0.1 of before version 3: OddAtlas() as `odd`.
TEST_F(StoreTracking, AStoreOfTheVersionBeforeIsTakenOverUnchanged) {
  std::filesystem::copy_file(SLAMDB_FIXTURES "/store/version2.db", path_);
  const std::string hashes = Sql(path_, "SELECT sum(hash >> 8), sum(observations_hash >> 8) FROM map_point");
  EXPECT_THAT(MigrateStore(path_, {.backup = false}).steps,
              ElementsAre("0003_tracking", "0004_summary", "0005_places", "0006_carried", "0007_revisions"));
  EXPECT_EQ(FirstDifference(LoadFrom(path_, "odd"), OddAtlas()), "");
  const SaveReport report = SaveIn(path_, OddAtlas(), "odd");
  EXPECT_EQ(report.Total().inserted + report.Total().deleted, 0U);
  EXPECT_EQ(report.Total().updated, 0U);
  EXPECT_EQ(Sql(path_, "SELECT sum(hash >> 8), sum(observations_hash >> 8) FROM map_point"), hashes);
}

// What earlier versions recorded in stores and journals.
TEST(HashOf, StaysWhatItWas) {
  EXPECT_EQ(HashOf(OddAtlas()), 0x5c8053021ed70f53U);
  EXPECT_EQ(HashOf(SoundAtlas()), 0x0b6334e32de202e0U);
  Atlas without_landmarks = OddAtlas();
  for (Map& map : without_landmarks.maps) map.landmarks.clear();
  EXPECT_EQ(HashOf(without_landmarks), 0x34ecced29319bf8cU);
  Atlas tracked = SoundAtlas();
  tracked.maps[0].points[0].origin_map = 1;
  tracked.maps[0].points[0].visible_count = 2;
  tracked.maps[0].points[0].found_count = 3;
  EXPECT_EQ(HashOf(tracked), 0x866aff01232ee05eU);
}

}  // namespace
}  // namespace slamdb::store_test
