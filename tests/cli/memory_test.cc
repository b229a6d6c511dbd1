// SPDX-License-Identifier: BSD-3-Clause
//
// --memory and --spill: every verb gives the same with hardly any memory, and what cannot be kept on disk is told.
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>

#include "slamdb/base/detail/sanitizers.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/store/store.h"
#include "tests/cli/verbs.h"
#include "tests/support/cli.h"
#include "tests/support/needs_proc.h"

namespace slamdb::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

#define SLAMDB_NEEDS_SPILLING()                            \
  if (SLAMDB_ADDRESS_SANITIZER || SLAMDB_THREAD_SANITIZER) \
  GTEST_SKIP() << "columns are plain memory under a "      \
                  "sanitizer"

// With the hash of each; of an older store, that it is one.
std::string AtlasesOf(const std::string& store) try {
  std::string text;
  for (const StoredAtlas& atlas : Store::Open(store).List()) text += atlas.name + std::to_string(atlas.hash) + "\n";
  return text;
} catch (const Error& error) {
  return error.problem();
}

// What a verb prints and leaves behind: of a store what it holds, as its pages and times differ from run to run.
std::map<std::string, std::string> Outcome(const Verb& verb, const std::vector<std::string>& more) {
  const TemporaryFolder folder;
  FillFolder(folder.path().string());
  const fs::path before = fs::current_path();
  fs::current_path(folder.path());
  std::vector<std::string> line = CommandLine(verb);
  line.insert(line.end(), more.begin(), more.end());
  const ProcessResult result = RunSlamdb(line);
  fs::current_path(before);
  std::map<std::string, std::string> outcome{
      {"exit code", std::to_string(result.exit_code)}, {"out", result.out}, {"err", result.err}};
  for (const std::string& name : folder.Names()) {
    const std::string path = folder / name;
    std::string& file = outcome["file " + name];
    file = name.find(".db") != name.npos ? AtlasesOf(path) : ReadFileOrFolder(path);
  }
  // Times of day and of the work.
  static const std::regex times(R"(\d{4}-\d\d-\d\d.\d\d:\d\d(:\d\d)?(\.\d+)?(Z| UTC)?|\d+(\.\d+)?(e-\d+)? m?s\b)");
  for (auto& [what, text] : outcome) text = std::regex_replace(text, times, "TIME");
  return outcome;
}

TEST(Memory, EveryVerbGivesTheSameWithoutIt) {
  SLAMDB_NEEDS_SPILLING();
  for (const Verb& verb : AllVerbs()) {
    SCOPED_TRACE(verb.name());
    const auto usual = Outcome(verb, {});
    const auto little = Outcome(verb, {"--memory", "1", "--spill", "/var/tmp"});
    for (const auto& [what, text] : usual) {
      if (verb.name() == "check" && what == "file journal.out") continue;  // with times of files
      const auto found = little.find(what);
      ASSERT_NE(found, little.end()) << what;
      EXPECT_TRUE(found->second == text) << what << ":\n" << found->second.substr(0, 500);
    }
    EXPECT_EQ(little.size(), usual.size());
  }
}

// Larger ones.
class LittleMemory : public ::testing::Test {
 protected:
  void SetUp() override { SLAMDB_NEEDS_SPILLING(); }
  std::string Synthesize(const std::string& name, const std::string& size, const std::string& seed = "1") const {
    const std::string path = folder_ / name;
    RunSlamdb({"synthesize", path, "--size", size, "--sensor", "rgbd", "--seed", seed, "--no-sync", "-q"});
    return path;
  }
  // The command line with so little memory that hardly any column is in it; what it says at the end.
  static std::string WithLittle(std::vector<std::string> line) {
    for (const char* word : {"--memory", "32MB", "--spill", "/var/tmp", "-v", "--no-sync"}) line.emplace_back(word);
    const ProcessResult result = RunSlamdb(line);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.err;
  }

  const TemporaryFolder folder_;
};

TEST_F(LittleMemory, ConvertsAndKeepsWithTheSameBytes) {
  const std::string atlas = Synthesize("a.osa", "60MB"), text = folder_ / "text.osa", back = folder_ / "back.osa";
  EXPECT_THAT(WithLittle({"convert", atlas, text, "--text"}), HasSubstr(" in /var/tmp"));
  WithLittle({"convert", text, back, "--to", "orbslam3"});
  EXPECT_TRUE(ReadFile(atlas) == ReadFile(back));
  WithLittle({"convert", atlas, folder_ / "store.db#a"});
  WithLittle({"convert", folder_ / "store.db#a", back, "-O"});
  EXPECT_TRUE(ReadFile(atlas) == ReadFile(back));
}

TEST_F(LittleMemory, MergesAndRecoversWithTheSameBytes) {
  const std::string a = Synthesize("a.osa", "40MB"), b = Synthesize("b.osa", "40MB", "2");
  const std::string usual = folder_ / "usual.osa", little = folder_ / "little.osa";
  ASSERT_EQ(RunSlamdb({"merge", a, b, "-o", usual, "--ignore-vocabulary", "--no-sync"}).exit_code, 0);
  EXPECT_THAT(WithLittle({"merge", a, b, "-o", little, "--ignore-vocabulary"}), HasSubstr(" in /var/tmp"));
  EXPECT_TRUE(ReadFile(usual) == ReadFile(little));
  fs::resize_file(a, fs::file_size(a) * 3 / 4);
  RunSlamdb({"recover", a, usual, "-O", "--no-sync"});
  RunSlamdb({"recover", a, little, "-O", "--no-sync", "--memory", "32MB"});
  EXPECT_TRUE(ReadFile(usual) == ReadFile(little));
}

// What is looked at is let go within moments, by a thread that a busy machine may keep waiting: hence the best of a
// few.
TEST_F(LittleMemory, IsHeld) {
  SLAMDB_NEEDS_PROC();
  const std::string atlas = Synthesize("a.osa", "250MB");
  const double megabytes = static_cast<double>(fs::file_size(atlas)) / 1e6;
  double least = 2 * megabytes;
  for (int round = 0; round < 6 && least > 0.75 * megabytes; ++round) {
    const std::string said = WithLittle({"convert", atlas, folder_ / "b.osa", "-O"});
    std::smatch found;
    ASSERT_TRUE(std::regex_search(said, found, std::regex(R"(at most ([0-9.]+) MB of memory and ([0-9.]+) MB in)")))
        << said;
    EXPECT_GT(std::stod(found[2]), 0.75 * megabytes);
    least = std::min(least, std::stod(found[1]));
  }
  EXPECT_LT(least, megabytes);
}

// ---- what cannot be kept on disk

class Spill : public LittleMemory {
 protected:
  void SetUp() override {
    LittleMemory::SetUp();
    fs::copy_file(SLAMDB_FIXTURES "/room/corner.osa", folder_.path() / "a.osa");
  }
  std::string Shell(const std::string& before, const std::string& options) const {
    const std::string command = before + "exec " + SLAMDB_COMMAND + " info -v " + (folder_ / "a.osa") + " --memory 1 ";
    return RunProgram({"sh", "-c", command + options}).err;
  }
};

TEST_F(Spill, TellsOfAFolderThatIsNotThere) {
  EXPECT_THAT(Shell("", "--spill /var/tmp/not/there"), AllOf(HasSubstr("error: /var/tmp/not/there: cannot make a file"),
                                                             HasSubstr("No such file or directory")));
}

TEST_F(Spill, RefusesAFolderInMemory) {
  if (!fs::is_directory("/dev/shm")) GTEST_SKIP() << "/dev/shm is not there";
  EXPECT_THAT(Shell("", "--spill /dev/shm"), AllOf(HasSubstr("error: /dev/shm: files there are kept in memory"),
                                                   HasSubstr("--spill names a folder on disk")));
}

TEST_F(Spill, PassesOverATemporaryFolderInMemory) {
  if (!fs::is_directory("/dev/shm")) GTEST_SKIP() << "/dev/shm is not there";
  EXPECT_THAT(Shell("TMPDIR=/dev/shm ", ""), HasSubstr(" in /var/tmp"));
}

TEST_F(Spill, TellsOfAFullDisk) {
  EXPECT_THAT(Shell("ulimit -f 2000; ", "--spill /var/tmp"),
              AllOf(HasSubstr("error: /var/tmp: the disk has no room for"), HasSubstr("--spill names another"),
                    HasSubstr("--memory allows more memory")));
}

TEST_F(Spill, SizesMayHaveFractionsAndUnits) {
  const auto told = [&](const std::string& size) {
    return RunSlamdb({"info", folder_ / "a.osa", "--memory=" + size}).err;
  };
  for (const char* size : {"0", "1000000000", "1e9", "500MB", "1.5GiB", ".5g", "1gb", "2Ti"})
    EXPECT_EQ(told(size), "") << size;
  for (const char* size : {"1.5Q", "50%", "-1", "+5", "1 GB", "inf", "nan", "0.1", "1..2", "GB", "1001TB", "1ib"})
    EXPECT_THAT(told(size), HasSubstr("expected bytes, at most 1.0 PB, such as 500MB or 1.5GiB")) << size;
}

TEST_F(Spill, IsNotMadeWithoutNeed) {
  EXPECT_EQ(RunSlamdb({"info", folder_ / "a.osa", "--spill", "/var/tmp/not/there"}).exit_code, 0);
}

}  // namespace
}  // namespace slamdb::testing
