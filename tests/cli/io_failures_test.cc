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
#include "slamdb/formats/sqlite/store.h"
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
  Store store = Store::Open(path);
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

// A verb in a folder of its own, which every run begins anew.
class Trial {
 public:
  Trial(const std::vector<std::string>& line, bool overwrites) : line_(line), before_(fs::current_path()) {
    FillFolder(inputs_.path().string());
    if (overwrites) {
      WriteWholeFile(inputs_ / "out.osa", "old");
      line_.push_back("-O");
    }
    line_.insert(line_.end(), {"--threads", "1"});
  }
  ~Trial() { fs::current_path(before_); }

  // False: the verb writes nothing. What vacuum writes means what it meant.
  bool RunClean() {
    Begin();
    old_ = ContentHere();
    clean_ = RunOn(line_, 0, "none", Log());
    new_ = ContentHere();
    EXPECT_THAT(clean_.exit_code, ::testing::AnyOf(0, 1, 3)) << "a new verb may need a line in verbs.cc";
    return new_ != old_ || line_.front() == "vacuum";
  }
  long calls() const { return clean_.calls; }

  void RunFailing(long at, const std::string& how) {
    Begin();
    const Run run = RunOn(line_, at, how, Log());
    SCOPED_TRACE(how + " at call " + std::to_string(at) + " (" + run.failed + ")");
    const Content now = ContentHere();
    ExpectOldOrNew(now, /*temporaries=*/how == "kill");
    if (run.exit_code == clean_.exit_code && run.exit_code != 1) {
      EXPECT_EQ(now, new_) << "exit status " << run.exit_code;
    }
    if (how != "kill") return;
    const Run next = RunOn(line_, 0, "none", Log());
    EXPECT_THAT(next.exit_code, ::testing::AnyOf(clean_.exit_code, 1));
    ExpectOldOrNew(ContentHere(), /*temporaries=*/false);
  }

 private:
  std::string Log() const { return outside_ / "log"; }

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

  std::vector<std::string> line_;
  const fs::path before_;
  const TemporaryFolder inputs_, outside_;
  std::unique_ptr<TemporaryFolder> folder_;
  Content old_, new_;
  Run clean_;
};

void TryEverywhere(const std::vector<std::string>& line, bool overwrites) {
  std::string name;
  for (const std::string& word : line) name += word + " ";
  SCOPED_TRACE(name);
  Trial trial(line, overwrites);
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

}  // namespace
}  // namespace slamdb::testing
