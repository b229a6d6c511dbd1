// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "slamdb/formats/format.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

TEST(Location, SplitsAtTheLastHashOfTheLastComponent) {
  const auto parsed = [](std::string_view text) {
    const Location location = Location::Parse(text);
    return location.path + " | " + location.name;
  };
  EXPECT_EQ(parsed("a.osa"), "a.osa | ");
  EXPECT_EQ(parsed("-"), "- | ");
  EXPECT_EQ(parsed("store.db#office"), "store.db | office");
  EXPECT_EQ(parsed("dir#1/store.db"), "dir#1/store.db | ");
  EXPECT_EQ(parsed("dir#1/store.db#a b"), "dir#1/store.db | a b");
  EXPECT_EQ(parsed("store#1.db#office"), "store#1.db | office");
  EXPECT_EQ(parsed("store.db#"), "store.db | ");
  EXPECT_EQ(parsed("#office"), "#office | ");
  EXPECT_EQ(parsed("dir/#office"), "dir/#office | ");
}

TEST(Location, KeepsTheHashOfAFileThatIsThere) {
  const TemporaryFolder folder;
  const std::string path = folder.Make("map#2.osa", "x");
  EXPECT_EQ(Location::Parse(path), (Location{path, ""}));
  EXPECT_EQ(Location::Parse(path + "#a"), (Location{path, "a"}));
}

TEST(Location, TakesTheHashForPartOfAFileNameWhereNoStoreCanBe) {
  EXPECT_EQ(Location::Parse("out#1.osa"), (Location{"out#1.osa", ""}));
  EXPECT_EQ(Location::Parse("a.osa#2.keyframes.csv"), (Location{"a.osa#2.keyframes.csv", ""}));
  EXPECT_EQ(Location::Parse("lab.db#1.osa"), (Location{"lab.db", "1.osa"}));
}

TEST(Location, IsMadeOfText) {
  const std::string text = "store.db#office";
  const Location parsed("store.db", "office");
  EXPECT_EQ(Location(text), parsed);
  EXPECT_EQ(Location(text.c_str()), parsed);
  EXPECT_EQ(Location(std::string_view(text)), parsed);
}

TEST(Location, PrintsAsItIsParsed) {
  for (const std::string text : {"a.osa", "store.db#office", "-"}) EXPECT_EQ(Location::Parse(text).ToString(), text);
}

TEST(Location, IsOnAServer) {
  const Location parsed = Location::Parse("postgresql://u:S3cret@h/db?sslmode=require#lab@3");
  EXPECT_EQ(parsed, (Location{"postgresql://u:S3cret@h/db?sslmode=require", "lab@3"}));
  EXPECT_TRUE(parsed.is_server());
  EXPECT_EQ(parsed.ToString(), "postgresql://u@h/db?sslmode=require#lab@3");
  EXPECT_EQ(Location::Parse("postgres:///maps"), (Location{"postgres:///maps", ""}));
  EXPECT_EQ(Location::Parse("postgresql://h"), (Location{"postgresql://h", ""}));
  EXPECT_EQ(Location::Parse("postgresql://h/db#1.osa"), (Location{"postgresql://h/db", "1.osa"}));
  EXPECT_FALSE(Location::Parse("postgres.db#a").is_server());
}

}  // namespace
}  // namespace slamdb
