// SPDX-License-Identifier: BSD-3-Clause
//
// A disk that refuses the nth call, and a process that is killed before it: for every verb that writes, and every n.
// What was there stays or the new one is there, whole; inputs stay; the exit status is honest; nothing is left behind,
// after a kill nothing after the next run.
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <memory>

#include "slamdb/formats/formats.h"
#include "slamdb/formats/store/store.h"
#include "tests/cli/verbs.h"
#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

namespace fs = std::filesystem;

constexpr long kMostCalls = 24;  // of a verb with more: every second, third, ...

bool IsDatabase(const std::string& bytes) { return bytes.starts_with("SQLite format 3"); }

// What a store says it holds: its pages may lie in any order. One that cannot be read, as of an older version, says so.
std::string Meaning(const std::string& path) try {
  std::string text;
  Store store = Store::Open(path, 0.05);  // nobody else is at work: what is half made stays so
  for (const StoredAtlas& atlas : store.List()) {
    store.Load(atlas.name);  // compares every row with its hash
    text += atlas.name + " " + std::to_string(atlas.hash) + "\n";
  }
  return text;
} catch (const Error& error) {
  return error.problem();
}

// The same; each store is read once, unless a log beside it changes what its bytes mean.
std::string MeaningOf(const std::string& path, const std::string& bytes) {
  static std::map<std::string, std::string> known;
  std::error_code missing;
  if (const auto log = fs::file_size(path + "-wal", missing); !missing && log > 0) return Meaning(path);
  const auto [found, is_new] = known.try_emplace(bytes);
  if (is_new) found->second = Meaning(path);
  return found->second;
}

// Every file below the current folder with its content, and stores with what they say.
using Content = std::map<std::string, std::string>;

Content ContentHere() {
  Content content;
  for (const auto& entry : fs::recursive_directory_iterator(".")) {
    if (!entry.is_regular_file()) continue;
    const std::string path = entry.path().lexically_normal().string();
    if (path.ends_with("-wal") || path.ends_with("-shm") || path.ends_with("-journal")) continue;
    content[path] = ReadWholeFile(path);
  }
  for (auto& [path, bytes] : content)
    if (IsDatabase(bytes)) bytes = MeaningOf(path, bytes);
  return content;
}

struct Run {
  int exit_code = -1;
  long calls = 0;
  std::string failed;  // the call
};

int runs = 0;  // of the command, for docs/reliability.md

// Runs the command with a disk of its own kind; `at` 0: a sound one.
Run RunOn(const std::vector<std::string>& line, long at, const std::string& how, const std::string& log) {
  std::vector<std::string> words = {"env",
                                    "LD_PRELOAD=" SLAMDB_FAILING_IO,
                                    "SLAMDB_IO_AT=" + std::to_string(at),
                                    "SLAMDB_IO_HOW=" + how,
                                    "SLAMDB_IO_LOG=" + log,
                                    SLAMDB_COMMAND};
  words.insert(words.end(), line.begin(), line.end());
  ++runs;
  Run run{.exit_code = RunProgram(words).exit_code, .calls = 0, .failed = "kill"};
  std::ifstream(log) >> run.calls >> run.failed;
  return run;
}

// Files that belong together: by what their names begin with.
struct Together {
  std::string beginning;
  std::vector<std::vector<std::string>> before;  // command lines that make the old ones
  std::string mine;                              // another file beside them; empty: none
  std::vector<std::string> read;                 // reads them; empty: no run may mix them
  bool mends = false;                            // the same run again does what a killed one did not
};

// A verb in a folder of its own, which every run begins anew.
class Trial {
 public:
  Trial(const std::vector<std::string>& line, bool overwrites, Together together = {})
      : line_(line), before_(fs::current_path()), together_(std::move(together)) {
    FillFolder(inputs_.path().string());
    fs::current_path(inputs_.path());
    for (std::vector<std::string> before : together_.before) {
      before.insert(before.begin(), SLAMDB_COMMAND);
      EXPECT_THAT(RunProgram(before).exit_code, ::testing::AnyOf(0, 3));
    }
    if (!together_.mine.empty()) WriteWholeFile(inputs_ / together_.mine, "mine");
    if (overwrites) {
      if (together_.beginning.empty()) WriteWholeFile(inputs_ / "out.osa", "old");
      line_.push_back("-O");
    }
    line_.insert(line_.end(), {"--threads", "1"});
  }
  ~Trial() { fs::current_path(before_); }

  // False: the verb writes nothing. What vacuum writes means what it meant.
  bool RunClean() {
    Begin();
    old_ = Here();
    clean_ = RunOn(line_, 0, "none", Log());
    new_ = Here();
    EXPECT_THAT(clean_.exit_code, ::testing::AnyOf(0, 1, 3)) << "a new verb may need a line in verbs.cc";
    return new_ != old_ || line_.front() == "vacuum";
  }
  long calls() const { return clean_.calls; }

  void RunFailing(long at, const std::string& how) {
    Begin();
    const Run run = RunOn(line_, at, how, Log());
    SCOPED_TRACE(how + " at call " + std::to_string(at) + " (" + run.failed + ")");
    const Content now = Here();
    ExpectOldOrNew(now, /*temporaries=*/how == "kill");
    ExpectTogether(now, /*may_be_unfinished=*/how == "kill");
    if (run.exit_code == clean_.exit_code && run.exit_code != 1) {
      EXPECT_EQ(now, new_) << "exit status " << run.exit_code;
    }
    if (how != "kill") return;
    const Run next = RunOn(line_, 0, "none", Log());
    if (together_.mends)
      EXPECT_EQ(next.exit_code, clean_.exit_code);
    else
      EXPECT_THAT(next.exit_code, ::testing::AnyOf(clean_.exit_code, 1));
    ExpectOldOrNew(Here(), /*temporaries=*/false);
    ExpectTogether(Here(), /*may_be_unfinished=*/false);
  }

 private:
  std::string Log() const { return outside_ / "log"; }

  Content Here() const {
    Content content = ContentHere();
    // Kept wherever it ends, line by line, and with times of files in it: many_test.cc.
    if (line_.front() == "check") content.erase("journal.out");
    return content;
  }

  void Begin() {
    fs::current_path(before_);
    folder_ = std::make_unique<TemporaryFolder>();
    fs::copy(inputs_.path(), folder_->path(), fs::copy_options::recursive);
    fs::current_path(folder_->path());
  }

  bool IsOldContent(const std::string& bytes) const {
    return std::ranges::any_of(old_, [&](const auto& file) { return file.second == bytes; });
  }

  void ExpectOldOrNew(const Content& now, bool temporaries) {
    for (const auto& [path, bytes] : now) {
      if (path.find(".slamdb-") != std::string::npos) {
        EXPECT_TRUE(temporaries) << path << " is left";
        continue;
      }
      const auto old = old_.find(path), made = new_.find(path);
      const bool is_old = old != old_.end() && old->second == bytes,
                 is_new = made != new_.end() && made->second == bytes;
      const bool is_copy = old == old_.end() && made == new_.end() && IsOldContent(bytes);  // a second backup
      // A store is made before its first atlas is in it; the next save goes on with it.
      const bool is_begun = path.ends_with(".db") && old == old_.end() && made != new_.end() &&
                            (bytes.empty() || bytes.find("an empty database") != std::string::npos);
      EXPECT_TRUE(is_old || is_new || is_copy || is_begun)
          << path << " is neither old nor new: " << bytes.size() << " bytes";
    }
    for (const auto& [path, bytes] : old_) EXPECT_TRUE(now.contains(path)) << path << " is gone";
  }

  // All are old, or all new; or some of each, which reading tells.
  void ExpectTogether(const Content& now, bool may_be_unfinished) {
    if (together_.beginning.empty()) return;
    const auto are = [&](const Content& those) {
      return std::ranges::all_of(those, [&](const auto& file) {
        if (!file.first.starts_with(together_.beginning)) return true;
        const auto there = now.find(file.first);
        return there != now.end() && there->second == file.second;
      });
    };
    if (are(old_) || are(new_)) return;
    ASSERT_TRUE(may_be_unfinished && !together_.read.empty()) << "files of two runs are mixed";
    std::vector<std::string> words = together_.read;
    words.insert(words.begin(), SLAMDB_COMMAND);
    const ProcessResult read = RunProgram(words);
    EXPECT_NE(read.exit_code, 0) << "files of two runs are read as one";
    EXPECT_THAT(read.err, ::testing::HasSubstr("was killed between two of them"));
  }

  std::vector<std::string> line_;
  const fs::path before_;
  const Together together_;
  const TemporaryFolder inputs_, outside_;
  std::unique_ptr<TemporaryFolder> folder_;
  Content old_, new_;
  Run clean_;
};

void TryEverywhere(const std::vector<std::string>& line, bool overwrites, const Together& together = {}) {
  std::string name;
  for (const std::string& word : line) name += word + " ";
  SCOPED_TRACE(name);
  Trial trial(line, overwrites, together);
  ASSERT_TRUE(trial.RunClean()) << "nothing is written: a new verb may need a line in verbs.cc";
  ASSERT_GT(trial.calls(), 0) << "the preloaded library is not asked";
  const long step = 1 + trial.calls() / kMostCalls;
  for (const char* how : {"eio", "enospc", "kill"})
    for (long at = 1; at <= trial.calls(); at += step) trial.RunFailing(at, how);
  ::testing::Test::RecordProperty("runs", std::to_string(runs));
}

std::vector<Verb> VerbsThatWrite() {
  std::vector<Verb> verbs = AllVerbs();
  std::erase_if(verbs, [](const Verb& verb) {
    return std::ranges::none_of(verb.files, [](const FileOption& file) { return file.writes.has_value(); });
  });
  return verbs;
}

class EveryCallOf : public ::testing::TestWithParam<Verb> {};

TEST_P(EveryCallOf, FailsOrIsTheLast) { TryEverywhere(CommandLine(GetParam()), GetParam().overwrites); }

INSTANTIATE_TEST_SUITE_P(EveryVerb, EveryCallOf, ::testing::ValuesIn(VerbsThatWrite()),
                         [](const ::testing::TestParamInfo<Verb>& verb) {
                           std::string name = verb.param.name();
                           std::ranges::replace_if(
                               name, [](char letter) { return letter == ' ' || letter == '-'; }, '_');
                           return name;
                         });

TEST(EveryCallOfASave, IntoAnotherAtlas) { TryEverywhere({"repair", "a.osa", "m.db#a"}, true); }
TEST(EveryCallOfASave, OfANewAtlas) { TryEverywhere({"convert", "a.osa", "m.db#c"}, false); }
TEST(EveryCallOfASave, WithAJournal) { TryEverywhere({"repair", "a.osa", "m.db#c", "--journal", "fix.json"}, true); }

// Folders of which every file is replaced are exchanged; beside files of others, or of several runs, each is moved.
void ReplaceTogether(const std::string& format, const std::string& output, const Together& together) {
  Together with_old = together;
  with_old.before.push_back({"convert", "room.osa", output, "--to", format});
  TryEverywhere({"convert", "a.osa", output, "--to", format}, true, with_old);
}

TEST(EveryCallOfFilesTogether, ModelOfColmap) { ReplaceTogether("colmap", "out", {.beginning = "out/"}); }
TEST(EveryCallOfFilesTogether, ModelOfColmapBesideOthers) {
  ReplaceTogether("colmap", "out", {.beginning = "out/", .mine = "out/mine.txt", .read = {"info", "out"}});
}
// Its database is new there, and nothing replaces one.
TEST(EveryCallOfFilesTogether, ModelOfColmapWithADatabaseBesideOthers) {
  TryEverywhere({"convert", "a.osa", "out", "--to", "colmap", "--with-database"}, true,
                {.beginning = "out/",
                 .before = {{"convert", "room.osa", "out", "--to", "colmap"}},
                 .mine = "out/mine.txt",
                 .read = {"info", "out"},
                 .mends = true});
}
TEST(EveryCallOfFilesTogether, PagesOfAReport) {
  TryEverywhere({"report", "a.osa", "-o", "out"}, true,
                {.beginning = "out/", .before = {{"report", "a.osa", "-o", "out", "--min-keyframes", "1"}}});
}
TEST(EveryCallOfFilesTogether, SceneForSplatsBesideOthers) {
  ReplaceTogether("3dgs", "out", {.beginning = "out/", .mine = "out/mine.txt", .read = {"info", "out"}});
}
TEST(EveryCallOfFilesTogether, SceneForNerfs) { ReplaceTogether("nerf", "out", {.beginning = "out/"}); }
TEST(EveryCallOfFilesTogether, MapOfOsmap) {
  ReplaceTogether("osmap", "map.yaml", {.beginning = "map.", .read = {"info", "map.yaml"}});
}
TEST(EveryCallOfFilesTogether, PosesOfKittiAndTheirTimes) {
  ReplaceTogether("kitti", "p.kitti", {.beginning = "p.kitti", .read = {"convert", "p.kitti", "p.tum", "--dry-run"}});
}

}  // namespace
}  // namespace slamdb::testing
