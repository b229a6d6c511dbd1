// SPDX-License-Identifier: BSD-3-Clause
// What keyframes look like: the rows of keyframe_words follow the features, and pictures are looked for in them.
#include <gmock/gmock.h>

#include <bit>
#include <cmath>
#include <random>
#include <thread>

#include "slamdb/formats/rows/places.h"
#include "slamdb/formats/sqlite/detail/place_words.h"
#include "slamdb/formats/sqlite/detail/salvage.h"
#include "slamdb/model/picture_features.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/formats/store/atlases.h"

namespace slamdb::store_test {
namespace {

using sqlite::PlaceWords;
using sqlite::PlaceWordsOf;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

// As SQL prints them.
std::string HexOf(const PlaceWords& words) {
  std::string hex;
  for (const std::byte byte : std::as_bytes(std::span(words)))
    for (const unsigned digit : {std::to_integer<unsigned>(byte) / 16, std::to_integer<unsigned>(byte) % 16})
      hex += "0123456789ABCDEF"[digit];
  return hex;
}

// Of each map, in their own order.
std::string RowsOf(const Atlas& atlas) {
  std::string rows;
  for (const Map& map : atlas.maps) {
    std::vector<std::string> of_map;
    for (const KeyFrame& keyframe : map.keyframes)
      of_map.push_back(HexOf(PlaceWordsOf(LeftDescriptors(keyframe.features))));
    std::ranges::sort(of_map);
    for (const std::string& row : of_map) rows += (rows.empty() ? "" : ";") + row;
  }
  return rows;
}

std::string StoredRows(const std::string& path, const std::string& name = "a") {
  return Sql(path,
             "SELECT hex(words) FROM keyframe_words JOIN map ON map.row = keyframe >> 32 JOIN atlas ON atlas.row = "
             "map.atlas WHERE name = '" +
                 name + "' ORDER BY position, words");
}

Atlas Room(std::uint64_t seed) {
  return SynthesizeAtlas({.sensor = Sensor::kStereo, .keyframes = 12, .points = 600, .seed = seed, .threads = 1});
}

std::vector<StoredPlace> PlacesLike(const std::string& path, const KeyFrame& keyframe,
                                    const PlaceOptions& options = {}) {
  const std::vector<std::span<const Descriptor>> pictures = {LeftDescriptors(keyframe.features)};
  return Store::Open(path).PlacesLike(pictures, options).by_picture.at(0);
}

std::vector<std::string> Unknown(const std::string& path) { return Store::Open(path).PlacesLike({}).unknown; }

class StorePlaces : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
  std::string path_ = folder_ / "s.db";
};

// They are a part of the format: other words would make rows of older stores mean something else.
TEST(PlaceWords, AreTheSameForever) {
  std::mt19937 random(1);
  std::vector<Descriptor> descriptors(200);
  for (Descriptor& descriptor : descriptors)
    for (std::uint8_t& byte : descriptor) byte = static_cast<std::uint8_t>(random());
  const PlaceWords words = PlaceWordsOf(descriptors);
  std::uint64_t hash = 0;
  int count = 0;
  for (const std::uint64_t part : words) {
    hash = hash * 0x9E3779B97F4A7C15U + part;
    count += std::popcount(part);
  }
  EXPECT_EQ(count, 194);
  EXPECT_EQ(hash, 705134055539096234U);
  EXPECT_EQ(PlaceWordsOf({}), PlaceWords{});
}

TEST_F(StorePlaces, RowsFollowAnyEdits) {
  Atlas atlas = OddAtlas();
  const Atlas room = Room(3);
  atlas.maps[0].keyframes.insert(atlas.maps[0].keyframes.end(), room.maps[0].keyframes.begin(),
                                 room.maps[0].keyframes.end());
  std::mt19937 random(7);
  const auto pick = [&](std::size_t size) { return static_cast<std::ptrdiff_t>(random() % size); };
  for (int step = 0; step < 40; ++step) {
    Map& map = atlas.maps[random() % atlas.maps.size()];
    if (!map.keyframes.empty()) {
      KeyFrame& keyframe = map.keyframes[random() % map.keyframes.size()];
      switch (random() % 7) {
        case 0:
          if (!keyframe.features.descriptors.empty()) keyframe.features.descriptors[0][random() % 32] ^= 0xff;
          break;
        case 1:
          keyframe.features.descriptors.clear();
          break;
        case 2:
          keyframe.camera_from_world.translation.x() += 1;
          break;
        case 3:
          std::shuffle(map.keyframes.begin(), map.keyframes.end(), random);
          break;
        case 4:
          map.keyframes.erase(map.keyframes.begin() + pick(map.keyframes.size()));
          break;
        case 5:
          map.keyframes.push_back(map.keyframes[random() % map.keyframes.size()]);
          break;
        default:
          std::shuffle(atlas.maps.begin(), atlas.maps.end(), random);
      }
    }
    SaveIn(path_, atlas);
    ASSERT_TRUE(StoredRows(path_) == RowsOf(atlas)) << "after step " << step;
  }
  EXPECT_THAT(Unknown(path_), IsEmpty());
}

TEST_F(StorePlaces, OneChangedKeyframeIsOneRow) {
  Atlas atlas = Room(1);
  SaveIn(path_, atlas);
  Sql(path_, "UPDATE keyframe_words SET words = zeroblob(512)");
  atlas.maps[0].keyframes[4].features.descriptors[0][0] ^= 0xff;
  SaveIn(path_, atlas);
  EXPECT_EQ(Sql(path_, "SELECT count(*), min(keyframe & 0xffff) FROM keyframe_words WHERE words <> zeroblob(512)"),
            "1|4");
}

TEST_F(StorePlaces, WhatWasDeletedIsMissedAndComesBack) {
  const Atlas atlas = Room(1);
  SaveIn(path_, atlas, "a");
  SaveIn(path_, Room(2), "b");
  Sql(path_, "DELETE FROM keyframe_words WHERE keyframe = (SELECT min(keyframe) FROM keyframe_words)");
  EXPECT_THAT(Unknown(path_), ElementsAre("a"));
  EXPECT_EQ(FirstDifference(LoadFrom(path_), atlas), "") << "it is in no hash";
  SaveIn(path_, atlas, "a");
  EXPECT_THAT(Unknown(path_), IsEmpty());
  EXPECT_EQ(StoredRows(path_), RowsOf(atlas));
}

TEST_F(StorePlaces, MigratingFillsThemIn) {
  const Atlas atlas = Room(1), odd = OddAtlas();
  SaveIn(path_, atlas, "a");
  SaveIn(path_, odd, "odd");
  MigrateBackTo(path_, 4);
  EXPECT_EQ(Sql(path_, "SELECT count(*) FROM sqlite_schema WHERE name = 'keyframe_words'"), "0");
  EXPECT_THAT(ErrorOf([&] { Store::Open(path_); }), ::testing::HasSubstr("migrate it first"));
  Sql(path_,
      "UPDATE keyframe_features SET columns = x'00' WHERE keyframe = (SELECT max(keyframe) FROM "
      "keyframe_features WHERE keyframe < 2 << 32)");
  EXPECT_THAT(MigrateStore(path_, {.backup = false}).steps,
              ElementsAre("0005_places", "0006_carried", "0007_revisions"));
  EXPECT_EQ(StoredRows(path_, "odd"), RowsOf(odd));
  EXPECT_THAT(Unknown(path_), ElementsAre("a")) << "a keyframe of it is damaged";
  EXPECT_EQ(Sql(path_, "SELECT count(*) FROM keyframe_words WHERE keyframe < 2 << 32"), "11");
}

TEST_F(StorePlaces, RemovedAtlasesTakeTheirsAlong) {
  SaveIn(path_, Room(1), "a");
  SaveIn(path_, Room(2), "b");
  Store::OpenForWriting(path_).Remove("a");
  EXPECT_EQ(Sql(path_, "SELECT count(*) FROM keyframe_words"), "12");
  EXPECT_EQ(StoredRows(path_, "b"), RowsOf(Room(2)));
}

TEST_F(StorePlaces, SavesSideBySide) {
  SaveIn(path_, Room(9), "c");
  const auto save = [&](const std::string& name, std::uint64_t seed) {
    for (int time = 0; time < 4; ++time) {
      Store store = Store::OpenForWriting(path_, {.sync = false, .lock_timeout = 60});
      store.Save(name, Room(seed + static_cast<std::uint64_t>(time)), {.threads = 1});
    }
  };
  std::thread other(save, "a", 10);
  save("b", 20);
  other.join();
  EXPECT_EQ(StoredRows(path_, "a"), RowsOf(Room(13)));
  EXPECT_EQ(StoredRows(path_, "b"), RowsOf(Room(23)));
}

TEST_F(StorePlaces, NamesTheAtlasAndTheKeyframe) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) SaveIn(path_, Room(seed), "room" + std::to_string(seed));
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const Map map = Room(seed).maps[0];
    for (std::size_t row = 3; row + 3 < map.keyframes.size(); ++row) {
      const std::vector<StoredPlace> places = PlacesLike(path_, map.keyframes[row]);
      ASSERT_FALSE(places.empty());
      EXPECT_EQ(places[0].atlas, "room" + std::to_string(seed));
      EXPECT_EQ(places[0].map, map.id);
      EXPECT_LE(std::abs(static_cast<double>(places[0].keyframe.value()) - static_cast<double>(row)), 3);
      EXPECT_GT(places[0].likeness, 20);
    }
    const std::string own = "room" + std::to_string(seed);
    for (const StoredPlace& place : PlacesLike(path_, map.keyframes[5], {.without = {own}})) {
      EXPECT_NE(place.atlas, own);
      EXPECT_LT(place.likeness, 15);
    }
  }
  EXPECT_THAT(PlacesLike(path_, KeyFrame()), IsEmpty());
}

// Rows that somebody made up: what is loaded stays what it is, and nothing but the answers is worse.
TEST_F(StorePlaces, SurvivesMadeUpRows) {
  const Atlas atlas = Room(1);
  for (const char* edit :
       {"UPDATE keyframe_words SET words = x''", "UPDATE keyframe_words SET words = x'ff'",
        "UPDATE keyframe_words SET words = zeroblob(512)", "UPDATE keyframe_words SET words = zeroblob(1000000)",
        "UPDATE keyframe_words SET words = CAST(replace(hex(zeroblob(512)), '00', 'z') AS BLOB)",
        "UPDATE keyframe_words SET keyframe = -keyframe",
        "UPDATE keyframe_words SET keyframe = keyframe + 9223372032559808000", "UPDATE keyframe_words SET hash = 0",
        "UPDATE keyframe SET id = 5, unique_id = NULL", "UPDATE map SET atlas = 77"}) {
    SaveIn(path_, atlas);
    Sql(path_, edit);
    const StoredPlaces places = Store::Open(path_).PlacesLike(
        std::vector<std::span<const Descriptor>>{LeftDescriptors(atlas.maps[0].keyframes[5].features)});
    for (const StoredPlace& place : places.by_picture[0]) EXPECT_TRUE(std::isfinite(place.likeness)) << edit;
    std::remove(path_.c_str());
  }
  SaveIn(path_, atlas);
  Sql(path_, "ALTER TABLE keyframe_words RENAME TO k; CREATE VIEW keyframe_words AS SELECT * FROM k");
  EXPECT_THAT(ErrorOf([&] { Store::Open(path_); }), ::testing::HasSubstr("table keyframe_words"));
  EXPECT_EQ(FirstDifference(detail::SalvageStore(path_, "a", {}).atlas, atlas), "") << "recovering needs none";
}

}  // namespace
}  // namespace slamdb::store_test
