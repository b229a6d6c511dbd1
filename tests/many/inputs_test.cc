// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/inputs.h"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "slamdb/formats/formats.h"
#include "slamdb/formats/store/store.h"
#include "slamdb/many/names.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::string kTiny = SLAMDB_FIXTURES "/tiny/tiny.osa";

class FindAtlasesTest : public ::testing::Test {
 protected:
  void Put(const std::string& name) const {
    fs::create_directories((folder_.path() / name).parent_path());
    fs::copy_file(kTiny, folder_.path() / name);
  }
  void Store(const std::string& name) const {
    const Atlas atlas = ReadAtlas(kTiny);
    WriteAtlas(atlas, (folder_.path() / name).string(), {.sync = false});
  }
  std::string In(const std::string& name) const { return folder_ / name; }

  AtlasInputs Find(const std::vector<std::string>& names, bool recursive = false) const {
    return FindAtlases(names, {.recursive = recursive});
  }
  // The inputs relative to the folder; a failure is told behind them.
  std::vector<std::string> Found(const std::vector<std::string>& names, bool recursive = false) const {
    std::vector<std::string> found;
    const std::string before = folder_.path().string() + "/";
    for (const AtlasInput& input : Find(names, recursive).atlases) {
      std::string text = input.location.ToString() + (input.failure.empty() ? "" : "!");
      if (text.starts_with(before)) text.erase(0, before.size());
      found.push_back(text);
    }
    return found;
  }

  TemporaryFolder folder_;
};

TEST_F(FindAtlasesTest, AFolderStandsForItsAtlasesInNaturalOrder) {
  for (const char* name : {"map10.osa", "map2.osa", "B.OSA", "map1.osa.txt"}) Put(name);
  folder_.Make("notes.txt", "nothing");
  folder_.Make("points.ply", "ply\n");  // what was made of an atlas stands beside it
  folder_.Make("points.xyz", "1 2 3\n");
  folder_.Make(".hidden.osa", "");
  Put("inner/deep.osa");
  const AtlasInputs found = Find({folder_.path().string()});
  EXPECT_THAT(Found({folder_.path().string()}), ElementsAre("B.OSA", "map1.osa.txt", "map2.osa", "map10.osa"));
  EXPECT_EQ(found.skipped.others, 3U);
  EXPECT_EQ(found.skipped.hidden, 1U);
  EXPECT_EQ(found.skipped.folders, 1U);
  EXPECT_EQ(found.atlases[0].below, "B.OSA");
}

TEST_F(FindAtlasesTest, FoldersInFoldersWhenAskedFor) {
  for (const char* name : {"b.osa", "a/map10.osa", "a/map9.osa", "a/b/c.osa", ".git/x.osa"}) Put(name);
  EXPECT_THAT(Found({folder_.path().string()}, true), ElementsAre("a/b/c.osa", "a/map9.osa", "a/map10.osa", "b.osa"));
  EXPECT_EQ(Find({folder_.path().string()}, true).atlases[0].below, "a/b/c.osa");
}

TEST_F(FindAtlasesTest, WhatIsAnAtlasIsToldByContentWhereTheNameDoesNot) {
  Put("session");         // no suffix
  Put("backup.osa.bak");  // not meant
  folder_.Make("README", "text");
  folder_.Make("Thumbs.db", "something of another program");
  folder_.Make("log.jsonl", "{\"level\": 1}\n");
  folder_.Make("broken.osa", "");
  folder_.Make("broken.slamdb", "x");
  Store("a.db#one");
  EXPECT_THAT(Found({folder_.path().string()}), ElementsAre("a.db#one", "broken.osa", "broken.slamdb!", "session"));
}

TEST_F(FindAtlasesTest, StoresStandForTheirAtlases) {
  for (const char* name : {"s.db#lab10", "s.db#lab9", "s.db#hall", "s.db#lab[1]"}) Store(name);
  EXPECT_THAT(Found({In("s.db")}), ElementsAre("s.db#hall", "s.db#lab9", "s.db#lab10", "s.db#lab[1]"));
  EXPECT_THAT(Found({In("s.db#lab*")}), ElementsAre("s.db#lab9", "s.db#lab10", "s.db#lab[1]"));
  EXPECT_THAT(Found({In("s.db#lab?")}), ElementsAre("s.db#lab9"));
  EXPECT_THAT(Found({In("s.db#lab[1]")}), ElementsAre("s.db#lab[1]")) << "a name that is there is meant itself";
  EXPECT_THAT(Found({In("s.db#[h]*")}), ElementsAre("s.db#hall"));
  EXPECT_THAT(Found({In("s.db#hall")}), ElementsAre("s.db#hall"));
  EXPECT_THAT(Found({In("s.db#nobody")}), ElementsAre("s.db#nobody")) << "reading it says what is wrong";
  EXPECT_THAT(Find({In("s.db#no*")}).atlases[0].failure, HasSubstr("no atlas is named like 'no*'"));
}

TEST_F(FindAtlasesTest, EmptyAndBrokenStores) {
  Store("s.db#a");
  slamdb::Store::OpenForWriting(In("s.db")).Remove("a");
  EXPECT_THAT(Find({In("s.db")}).atlases, IsEmpty());
  EXPECT_THAT(Find({In("s.db")}).empty_stores, ElementsAre(In("s.db")));
  EXPECT_THAT(Find({In("missing.db")}).atlases[0].failure, HasSubstr("missing.db"));
  EXPECT_FALSE(fs::exists(In("missing.db"))) << "looking makes no store";
  fs::copy_file(SLAMDB_FIXTURES "/store/version2.db", In("old.db"));
  EXPECT_THAT(Find({In("old.db")}).atlases[0].failure, HasSubstr("store version 2"));
}

TEST_F(FindAtlasesTest, OrderIsThatOfTheNames) {
  Put("b/1.osa");
  Put("a/1.osa");
  EXPECT_THAT(Found({In("b"), In("missing.osa"), In("a"), "-"}), ElementsAre("b/1.osa", "missing.osa", "a/1.osa", "-"));
}

TEST_F(FindAtlasesTest, AFolderWithoutAtlasesSaysSo) {
  folder_.Make("notes.txt", "");
  Put("inner/a.osa");
  const AtlasInputs found = Find({folder_.path().string()});
  ASSERT_EQ(found.atlases.size(), 1U);
  EXPECT_THAT(found.atlases[0].failure,
              AllOf(HasSubstr("no atlas in this folder"), HasSubstr("1 file"), HasSubstr("1 folder in it")));
  folder_.Make("metadata.yaml", "");
  EXPECT_THAT(Find({folder_.path().string()}).atlases[0].failure, HasSubstr("ROS 2 bag"));
}

TEST_F(FindAtlasesTest, WhatIsNoFileIsNotOpened) {
  Put("a.osa");
  ASSERT_EQ(::mkfifo(In("pipe.osa").c_str(), 0600), 0);
  fs::create_symlink("/dev/zero", In("device.osa"));
  fs::create_symlink("nowhere", In("dangling.osa"));
  EXPECT_THAT(Found({folder_.path().string()}), ElementsAre("a.osa"));
  EXPECT_EQ(Find({folder_.path().string()}).skipped.special, 3U);
}

TEST_F(FindAtlasesTest, LinksAreFollowedAndCirclesEnd) {
  Put("a/x.osa");
  fs::create_symlink("x.osa", folder_.path() / "a/y.osa");
  fs::create_directory_symlink("..", folder_.path() / "a/up");
  fs::create_directory_symlink("../a", folder_.path() / "a/self");
  EXPECT_THAT(Found({folder_.path().string()}, true), ElementsAre("a/x.osa", "a/y.osa"));
  EXPECT_THAT(Found({In("a")}, true), ElementsAre("a/x.osa", "a/y.osa"));
}

TEST_F(FindAtlasesTest, NamesMayBeAnything) {
  for (const char* name : {"new\nline.osa", "esc\x1b[31m.osa", "with#hash.osa", "\xff\xfe.osa", "a b.osa", "-r.osa"})
    Put(name);
  EXPECT_EQ(Find({folder_.path().string()}).atlases.size(), 6U);
  for (const AtlasInput& input : Find({folder_.path().string()}).atlases)
    EXPECT_EQ(ReadAtlas(input.location).maps.size(), 1U) << input.location.path;
}

TEST_F(FindAtlasesTest, AFolderWithoutRightsIsAFailure) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may read everything";
  Put("inner/a.osa");
  Put("b.osa");
  fs::permissions(In("inner"), fs::perms::none);
  const AtlasInputs found = Find({folder_.path().string()}, true);
  fs::permissions(In("inner"), fs::perms::owner_all);
  ASSERT_EQ(found.atlases.size(), 2U);
  EXPECT_THAT(found.atlases[0].failure, HasSubstr("inner: cannot be read"));
}

TEST_F(FindAtlasesTest, IsBoundedAndCanBeCancelled) {
  for (int i = 0; i < 600; ++i) folder_.Make("file" + std::to_string(i) + ".txt", "");
  const std::vector<std::string> names = {folder_.path().string()};
  EXPECT_EQ(ErrorOf([&] { (void)FindAtlases(names, {.most = 500}); }).kind(), ErrorKind::kOutOfResources);
  EXPECT_EQ(FindAtlases(names, {.most = 600}).skipped.others, 600U);
  struct Stop {};
  const Progress stop = [](std::string_view, double) { throw Stop(); };
  EXPECT_THROW((void)FindAtlases(names, {.progress = stop}), Stop);
}

TEST(Names, StemsAndSuffixes) {
  EXPECT_EQ(StemOf("/a/b.c/session.osa"), "session");
  EXPECT_EQ(StemOf("map.osa.txt"), "map");
  EXPECT_EQ(StemOf("m.keyframes.csv"), "m");
  EXPECT_EQ(StemOf("v1.2.osa"), "v1.2");
  EXPECT_EQ(StemOf("plain"), "plain");
  EXPECT_EQ(NameOf(Location("maps/lab.osa.txt")), "lab");
  EXPECT_EQ(NameOf(Location("maps.db", "lab.osa")), "lab.osa");
  EXPECT_EQ(SuffixOf("x.mrpt.gz"), ".mrpt.gz");
  EXPECT_EQ(SuffixOf("x.other"), ".other");
}

}  // namespace
}  // namespace slamdb
