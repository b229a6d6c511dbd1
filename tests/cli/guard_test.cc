// SPDX-License-Identifier: BSD-3-Clause
//
// No output is an input: every verb, with each of its outputs pointed at each of its inputs, by whatever path.
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <functional>
#include <set>
#include <thread>

#include "slamdb/base/atomic_file.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/store/store.h"
#include "tests/cli/verbs.h"
#include "tests/support/cli.h"
#include "tests/support/needs_proc.h"

namespace slamdb::testing {
namespace {

using ::testing::AnyOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

// A folder with inputs, in which the command runs.
class Guard : public ::testing::Test {
 protected:
  Guard() {
    FillFolder(folder_.path().string());
    fs::current_path(folder_.path());
    fs::create_directory("x");
  }
  ~Guard() override { fs::current_path(before_); }

  std::vector<std::string> NamesInStore() { return Store::Open("m.db").Names(); }

  const fs::path before_ = fs::current_path();
  const TemporaryFolder folder_;
};

// Paths to the file, made where they have to be.
std::vector<std::string> PathsTo(const std::string& file) {
  fs::create_hard_link(file, "hard-" + file);
  fs::create_symlink(file, "soft-" + file);
  fs::create_symlink(fs::absolute("soft-" + file), "x/far-" + file);
  return {file,           "./" + file,    "x/../" + file, fs::absolute(file).string(),
          "hard-" + file, "soft-" + file, "x/far-" + file};
}

// The command line with another value for one option, which is added when it is not there.
std::vector<std::string> With(const Verb& verb, const FileOption& option, const std::string& value) {
  std::vector<std::string> line = CommandLine(verb);
  const std::string usual = ValueOf(verb, option);
  if (option.positional) {
    *std::ranges::find(line, usual) = value;
  } else if (const auto found = std::ranges::find(line, option.name); found != line.end()) {
    *std::next(found) = value;
  } else {
    line.insert(line.end(), {option.name, value});
  }
  return line;
}

// Options that exclude each other, or need another one, which cannot meet in this run.
bool CannotMeet(const ProcessResult& result) {
  return result.exit_code == 2 &&
         (result.err.find("exclu") != std::string::npos || result.err.find("requires") != std::string::npos);
}

void TryToOverwrite(const Verb& verb, const FileOption& output, const FileOption& input) {
  const std::string atlas = ValueOf(verb, input), file = Location(atlas).path;
  const std::string before = ReadWholeFile(file);
  for (const std::string& path : PathsTo(file)) {
    SCOPED_TRACE(verb.name() + ": " + output.name + " is " + input.name + ", as " + path);
    std::vector<std::string> line = With(verb, output, path);
    if (!input.positional && std::ranges::find(line, input.name) == line.end())
      line.insert(line.end(), {input.name, atlas});
    if (verb.overwrites) line.push_back("-O");
    const ProcessResult result = RunSlamdb(line);
    EXPECT_EQ(ReadWholeFile(file), before);
    if (CannotMeet(result)) continue;
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.err, AnyOf(HasSubstr("never changed"), HasSubstr("is the store itself")));
  }
}

TEST_F(Guard, NoOutputOfAnyVerbIsAnInput) {
  int pairs = 0;
  for (const Verb& verb : AllVerbs())
    for (const FileOption& output : verb.files)
      for (const FileOption& input : verb.files) {
        if (!output.writes || *output.writes == cli::Writes::kPattern || input.writes) continue;
        const TemporaryFolder own;
        FillFolder(own.path().string());
        fs::current_path(own.path());
        fs::create_directory("x");
        TryToOverwrite(verb, output, input);
        fs::current_path(folder_.path());
        ++pairs;
      }
  EXPECT_GT(pairs, 30);
}

// -o is guarded as the positional is, and does the same.
TEST_F(Guard, NoOutputByOptionIsAnInput) {
  int verbs = 0;
  for (const Verb& verb : AllVerbs()) {
    if (!verb.output_option || verb.name() == "split" || verb.name() == "synthesize" || verb.name() == "backup")
      continue;
    SCOPED_TRACE(verb.name());
    std::vector<std::string> line = CommandLine(verb);
    const auto output = std::ranges::find(line, "out.osa");
    ASSERT_NE(output, line.end());
    *output = "x/../a.osa";
    line.insert(output, "-o");
    const std::string input = verb.name() == "landmarks to-points" ? "landmarks.mrpt" : "a.osa";
    *std::next(std::ranges::find(line, "-o")) = "x/../" + input;
    std::ranges::replace(line, std::string("points.osa"), std::string("a.osa"));
    line.push_back("-O");
    const std::string before = ReadWholeFile(input);
    const ProcessResult result = RunSlamdb(line);
    EXPECT_EQ(result.exit_code, 1) << result.err;
    EXPECT_THAT(result.err, HasSubstr("never changed"));
    EXPECT_EQ(ReadWholeFile(input), before);
    ++verbs;
  }
  EXPECT_GE(verbs, 14);
}

TEST_F(Guard, OneOutputAlone) {
  int verbs = 0;
  for (const Verb& verb : AllVerbs()) {
    if (!verb.output_option) continue;
    SCOPED_TRACE(verb.name());
    std::vector<std::string> line = CommandLine(verb);
    line.insert(line.end(), {"--output", "other.osa"});
    const ProcessResult result = RunSlamdb(line);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, HasSubstr("OUTPUT and --output exclude each other"));
    EXPECT_FALSE(fs::exists("out.osa") || fs::exists("other.osa"));
    ++verbs;
  }
  EXPECT_GE(verbs, 16);
}

TEST_F(Guard, NoTwoOutputsOfAnyVerbAreOneFile) {
  int pairs = 0;
  for (const Verb& verb : AllVerbs())
    for (const FileOption& one : verb.files)
      for (const FileOption& other : verb.files) {
        if (!one.writes || !other.writes || one.name == other.name || other.positional) continue;
        SCOPED_TRACE(verb.name() + ": " + one.name + " and " + other.name);
        const ProcessResult result = RunSlamdb(With(verb, other, "x/../" + ValueOf(verb, one)));
        EXPECT_EQ(result.exit_code, 1);
        EXPECT_THAT(result.err, HasSubstr("is an output of this run already"));
        EXPECT_FALSE(fs::exists(ValueOf(verb, one)));
        ++pairs;
      }
  EXPECT_GE(pairs, 3);  // merge, renumber, repair
}

TEST_F(Guard, NamesAreNotEmpty) {
  for (const Verb& verb : AllVerbs())
    for (const FileOption& option : verb.files) {
      SCOPED_TRACE(verb.name() + ": " + option.name);
      const ProcessResult result = RunSlamdb(With(verb, option, ""));
      EXPECT_EQ(result.exit_code, 2);
      if (CannotMeet(result)) continue;
      EXPECT_THAT(result.err, AnyOf(HasSubstr("the name of the file is empty"), HasSubstr("found ''")));
    }
  EXPECT_THAT(RunSlamdb({"convert", "a.osa", "m.db#"}).err, HasSubstr("names no atlas behind the #"));
}

TEST_F(Guard, AnAtlasOfAStoreIsAnInputByEveryName) {
  const auto refused = [&](std::vector<std::string> line) {
    const ProcessResult result = RunSlamdb(line);
    EXPECT_EQ(result.exit_code, 1) << result.out;
    EXPECT_THAT(result.err, HasSubstr("never changed"));
    EXPECT_THAT(NamesInStore(), ElementsAre("a", "b"));
  };
  fs::create_symlink("m.db", "link.db");
  refused({"convert", "m.db#a", "link.db#a", "-O"});
  refused({"merge", "a.osa", "m.db#b", "-o", "m.db#b", "-O"});
  refused({"extract", "m.db#a", "m.db", "--map", "0", "-O", "--to", "orbslam3"});
  refused({"check", "m.db#a", "-o", "link.db", "-O"});
  EXPECT_EQ(RunSlamdb({"extract", "m.db#a", "m.db#part", "--map", "0"}).exit_code, 0) << "another atlas is none";
}

TEST_F(Guard, TheOnlyAtlasOfAStoreIsAnInputWithoutItsName) {
  ASSERT_EQ(RunSlamdb({"convert", "a.osa", "one.db#lab"}).exit_code, 0);
  const ProcessResult result = RunSlamdb({"extract", "one.db", "one.db#lab", "-O", "--map", "0"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("never changed"));
}

TEST_F(Guard, AStoreIsNeverReplacedByAFile) {
  for (const std::vector<std::string>& line :
       std::vector<std::vector<std::string>>{{"convert", "a.osa", "m.db", "-O", "--to", "orbslam3"},
                                             {"check", "a.osa", "-o", "m.db", "-O"},
                                             {"repair", "a.osa", "out.osa", "--journal", "m.db", "-O"}}) {
    const ProcessResult result = RunSlamdb(line);
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.err, HasSubstr("is an SQLite database"));
    EXPECT_THAT(NamesInStore(), ElementsAre("a", "b"));
    EXPECT_FALSE(fs::exists("out.osa"));
  }
}

TEST_F(Guard, AnAtlasIsNeverReplacedByWhatIsNone) {
  const std::string before = ReadWholeFile("b.osa");
  for (const char* name : {"b.html", "map-0.osa"}) fs::create_symlink("b.osa", name);
  for (const std::vector<std::string>& line :
       std::vector<std::vector<std::string>>{{"view", "a.osa", "-o", "b.html", "-O"},
                                             {"plot", "a.osa", "-o", "b.osa", "-O", "--format", "svg"},
                                             {"report", "a.osa", "-o", "b.html", "-O"},
                                             {"check", "a.osa", "-o", "b.osa", "-O"},
                                             {"convert", "a.osa", "b.osa", "-O", "--to", "ply"},
                                             {"convert", "a.osa", "b.osa", "-O", "--to", "tum"},
                                             {"extract", "a.osa", "b.osa", "-O", "--to", "csv", "--map", "0"},
                                             {"split", "a.osa", "{}.osa", "-O", "--to", "ply"},
                                             {"synthesize", "b.osa", "-O", "--to", "ply", "--keyframes", "4"},
                                             {"vocabulary", "set", "a.osa", "b.osa", "-O", "--to", "ply", "--name", "v",
                                              "--checksum", "0123456789abcdef0123456789abcdef"}}) {
    const ProcessResult result = RunSlamdb(line);
    if (result.err.find("built without") != std::string::npos) continue;
    EXPECT_EQ(result.exit_code, 1) << line[0];
    EXPECT_THAT(result.err, HasSubstr("is an atlas, which only an atlas replaces")) << line[0];
    EXPECT_EQ(ReadWholeFile("b.osa"), before) << line[0];
  }
  EXPECT_EQ(RunSlamdb({"convert", "a.osa", "c.osa", "--to", "ply"}).exit_code, 0) << "nothing is there";
  EXPECT_EQ(RunSlamdb({"convert", "a.osa", "c.osa", "--to", "tum", "-O"}).exit_code, 0) << "that is no atlas";
  WriteWholeFile("old.txt", "1.5 0 0 0 0 0 0 1\n");
  EXPECT_EQ(RunSlamdb({"check", "a.osa", "-o", "old.txt", "-O"}).exit_code, 0) << "a trajectory is none";
}

// Of `b.osa` b.html and b.svg, which nobody named.
TEST_F(Guard, ADefaultNameIsNoLink) {
  const std::string before = ReadWholeFile("a.osa");
  fs::create_symlink("a.osa", "b.svg");
  fs::create_symlink("nowhere.html", "b.html");
  for (const char* verb : {"view", "plot"})
    for (const std::vector<std::string>& more : std::vector<std::vector<std::string>>{{}, {"-O"}}) {
      std::vector<std::string> line = {verb, "b.osa"};
      line.insert(line.end(), more.begin(), more.end());
      const ProcessResult result = RunSlamdb(line);
      if (result.err.find("built without") != std::string::npos) continue;
      EXPECT_EQ(result.exit_code, 1) << verb;
      EXPECT_THAT(result.err, HasSubstr("is a symbolic link")) << verb;
    }
  EXPECT_EQ(ReadWholeFile("a.osa"), before);
  EXPECT_FALSE(fs::exists("nowhere.html"));
}

// SQLite cannot read a store without what lies beside it, and takes what lies there for its own.
TEST_F(Guard, WhatLiesBesideAStoreIsAPartOfIt) {
  const std::vector<std::vector<std::string>> lines = {{"check", "a.osa", "-o", "m.db-wal", "-O"},
                                                       {"dump", "m.db#a", "-o", "m.db-journal"},
                                                       {"convert", "m.db#a", "m.db-shm", "--to", "orbslam3"},
                                                       {"convert", "a.osa", "m.db-wal#x", "--to", "store"},
                                                       {"backup", "old.db", "m.db-wal"},
                                                       {"repair", "a.osa", "new.db#x", "--journal", "new.db-wal"},
                                                       {"repair", "a.osa", "new.db#x", "--journal", "new.db-journal"}};
  WriteWholeFile("m.db-wal", "");
  for (const std::vector<std::string>& line : lines) {
    SCOPED_TRACE(line[0] + " " + line.back());
    EXPECT_NE(RunSlamdb(line).exit_code, 0);
    EXPECT_FALSE(fs::exists("m.db-journal") || fs::exists("m.db-shm") || fs::exists("new.db"));
    EXPECT_THAT(NamesInStore(), ElementsAre("a", "b"));
  }
}

TEST_F(Guard, AFileIsNotNamedLikeAnAtlasOfAStore) {
  for (const std::vector<std::string>& line :
       std::vector<std::vector<std::string>>{{"check", "a.osa", "-o", "m.db#a"},
                                             {"repair", "a.osa", "out.osa", "--journal", "m.db#x"},
                                             {"backup", "old.db", "m.db#a"}}) {
    const ProcessResult result = RunSlamdb(line);
    EXPECT_EQ(result.exit_code, 1) << line[0];
    EXPECT_THAT(result.err, HasSubstr("names an atlas of a store"));
  }
}

// Somebody saves what a power cut left before the next run takes it away.
TEST_F(Guard, ATemporaryFileThatIsAnInputStays) {
  std::string left;
  {
    const AtomicFile file("a.osa", {.overwrite = true});
    for (const auto& entry : fs::directory_iterator("."))
      if (entry.path().filename().string().starts_with(".a.osa.slamdb-")) left = entry.path().filename().string();
  }
  fs::copy_file("b.osa", left);
  EXPECT_EQ(RunSlamdb({"recover", left, "saved.osa"}).exit_code, 0);
  EXPECT_TRUE(fs::exists(left));
  EXPECT_EQ(RunSlamdb({"convert", "a.osa", "other.osa"}).exit_code, 0);
  EXPECT_FALSE(fs::exists(left));
}

// What names a file has FILE as the name of its type; an option with another one was thought of here.
TEST(GuardedOptions, AreAllThatNameFiles) {
  static const std::set<std::string> kNoFiles = {
      "",
      "'X,Y X,Y ...'",
      "AXES",
      "BEGIN:END",
      "BITS",
      "BOOST",
      "COLUMN,...",
      "DAYS",
      "DEGREES",
      "DELTA",
      "DISTANCE",
      "FACTOR",
      "FIRST:LAST",
      "FIRST:SECOND",
      "FOLDER",
      "FORMAT",
      "FRACTION",
      "FROM=TO,...",
      "HOW",
      "ID",
      "ID,...",
      "INPUT",
      "LAYOUT",
      "KEY",
      "KIND",
      "KIND,...",
      "LAT,LON[,ALT]",
      "MB",
      "MD5",
      "METHOD",
      "METRES",
      "N",
      "NAME",
      "ORDER",
      "PERCENT",
      "PIXELS",
      "PURPOSE",
      "RULE",
      "SECONDS",
      "SHARE",
      "SIZE",
      "SIZE:SIZE [b, kb(=1000b), kib(=1024b), ...]",
      "T",
      "TAG",
      "TEXT",
      "TRANSFORM",
      "UNIT",
      "URI",
      "VERB",
      "WHAT",
      "WORD",
      "X,Y,Z:X,Y,Z",
      "X,Y,Z[,R]",
      "[-]COLUMN,...",
      "[-]N",
      "NUMBER",
      "NUMBER=LOW:HIGH,...",
  };
  for (const auto& [verb, type] : TypesOfOptions())
    EXPECT_TRUE(type.find("FILE") != std::string::npos || type.find('{') != std::string::npos ||  // a list of words
                kNoFiles.contains(type))
        << verb << ": " << type;
}

TEST_F(Guard, StandardOutputIsNoInputEither) {
  SLAMDB_NEEDS_PROC();
  const std::string before = ReadWholeFile("a.osa");
  const std::string command = std::string(SLAMDB_COMMAND) + " info a.osa >> a.osa";
  EXPECT_EQ(RunProgram({"sh", "-c", command}).exit_code, 1);
  EXPECT_EQ(
      RunProgram({"sh", "-c", std::string(SLAMDB_COMMAND) + " dump - --from orbslam3 -o a.osa -O < a.osa"}).exit_code,
      1);
  EXPECT_EQ(ReadWholeFile("a.osa"), before);
}

TEST_F(Guard, WhatIsNoRegularFileIsWrittenIntoAndStays) {
  SLAMDB_NEEDS_PROC();
  ASSERT_EQ(::mkfifo("pipe", 0600), 0);
  std::string got;
  std::thread reader([&] { got = ReadWholeFile("pipe"); });
  EXPECT_EQ(RunSlamdb({"convert", "a.osa", "pipe", "--to", "orbslam3"}).exit_code, 0);
  reader.join();
  EXPECT_EQ(got, ReadWholeFile("a.osa"));
  EXPECT_TRUE(fs::is_fifo("pipe"));
  EXPECT_EQ(RunSlamdb({"convert", "a.osa", "/dev/null", "--to", "kitti"}).exit_code, 0);
  EXPECT_FALSE(fs::exists("/dev/null.times"));
  const ProcessResult out = RunSlamdb({"convert", "a.osa", "/dev/stdout", "--to", "orbslam3"});
  EXPECT_EQ(out.out, ReadWholeFile("a.osa"));
}

TEST_F(Guard, AHashInTheNameOfAFileIsNoStore) {
  EXPECT_EQ(RunSlamdb({"convert", "a.osa", "out#1.osa"}).exit_code, 0);
  EXPECT_EQ(ReadWholeFile("out#1.osa"), ReadWholeFile("a.osa"));
  EXPECT_EQ(RunSlamdb({"convert", "a.osa", "new.db#1.osa"}).exit_code, 0);
  EXPECT_THAT(Store::Open("new.db").Names(), ElementsAre("1.osa"));
  EXPECT_THAT(RunSlamdb({"convert", "a.osa", "out#1"}).err, HasSubstr("`#1` names an atlas of a store of this name"));
}

// Of two who save under one new name one is told so.
TEST_F(Guard, ANewNameIsClaimedOnce) {
  for (const char* target : {"new.osa", "m.db#new"}) {
    for (int round = 0; round < 5; ++round) {
      std::vector<int> codes(2);
      std::thread other([&] { codes[0] = RunSlamdb({"convert", "a.osa", target}).exit_code; });
      codes[1] = RunSlamdb({"convert", "b.osa", target}).exit_code;
      other.join();
      std::ranges::sort(codes);
      EXPECT_THAT(codes, ElementsAre(0, 1)) << target;
      if (Location(target).name.empty())
        fs::remove(target);
      else
        RunSlamdb({"remove", target});
    }
  }
}

// ---- signals

// Starts the command, which waits for its input behind an open side file, sends the signal and gives the wait status.
int StatusAfter(int signal) {
  const pid_t process = ::fork();
  if (process == 0) {
    ::freopen("/dev/null", "w", stderr);
    ::execl(SLAMDB_COMMAND, "slamdb", "repair", "-", "out.osa", "--from", "orbslam3", "--journal", "fix.json", nullptr);
    ::_exit(127);
  }
  const auto has_temporary = [] {
    return std::any_of(fs::directory_iterator("."), fs::directory_iterator(),
                       [](const auto& entry) { return entry.path().string().find(".slamdb-") != std::string::npos; });
  };
  while (!has_temporary()) std::this_thread::yield();
  ::kill(process, signal);
  int status = 0;
  ::waitpid(process, &status, 0);
  EXPECT_FALSE(has_temporary());
  return status;
}

TEST_F(Guard, SignalsLeaveNothingBehind) {
  int ends[2] = {};
  ASSERT_EQ(::pipe(ends), 0);  // an input that never comes
  const int kept = ::dup(STDIN_FILENO);
  ::dup2(ends[0], STDIN_FILENO);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const int status = StatusAfter(signal);
    EXPECT_TRUE(WIFSIGNALED(status));
    EXPECT_EQ(WTERMSIG(status), signal);
    EXPECT_FALSE(fs::exists("out.osa"));
    EXPECT_FALSE(fs::exists("fix.json"));
  }
  ::dup2(kept, STDIN_FILENO);
}

}  // namespace
}  // namespace slamdb::testing
