// SPDX-License-Identifier: BSD-3-Clause
// Pictures and overlaps that are looked for in a store of many rooms.
#include <gmock/gmock.h>
#include <sqlite3.h>

#include <cstdlib>
#include <map>

#include "slamdb/formats/formats.h"
#include "slamdb/many/likely_maps.h"
#include "slamdb/many/locate_in_store.h"
#include "slamdb/pictures/picture_list.h"
#include "slamdb/pictures/pictures.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using ::testing::Contains;
using ::testing::Each;
using ::testing::IsEmpty;
using ::testing::Not;

// Two sessions in one room, apart: what a robot mapped yesterday and sees today.
struct Room {
  Atlas yesterday, today;
};

Room MakeRoom(std::uint64_t seed) {
  Room room{.yesterday = SynthesizeAtlas({.sensor = Sensor::kStereo,
                                          .maps = 2,
                                          .keyframes = 20,
                                          .points = 1000,
                                          .flipped_bits = 24,
                                          .sessions = SessionOptions{.overlap = 0.6},
                                          .seed = seed,
                                          .threads = 1}),
            .today = {}};
  room.today = room.yesterday;
  room.yesterday.maps.pop_back();
  room.today.maps.erase(room.today.maps.begin());
  return room;
}

class StoreOfRooms : public ::testing::Test {
 protected:
  void SetUp() override {
    Store store = Store::OpenForWriting(path_, {.sync = false});
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
      rooms_.push_back(MakeRoom(seed));
      store.Save(NameOf(seed - 1), rooms_.back().yesterday);
    }
  }
  static std::string NameOf(std::size_t room) { return "room" + std::to_string(room); }

  // Every keyframe of a room's second session, as a picture.
  static std::vector<PictureFeatures> PicturesOf(const Room& room) {
    std::vector<PictureFeatures> pictures;
    for (const KeyFrame& keyframe : room.today.maps[0].keyframes) pictures.push_back(FeaturesOf(room.today, keyframe));
    return pictures;
  }

  LocatedInStore Locate(const std::vector<PictureFeatures>& pictures) {
    Store store = Store::Open(path_);
    return LocateInStore(store, pictures, [&](std::size_t i, const Atlas&) { return pictures[i]; }, {.threads = 1});
  }

  TemporaryFolder folder_;
  std::string path_ = folder_ / "s.db";
  std::vector<Room> rooms_;
};

TEST_F(StoreOfRooms, PicturesAreFoundInTheirRoomAndInNoOther) {
  std::size_t found = 0;
  for (std::size_t room = 0; room < 4; ++room) {
    const std::vector<PictureFeatures> pictures = PicturesOf(rooms_[room]);
    const LocatedInStore located = Locate(pictures);
    EXPECT_THAT(located.not_asked, IsEmpty());
    const Locator alone(rooms_[room].yesterday, {.threads = 1});
    for (std::size_t i = 0; i < pictures.size(); ++i) {
      const bool is_there = alone.Locate(pictures[i]).verdict == LocateVerdict::kFound;
      const std::vector<AtlasLocalization>& answers = located.pictures[i];
      for (std::size_t answer = 0; answer < answers.size(); ++answer)
        if (answers[answer].localization.verdict == LocateVerdict::kFound) {
          EXPECT_EQ(answers[answer].atlas, NameOf(room));
          EXPECT_EQ(answer, 0U) << "the surest first";
          ++found;
        }
      if (is_there) {
        ASSERT_FALSE(answers.empty());
        EXPECT_EQ(answers[0].localization.verdict, LocateVerdict::kFound) << answers[0].localization.reason;
      }
    }
  }
  EXPECT_GE(found, 20U);
}

TEST_F(StoreOfRooms, IsTheSameForAnyNumberOfThreads) {
  const std::vector<PictureFeatures> pictures = PicturesOf(rooms_[2]);
  Store store = Store::Open(path_);
  const auto all = [&](std::size_t i, const Atlas&) { return pictures[i]; };
  const LocatedInStore one = LocateInStore(store, pictures, all, {.threads = 1});
  const LocatedInStore four = LocateInStore(store, pictures, all, {.threads = 4});
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    ASSERT_EQ(one.pictures[i].size(), four.pictures[i].size());
    for (std::size_t j = 0; j < one.pictures[i].size(); ++j) {
      EXPECT_EQ(one.pictures[i][j].atlas, four.pictures[i][j].atlas);
      EXPECT_EQ(one.pictures[i][j].localization.position, four.pictures[i][j].localization.position);
    }
  }
}

TEST_F(StoreOfRooms, NoCameraFits) {
  Store store = Store::Open(path_);
  const LocatedInStore located = LocateInStore(
      store, PicturesOf(rooms_[0]), [](std::size_t, const Atlas&) { return std::optional<PictureFeatures>(); });
  for (const std::vector<AtlasLocalization>& answers : located.pictures)
    for (const AtlasLocalization& answer : answers)
      EXPECT_EQ(answer.localization.reason, "the map's camera takes pictures of another size");
}

TEST_F(StoreOfRooms, ADamagedAtlasIsNamedAndTheOthersAreAsked) {
  Store::OpenForWriting(path_).Save("again", rooms_[1].yesterday);
  Store damaged = Store::OpenForWriting(path_);
  {
    sqlite3* handle = nullptr;
    ASSERT_EQ(sqlite3_open(path_.c_str(), &handle), SQLITE_OK);
    sqlite3_exec(handle,
                 "UPDATE map_point SET x = x + 1 WHERE map IN (SELECT map.row FROM map JOIN atlas ON atlas.row = "
                 "map.atlas WHERE name = 'room1')",
                 nullptr, nullptr, nullptr);
    sqlite3_close(handle);
  }
  const LocatedInStore located = Locate(PicturesOf(rooms_[1]));
  ASSERT_EQ(located.not_asked.size(), 1U);
  EXPECT_THAT(located.not_asked[0], ::testing::HasSubstr("room1: "));
  EXPECT_THAT(located.pictures, Contains(Contains(::testing::Field(&AtlasLocalization::atlas, "again"))));
}

TEST_F(StoreOfRooms, TheMapThatOverlapsIsLikelyAndTheRestIsUnlike) {
  Store store = Store::Open(path_);
  for (std::size_t room = 0; room < rooms_.size(); ++room) {
    const std::vector<MapRef> maps = {{&rooms_[room].today, 0}};
    const LikelyMaps likely = FindLikelyMaps(store, maps);
    ASSERT_FALSE(likely.maps.empty()) << room;
    EXPECT_EQ(likely.maps[0].atlas, NameOf(room));
    EXPECT_GE(likely.unlike.size(), 4U);
    EXPECT_THAT(likely.unlike, Each(Not(NameOf(room))));
    EXPECT_THAT(FindLikelyMaps(store, maps, {.without = {NameOf(room)}}).unlike, Each(Not(NameOf(room))));
  }
}

// Real maps of three rooms, two of them look-alikes (SLAMDB_LAB2), among made ones: pictures are found in the maps of
// their own room, and never in another one.
TEST(StoreOfRealRooms, PicturesAreFoundInTheirRoomAndInNoOther) {
  const char* lab = std::getenv("SLAMDB_LAB2");
  if (lab == nullptr) GTEST_SKIP() << "SLAMDB_LAB2 names no folder of atlases";
  const TemporaryFolder folder;
  const std::string path = folder / "s.db";
  const std::map<char, std::vector<std::string>> rooms = {
      {'a', {"p1", "m1", "i2"}}, {'b', {"r1"}}, {'c', {"q1"}}, {'d', {"p1", "m1", "i2"}}};
  Store store = Store::OpenForWriting(path, {.sync = false});
  for (std::uint64_t seed = 1; seed <= 8; ++seed) store.Save("made" + std::to_string(seed), MakeRoom(seed).yesterday);
  for (const char* name : {"p1", "m1", "i2", "q1", "r1"})
    store.Save(name, ReadAtlas(Location(std::string(lab) + "/" + name + ".osa")));
  const std::vector<std::string> frames = {std::string(lab) + "/frames"};
  const CameraSettings camera = ReadCameraSettings(frames.front() + "/camera.yaml");
  const std::vector<PictureFile> files = FindPictures(frames);
  std::vector<PictureFeatures> pictures;
  for (const PictureFile& file : files) pictures.push_back(ExtractFeatures(ReadPicture(file.path), camera, 2000));
  const LocatedInStore located =
      LocateInStore(store, pictures, [&](std::size_t i, const Atlas&) { return pictures[i]; });
  std::size_t found = 0;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const char room = files[i].path[files[i].path.rfind('/') + 1];
    for (const AtlasLocalization& answer : located.pictures[i])
      if (answer.localization.verdict == LocateVerdict::kFound) {
        EXPECT_THAT(rooms.at(room), Contains(answer.atlas));
      }
    found += !located.pictures[i].empty() && located.pictures[i][0].localization.verdict == LocateVerdict::kFound;
  }
  EXPECT_GE(found, 30U);
}

}  // namespace
}  // namespace slamdb
