// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/add.h"

#include <gmock/gmock.h>
#include <sqlite3.h>

#include <filesystem>

#include "slamdb/formats/formats.h"
#include "slamdb/formats/store/store.h"
#include "slamdb/model/digest.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/support/error_of.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Atlas Made(std::uint64_t seed) { return SynthesizeAtlas({.keyframes = 4, .points = 40, .features = 60, .seed = seed}); }

class AddTest : public ::testing::Test {
 protected:
  void Put(const std::string& name, std::uint64_t seed) const {
    fs::create_directories((folder_.path() / name).parent_path());
    WriteAtlas(Made(seed), (folder_.path() / name).string(), {.overwrite = true});
  }
  std::string In(const std::string& name) const { return folder_ / name; }

  AddReport Add(const std::vector<std::string>& names, AddOptions options = {}, bool recursive = false) const {
    options.sync = false;
    return AddToStore(store_, FindAtlases(names, {.recursive = recursive}), options);
  }
  // `added map1`, ...
  static std::vector<std::string> Told(const AddReport& report) {
    std::vector<std::string> told;
    for (const AddedAtlas& atlas : report.atlases) told.push_back(std::string(NameOf(atlas.result)) + " " + atlas.name);
    return told;
  }
  std::vector<std::string> Names() const { return Store::Open(store_).Names(); }
  std::uint64_t HashOfStored(const std::string& name) const { return HashOf(Store::Open(store_).Load(name)); }

  TemporaryFolder folder_;
  std::string store_ = folder_ / "s.db";
};

TEST_F(AddTest, KeepsAFolder) {
  for (const std::uint64_t i : {1U, 2U, 10U}) Put("maps/map" + std::to_string(i) + ".osa", i);
  std::vector<std::string> names, done;
  AddOptions options{.provenance = "test "};
  options.on_names = [&](const std::vector<std::string>& all) { names = all; };
  options.on_done = [&](const AddedAtlas& atlas) { done.push_back(atlas.name); };
  const AddReport report = Add({In("maps")}, options);
  EXPECT_THAT(Told(report), ElementsAre("added map1", "added map2", "added map10"));
  EXPECT_TRUE(report.ok());
  EXPECT_EQ(report.in_store, 3U);
  EXPECT_THAT(names, ElementsAre("map1", "map2", "map10"));
  EXPECT_EQ(done, names);
  for (const std::uint64_t i : {1U, 2U, 10U}) {
    const std::string name = "map" + std::to_string(i);
    EXPECT_EQ(HashOfStored(name), HashOf(ReadAtlas(In("maps/" + name + ".osa"))));
  }
  EXPECT_THAT(Store::Open(store_).Log("map2")[0].provenance, HasSubstr("test "));
}

TEST_F(AddTest, UnchangedOnesAreLeftAndChangedOnesNeedToBeAskedFor) {
  Put("maps/a.osa", 1);
  Put("maps/b.osa", 2);
  Add({In("maps")});
  const std::uint64_t before = HashOf(ReadAtlas(In("maps/b.osa")));
  Put("maps/b.osa", 3);
  const AddReport again = Add({In("maps")});
  EXPECT_THAT(Told(again), ElementsAre("unchanged a", "failed b"));
  EXPECT_THAT(again.atlases[1].failure, AllOf(HasSubstr("b.osa"), HasSubstr("holds another atlas named 'b'")));
  EXPECT_EQ(HashOfStored("b"), before);
  EXPECT_EQ(Store::Open(store_).Log().size(), 2U) << "nothing was written";
  EXPECT_THAT(Told(Add({In("maps")}, {.overwrite = true})), ElementsAre("unchanged a", "replaced b"));
  EXPECT_EQ(HashOfStored("b"), HashOf(ReadAtlas(In("maps/b.osa"))));
  EXPECT_EQ(Store::Open(store_).List()[1].revision, 2U);
}

TEST_F(AddTest, BadOnesFailByThemselves) {
  Put("maps/a.osa", 1);
  folder_.Make("maps/b.osa", "no archive");
  Put("maps/c.osa", 3);
  const AddReport report = Add({In("maps"), In("missing.osa")});
  EXPECT_THAT(Told(report), ElementsAre("added a", "failed b", "added c", "failed missing"));
  EXPECT_FALSE(report.ok());
  EXPECT_EQ(report.Count(AddResult::kFailed), 2U);
  EXPECT_THAT(Names(), ElementsAre("a", "c"));
}

TEST_F(AddTest, NothingGoodMakesNoStore) {
  fs::create_directory(In("maps"));
  folder_.Make("maps/b.osa", "no archive");
  EXPECT_FALSE(Add({In("maps")}).ok());
  EXPECT_FALSE(fs::exists(store_));
}

TEST_F(AddTest, FoldersTellEqualNamesApart) {
  Put("monday/map.osa", 1);
  Put("tuesday/map.osa", 2);
  Put("tuesday/other.osa", 3);
  const AddReport report = Add({In("monday"), In("tuesday")});
  EXPECT_THAT(Told(report), ElementsAre("added monday_map", "added tuesday_map", "added other"));
  EXPECT_THAT(TextOf(report.atlases[0].notices), HasSubstr("is named 'monday_map', with its folder"));
  EXPECT_THAT(report.atlases[2].notices.items(), IsEmpty());
}

TEST_F(AddTest, AsManyFoldersAsItTakes) {
  Put("1/run/map.osa", 1);
  Put("2/run/map.osa", 2);
  EXPECT_THAT(Told(Add({folder_.path().string()}, {}, true)), ElementsAre("added 1_run_map", "added 2_run_map"));
}

TEST_F(AddTest, NamesFromPaths) {
  Put("maps/1/run.osa", 1);
  Put("maps/top.osa", 2);
  EXPECT_THAT(Told(Add({In("maps")}, {.name_from = AddOptions::NameFrom::kPath}, true)),
              ElementsAre("added 1_run", "added top"));
}

TEST_F(AddTest, OneNameIsForOneAtlas) {
  Put("maps/a.osa", 1);
  Put("maps/b.osa", 2);
  EXPECT_THAT(Told(Add({In("maps/a.osa")}, {.name = "mine"})), ElementsAre("added mine"));
  EXPECT_EQ(ErrorOf([&] { Add({In("maps")}, {.name = "mine"}); }).kind(), ErrorKind::kUsage);
}

TEST_F(AddTest, ImpossibleNamesFail) {
  Put("a\x1b[31m.osa", 1);
  const AddReport report = Add({In("a\x1b[31m.osa")});
  EXPECT_THAT(report.atlases[0].failure, HasSubstr("cannot be named"));
  EXPECT_FALSE(fs::exists(store_));
}

TEST_F(AddTest, TheSameFileTwice) {
  Put("a.osa", 1);
  EXPECT_THAT(Told(Add({In("a.osa"), In("a.osa")})), ElementsAre("added a", "unchanged a"));
}

TEST_F(AddTest, WhomNoFolderTellsApartGetsANumber) {
  Put("x/a.osa", 1);
  Put("x/a.osa.txt", 2);
  Put("x/a-2.osa", 3);
  Put("x/y/a.osa", 4);
  for (const bool overwrite : {false, true})
    EXPECT_THAT(Told(Add({In("x")}, {.overwrite = overwrite})),
                ElementsAre(overwrite ? "unchanged a-2" : "added a-2", overwrite ? "unchanged a" : "added a",
                            overwrite ? "unchanged a-3" : "added a-3"));
  EXPECT_EQ(HashOfStored("a"), HashOf(Made(1)));
  EXPECT_EQ(HashOfStored("a-3"), HashOf(ReadAtlas(In("x/a.osa.txt"))));
  store_ = In("deep.db");
  EXPECT_THAT(Told(Add({In("x")}, {}, true)), ElementsAre("added a-2", "added x_a", "added x_a-2", "added y_a"))
      << "no longer than it takes";
}

TEST_F(AddTest, NamesThatClashAreSettledBeforeAnythingIsRead) {
  Put("k/a_b/c.osa", 1);
  Put("k/a/b_c.osa", 2);
  const AddOptions by_path{.name_from = AddOptions::NameFrom::kPath};
  AddOptions again = by_path;
  again.overwrite = true;
  EXPECT_THAT(Told(Add({In("k")}, by_path, true)), ElementsAre("added a_b_c", "added a_b_c-2"));
  EXPECT_THAT(Told(Add({In("k")}, again, true)), ElementsAre("unchanged a_b_c", "unchanged a_b_c-2"));
  fs::remove(In("k/a/b_c.osa"));
  EXPECT_THAT(Told(Add({In("k")}, again, true)), ElementsAre("unchanged a_b_c-2")) << "whoever is left";
  EXPECT_THAT(Names(), ElementsAre("a_b_c", "a_b_c-2"));
  EXPECT_EQ(HashOfStored("a_b_c"), HashOf(Made(2)));
}

TEST_F(AddTest, AnotherInputOfThisRunIsNeverReplaced) {
  Put("a.osa", 1);
  WriteAtlas(Made(2), In("one.db#a"), {.sync = false});
  WriteAtlas(Made(1), store_ + "#a", {.sync = false});
  AddOptions options{.overwrite = true};
  options.on_done = [&](const AddedAtlas&) { WriteAtlas(Made(3), In("a.osa"), {.overwrite = true}); };
  const AddReport report = Add({In("a.osa"), In("a.osa")}, options);  // which changes after it was read
  EXPECT_EQ(report.atlases[0].result, AddResult::kUnchanged);
  if (report.atlases[1].result != AddResult::kUnchanged) {  // it may have been read ahead
    EXPECT_THAT(report.atlases[1].failure, HasSubstr("another input was saved as 'a' just now"));
  }
  EXPECT_EQ(HashOfStored("a"), HashOf(Made(1)));
}

TEST_F(AddTest, WhatIsThereKeepsItsNameWhenOthersCome) {
  Put("maps/lab.osa", 1);
  Add({In("maps")});
  Put("maps/sub/lab.osa", 2);
  const AddReport more = Add({In("maps")}, {}, true);
  EXPECT_THAT(Told(more), ElementsAre("unchanged lab", "added sub_lab"));
  EXPECT_THAT(TextOf(more.atlases[0].notices), HasSubstr("is in the store as 'lab' and keeps that name"));
  fs::remove(In("maps/lab.osa"));
  EXPECT_THAT(Told(Add({In("maps")}, {.overwrite = true}, true)), ElementsAre("unchanged sub_lab"));
  Put("maps/lab.osa", 3);
  EXPECT_THAT(Told(Add({In("maps")}, {.overwrite = true}, true)), ElementsAre("added maps_lab", "unchanged sub_lab"));
  EXPECT_THAT(Names(), ElementsAre("lab", "maps_lab", "sub_lab"));
}

// Whose file is added by another program between the look at the store and the save.
TEST_F(AddTest, WhatAnotherProgramAddedMeanwhileIsUnchanged) {
  Put("maps/a.osa", 1);
  for (const bool overwrite : {false, true}) {
    fs::remove(store_);
    Put("maps/a.osa", 1);
    WriteAtlas(Made(9), store_ + "#other", {.sync = false});
    AddOptions options{.overwrite = overwrite};
    options.on_names = [&](const auto&) { Store::OpenForWriting(store_, {.sync = false}).Save("a", Made(1)); };
    const AddReport report = Add({In("maps")}, options);
    EXPECT_THAT(Told(report), ElementsAre("unchanged a"));
    EXPECT_EQ(report.in_store, 2U);
    EXPECT_EQ(Store::Open(store_).Log("a").size(), 1U);
  }
  fs::remove(store_);
  AddOptions options{.overwrite = true};
  WriteAtlas(Made(9), store_ + "#other", {.sync = false});
  options.on_names = [&](const auto&) { Store::OpenForWriting(store_, {.sync = false}).Save("a", Made(2)); };
  EXPECT_THAT(Told(Add({In("maps")}, options)), ElementsAre("replaced a"));
}

TEST_F(AddTest, TheStoreByAnotherPathIsRefused) {
  Put("maps/a.osa", 1);
  Add({In("maps")});
  fs::create_symlink(store_, In("l.db"));
  EXPECT_THAT(MessageOf([&] { Add({In("maps"), In("l.db")}); }), HasSubstr("is an input, too, as " + In("l.db")));
  EXPECT_EQ(ErrorOf([&] { Add({store_}); }).kind(), ErrorKind::kUsage);
  EXPECT_THAT(Told(Add({store_ + "#a"}, {.name = "twin"})), ElementsAre("added twin"));
}

TEST_F(AddTest, WhatEndsEarlySaysWhatItDid) {
  for (const std::uint64_t i : {1U, 2U, 3U, 4U}) Put("maps/map" + std::to_string(i) + ".osa", i);
  struct Stop {};
  AddReport stopped;
  AddOptions options;
  std::size_t done = 0;
  options.on_done = [&](const AddedAtlas&) { ++done; };
  options.progress = [&](std::string_view, double) {
    if (done == 2) throw Stop();
  };
  options.on_stopped = [&](const AddReport& report) { stopped = report; };
  EXPECT_THROW(Add({In("maps")}, options), Stop);
  EXPECT_THAT(Told(stopped), ElementsAre("added map1", "added map2", "not tried map3", "not tried map4"));
  EXPECT_EQ(stopped.in_store, 2U);
  EXPECT_FALSE(stopped.ok());
  EXPECT_THAT(ToJson(stopped), HasSubstr("\"not_tried\": 2"));
}

TEST_F(AddTest, AtlasesOfStoresKeepTheirNames) {
  WriteAtlas(Made(1), In("from.db#lab"), {.sync = false});
  WriteAtlas(Made(2), In("from.db#hall"), {.sync = false});
  EXPECT_THAT(Told(Add({In("from.db")})), ElementsAre("added hall", "added lab"));
  EXPECT_EQ(HashOfStored("lab"), HashOf(Made(1)));
}

TEST_F(AddTest, TheStoreItselfIsNoInput) {
  Put("a.osa", 1);
  Add({In("a.osa")});
  EXPECT_THAT(Told(Add({folder_.path().string()})), ElementsAre("unchanged a"));
  EXPECT_EQ(Names().size(), 1U);
}

TEST_F(AddTest, DryRunWritesNothing) {
  Put("maps/a.osa", 1);
  const AddReport fresh = Add({In("maps")}, {.dry_run = true});
  EXPECT_THAT(Told(fresh), ElementsAre("added a"));
  EXPECT_EQ(fresh.in_store, 1U);
  EXPECT_FALSE(fs::exists(store_));
  Add({In("maps")});
  const std::string before = ReadFile(store_);
  Put("maps/b.osa", 2);
  Put("maps/a.osa", 3);
  EXPECT_THAT(Told(Add({In("maps")}, {.overwrite = true, .dry_run = true})), ElementsAre("replaced a", "added b"));
  EXPECT_EQ(ReadFile(store_), before);
}

TEST_F(AddTest, WhatIsNoStoreIsRefusedBeforeAnythingIsRead) {
  Put("a.osa", 1);
  store_ = In("a.osa");
  EXPECT_THAT(MessageOf([&] { Add({In("a.osa")}); }), HasSubstr("a.osa"));
  store_ = In("new.osa");
  EXPECT_EQ(ErrorOf([&] { Add({In("a.osa")}); }).kind(), ErrorKind::kUsage);
  EXPECT_FALSE(fs::exists(store_));
  store_ = In("old.db");
  fs::copy_file(SLAMDB_FIXTURES "/store/version2.db", store_);
  EXPECT_THAT(MessageOf([&] { Add({In("a.osa")}); }), HasSubstr("store version 2"));
}

// A program that is killed while it makes a store leaves a database without tables.
TEST_F(AddTest, AnEmptyDatabaseBecomesTheStore) {
  Put("a.osa", 1);
  sqlite3* database = nullptr;
  sqlite3_open(store_.c_str(), &database);
  sqlite3_exec(database, "VACUUM", nullptr, nullptr, nullptr);
  sqlite3_close(database);
  ASSERT_GT(fs::file_size(store_), 0U);
  EXPECT_THAT(Told(Add({In("a.osa")}, {.dry_run = true})), ElementsAre("added a"));
  EXPECT_THAT(Told(Add({In("a.osa")})), ElementsAre("added a"));
  EXPECT_THAT(Names(), ElementsAre("a"));
}

TEST_F(AddTest, TrajectoriesAreNoAtlases) {
  WriteAtlas(Made(1), In("poses.tum"));
  EXPECT_FALSE(Add({In("poses.tum")}).ok());
}

// Wherever the listener ends it, whole atlases are in the store.
TEST_F(AddTest, EndingItLeavesWholeAtlases) {
  for (const std::uint64_t i : {1U, 2U, 3U, 4U}) Put("maps/map" + std::to_string(i) + ".osa", i);
  struct Stop {};
  std::size_t calls = 0;
  for (std::size_t last = 1; last < 60; last += 4) {
    fs::remove(store_);
    calls = 0;
    AddOptions options;
    options.progress = [&](std::string_view, double) {
      if (++calls == last) throw Stop();
    };
    try {
      Add({In("maps")}, options);
    } catch (const Stop&) {
    }
    if (!fs::exists(store_)) continue;
    for (const std::string& name : Names())
      EXPECT_EQ(HashOfStored(name), HashOf(ReadAtlas(In("maps/" + name + ".osa")))) << last;
  }
}

TEST_F(AddTest, ALockedStoreEndsIt) {
  Put("maps/a.osa", 1);
  Put("maps/b.osa", 2);
  Add({In("maps/a.osa")});
  bool refused = false;
  Store holder = Store::OpenForWriting(store_, {.sync = false});
  holder.Save("held", Made(9), {.before_commit = [&] {
                refused = ErrorOf([&] { Add({In("maps")}, {.lock_timeout = 0.1}); }).kind() == ErrorKind::kLocked;
              }});
  EXPECT_TRUE(refused);
  EXPECT_THAT(Names(), ElementsAre("a", "held"));
}

}  // namespace
}  // namespace slamdb
