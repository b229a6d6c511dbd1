// SPDX-License-Identifier: BSD-3-Clause
// What a list tells is in the store, and atlases are found by place, time and keyframes as in memory.
#include <gmock/gmock.h>

#include <limits>
#include <map>

#include "slamdb/formats/sqlite/detail/migrations.h"
#include "slamdb/model/digest.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/formats/store/atlases.h"

namespace slamdb::store_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

void ExpectSame(const AtlasSummary& stored, const AtlasSummary& expected) {
  EXPECT_EQ(stored.maps, expected.maps);
  EXPECT_EQ(stored.keyframes, expected.keyframes);
  EXPECT_EQ(stored.points, expected.points);
  EXPECT_EQ(stored.landmarks, expected.landmarks);
  EXPECT_EQ(stored.observations, expected.observations);
  EXPECT_EQ(stored.sensors, expected.sensors);
  EXPECT_EQ(stored.has_imu, expected.has_imu);
  EXPECT_EQ(stored.is_metric, expected.is_metric);
  EXPECT_EQ(stored.trajectory_length, expected.trajectory_length);
  EXPECT_EQ(stored.duration, expected.duration);
  EXPECT_EQ(stored.begin_time, expected.begin_time);
  EXPECT_EQ(stored.end_time, expected.end_time);
}

class StoreSummary : public ::testing::Test {
 protected:
  StoredAtlas Listed(const std::string& name = "a") {
    for (const StoredAtlas& atlas : Store::Open(path_).List())
      if (atlas.name == name) return atlas;
    ADD_FAILURE() << "no atlas " << name;
    return {};
  }

  TemporaryFolder folder_;
  std::string path_ = folder_ / "s.db";
};

TEST_F(StoreSummary, ListTellsWhatTheAtlasSays) {
  const Atlas inertial = SynthesizeAtlas(
      {.sensor = Sensor::kFisheyeStereo, .inertial = true, .keyframes = 5, .points = 40, .features = 200});
  for (const Atlas& atlas : {SoundAtlas(), OddAtlas(), inertial, Atlas()}) {
    SaveIn(path_, atlas);
    ExpectSame(Listed(), Summarize(atlas));
  }
}

TEST_F(StoreSummary, IsOfTheLastSave) {
  Atlas atlas = SoundAtlas();
  SaveIn(path_, atlas);
  const std::uint64_t before = Listed().bytes;
  atlas.maps.pop_back();
  SaveIn(path_, atlas);
  ExpectSame(Listed(), Summarize(atlas));
  EXPECT_LT(Listed().bytes, before);
}

TEST_F(StoreSummary, MigratingFillsItIn) {
  SaveIn(path_, SoundAtlas());
  const StoredAtlas before = Listed();
  MigrateBackTo(path_, 3);
  EXPECT_EQ(Sql(path_, "SELECT count(*) FROM pragma_table_info('atlas') WHERE name = 'sensors'"), "0");
  EXPECT_THAT(MigrateStore(path_, {.backup = false}).steps,
              ElementsAre("0004_summary", "0005_places", "0006_carried", "0007_revisions"));
  ExpectSame(Listed(), before);
  EXPECT_EQ(Listed().bytes, before.bytes);
  EXPECT_EQ(FirstDifference(LoadFrom(path_), SoundAtlas()), "");
}

// It is migrated all the same, and listed by what its own row tells.
TEST_F(StoreSummary, ADamagedAtlasStaysWithout) {
  SaveIn(path_, SoundAtlas());
  SaveIn(path_, SoundAtlas(), "whole");
  MigrateBackTo(path_, 3);
  Sql(path_, "UPDATE keyframe SET tx = tx + 1 WHERE row = (SELECT min(row) FROM keyframe)");
  MigrateStore(path_, {.backup = false});
  EXPECT_THAT(Listed().sensors, IsEmpty());
  EXPECT_EQ(Listed().keyframes, Summarize(SoundAtlas()).keyframes);
  EXPECT_GT(Listed().bytes, 1000U);
  ExpectSame(Listed("whole"), Summarize(SoundAtlas()));
}

TEST_F(StoreSummary, OneStepBackLosesNothing) {
  SaveIn(path_, OddAtlas());
  MigrateBackTo(path_, 4);
  const MigrateReport back = sqlite::Migrate(path_, {.back = true}, sqlite::Migrations().first(4));
  EXPECT_EQ(back.from, 4);
  EXPECT_EQ(back.to, 3);
  EXPECT_THAT(back.steps, ElementsAre("0004_summary.back"));
  EXPECT_EQ(Sql(path_, "SELECT count(*) FROM v_atlas"), "1");
  MigrateStore(path_, {.backup = false});
  EXPECT_EQ(FirstDifference(LoadFrom(path_), OddAtlas()), "");
}

TEST_F(StoreSummary, ASecondStepBackIsRefused) {
  SaveIn(path_, SoundAtlas());
  MigrateStore(path_, {.back = true, .backup = false});
  EXPECT_THAT(ErrorOf([&] { MigrateStore(path_, {.back = true, .dry_run = true}); }),
              HasSubstr("is of version 6 and cannot go further back"));
}

TEST_F(StoreSummary, ARowThatCannotBeIsAProblem) {
  SaveIn(path_, SoundAtlas());
  EXPECT_EQ(Listed().problem, "");
  for (const auto& [edit, problem] :
       std::vector<std::pair<std::string, std::string>>{{"maps = 9", "9 maps where at most"},
                                                        {"keyframes = 999999999", "999999999 keyframes where at most"},
                                                        {"points = -1", "-1 points where at most"},
                                                        {"landmarks = 77", "77 landmarks where at most 0 can be"},
                                                        {"observations = -1", "a negative count of observations"},
                                                        {"bytes = -1000", "a negative size"},
                                                        {"trajectory_length = -5", "a trajectory of length -5"},
                                                        {"trajectory_length = 9e999", "a trajectory of length inf"},
                                                        {"duration = -1", "a duration of -1 s"},
                                                        {"begin_time = -9e999", "a time that is not finite"}}) {
    Sql(path_, "DROP TABLE IF EXISTS kept; CREATE TABLE kept AS SELECT * FROM atlas");
    Sql(path_, "UPDATE atlas SET " + edit);
    EXPECT_THAT(Listed().problem, HasSubstr(problem)) << edit;
    Sql(path_, "DELETE FROM atlas; INSERT INTO atlas SELECT * FROM kept; DROP TABLE kept");
  }
}

// Every query finds in the store what it finds in memory.
class StoreFind : public StoreSummary {
 protected:
  void SetUp() override {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      Atlas atlas = SynthesizeAtlas({.maps = 2, .keyframes = 6, .points = 40, .features = 60, .seed = seed});
      for (Map& map : atlas.maps) {
        const auto shift = static_cast<double>(seed);
        for (KeyFrame& keyframe : map.keyframes) keyframe.timestamp += 100 * shift;
        for (MapPoint& point : map.points) point.position.x() += static_cast<float>(20 * shift);
        map.points[0].bad = true;
        map.keyframes[0].bad = true;
      }
      atlases_.emplace("s" + std::to_string(seed), std::move(atlas));
    }
    atlases_.emplace("odd", OddAtlas());
    for (const auto& [name, atlas] : atlases_) SaveIn(path_, atlas, name);
  }

  std::vector<std::string> InMemory(const MapQuery& query) const {
    std::vector<std::string> names;
    for (const auto& [name, atlas] : atlases_)
      if (Matches(atlas, query)) names.push_back(name);
    return names;
  }

  void ExpectFound(const MapQuery& query) {
    EXPECT_EQ(Store::Open(path_).Find(query), InMemory(query));
    found_ += InMemory(query).size();
  }

  std::map<std::string, Atlas> atlases_;
  std::size_t found_ = 0;
};

TEST_F(StoreFind, ByTime) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const auto& [name, atlas] : atlases_)
    for (const Map& map : atlas.maps)
      for (const KeyFrame& keyframe : map.keyframes) {
        const double time = keyframe.timestamp;
        ExpectFound({.times = {{time, time}}});
        ExpectFound({.times = {{time - 1e-3, time - 1e-6}}});
        ExpectFound({.times = {{-kInfinity, time}}});
        ExpectFound({.times = {{time, kInfinity}}});
      }
  EXPECT_GT(found_, 100U);
}

TEST_F(StoreFind, ByPlace) {
  for (const auto& [name, atlas] : atlases_)
    for (const Map& map : atlas.maps)
      for (const MapPoint& point : map.points)
        for (const double radius : {0.0, 0.01, 1.0, 25.0}) {
          if (!point.position.allFinite()) continue;
          ExpectFound({.near = {{point.position.cast<double>(), radius}}});
        }
  EXPECT_GT(found_, 100U);
}

TEST_F(StoreFind, ByKeyframes) {
  constexpr std::uint64_t kSignBit = std::uint64_t{1} << 63, kLast = std::numeric_limits<std::uint64_t>::max();
  for (const MapQuery::Ids ids :
       {MapQuery::Ids{0, kLast}, MapQuery::Ids{0, 0}, MapQuery::Ids{2, 5}, MapQuery::Ids{11, 11},
        MapQuery::Ids{500, kSignBit - 1}, MapQuery::Ids{500, kSignBit + 5}, MapQuery::Ids{kSignBit, kLast}})
    ExpectFound({.keyframes = ids});
  EXPECT_GT(found_, 5U);
}

TEST_F(StoreFind, ByEverythingAtOnce) {
  const Map& map = atlases_.at("s2").maps[1];
  const KeyFrame& keyframe = map.keyframes[3];
  MapQuery query{.times = {{keyframe.timestamp, keyframe.timestamp}},
                 .keyframes = {{keyframe.id.value(), keyframe.id.value()}},
                 .near = {{map.points[5].position.cast<double>(), 0.1}}};
  EXPECT_THAT(Store::Open(path_).Find(query), ElementsAre("s2"));
  query.keyframes = {{atlases_.at("s2").maps[0].keyframes[3].id.value(), 0}};
  query.keyframes->last = query.keyframes->first;
  EXPECT_EQ(Store::Open(path_).Find(query), InMemory(query)) << "another map has that keyframe";
  EXPECT_EQ(Store::Open(path_).Find(MapQuery()).size(), 5U) << "nothing is asked for";
}

}  // namespace
}  // namespace slamdb::store_test
