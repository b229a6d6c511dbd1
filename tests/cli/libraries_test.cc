// SPDX-License-Identifier: BSD-3-Clause
//
// What the command loads to start, and the program with the libraries that it leaves out.
#include <gmock/gmock.h>

#include <filesystem>

#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
namespace fs = std::filesystem;

constexpr const char* kSession = SLAMDB_FIXTURES "/session_small_a/session_small_a.osa";

TEST(Libraries, WhatStartsTheCommandNeedsNoneThatDrawsSolvesOrReadsPictures) {
  const ProcessResult found = RunProgram({"readelf", "-d", SLAMDB_COMMAND});
  if (found.exit_code == 127) GTEST_SKIP() << "readelf is not there";
  EXPECT_THAT(found.out, HasSubstr("libsqlite3"));
  for (const char* library : {"cairo", "glog", "cholmod", "lapack", "opencv", "png", "jpeg", "libpq"})
    EXPECT_THAT(found.out, Not(HasSubstr(library)));
}

TEST(Libraries, AVerbGoesOnWithThemWhereverTheCommandIsCalledFrom) {
  const TemporaryFolder folder;
  const fs::path link = folder.path() / "command", plot = folder.path() / "plot.svg";
  fs::create_symlink(SLAMDB_COMMAND, link);
  const ProcessResult drawn = RunProgram({link, "plot", "-", "-o", plot}, ReadWholeFile(kSession));
  if (drawn.err.find("built without Cairo") != std::string::npos) GTEST_SKIP() << "needs Cairo";
  EXPECT_EQ(drawn.exit_code, 0) << drawn.err;
  EXPECT_THAT(ReadWholeFile(plot), HasSubstr("<svg"));
}

// Beside the command lies a program that only tells how it was called.
class VerbsWithLibraries : public ::testing::TestWithParam<std::vector<std::string>> {};

TEST_P(VerbsWithLibraries, GoOnAsTheOtherProgramBeforeTheyReadOrWriteAnything) {
  if (!fs::exists(fs::path(SLAMDB_COMMAND).parent_path() / "libexec/slamdb/slamdb")) GTEST_SKIP() << "is one program";
  const TemporaryFolder folder;
  const fs::path command = folder.path() / "bin/slamdb", other = folder.path() / "libexec/slamdb/slamdb";
  fs::create_directories(command.parent_path());
  fs::create_directories(other.parent_path());
  fs::copy_file(SLAMDB_COMMAND, command);
  WriteWholeFile(other, "#!/bin/sh\necho \"went on: $*\"\n");
  fs::permissions(other, fs::perms::owner_all);
  std::vector<std::string> words = {command};
  std::string told = "went on:";
  for (const std::string& word : GetParam()) told += " " + words.emplace_back(word);
  const ProcessResult result = RunProgram(words);
  EXPECT_EQ(result.out, told + "\n") << result.err;
}

INSTANTIATE_TEST_SUITE_P(All, VerbsWithLibraries,
                         ::testing::ValuesIn(std::vector<std::vector<std::string>>{
                             {"plot", "not-there.osa", "-o", "p.svg"},
                             {"list", "postgresql:///maps"},
                             {"report", "not-there.osa", "-o", "r"},
                             {"optimize", "not-there.osa", "-o", "o.osa"},
                             {"close-loops", "not-there.osa", "-o", "o.osa"},
                             {"merge", "--align", "not-there.osa", "nor-this.osa", "-o", "o.osa"},
                             {"merge", "--base", "b.osa", "--geometry", "optimize", "o.osa", "t.osa", "-o", "m.osa"},
                             {"align", "not-there.osa", "nor-this.osa", "--plot", "p.svg"},
                             {"locate", "not-there.osa", "picture.png"},
                             {"convert", "not-there.osa", "model", "--to", "nerf", "--images", "pictures"},
                         }),
                         [](const auto& line) {
                           std::string name = line.param[0] + (line.param[1].starts_with('-') ? line.param[1] : "");
                           std::erase(name, '-');
                           return name;
                         });

// As when somebody has copied the one file.
TEST(Libraries, OfTheCommandAloneAllOtherVerbsWork) {
  const TemporaryFolder folder;
  const fs::path alone = folder.path() / "bin" / "slamdb", plot = folder.path() / "plot.svg";
  fs::create_directory(alone.parent_path());
  fs::copy_file(SLAMDB_COMMAND, alone);
  EXPECT_EQ(RunProgram({alone, "check", "--quiet", kSession}).exit_code, 0);
  const ProcessResult refused = RunProgram({alone, "plot", kSession, "-o", plot});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err, AllOf(HasSubstr((folder.path() / "libexec/slamdb/slamdb").string()), HasSubstr("Cairo"),
                                 HasSubstr("which belongs here: install both"), HasSubstr("No such file")));
  EXPECT_FALSE(fs::exists(plot));
}

}  // namespace
}  // namespace slamdb::testing
