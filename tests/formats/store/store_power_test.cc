// SPDX-License-Identifier: BSD-3-Clause
// The power is cut at every sync of everything that writes to a store, with what was not synced lost in part: what is
// then on the disk is the old store or the new one, whole.
#include <gmock/gmock.h>

#include <fstream>
#include <functional>
#include <iostream>

#include "slamdb/base/detail/concat.h"
#include "slamdb/model/digest.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/formats/store/atlases.h"
#include "tests/formats/store/recorder.h"

namespace slamdb::store_test {
namespace {

Atlas SmallAtlas(std::size_t points = 40) {
  SyntheticOptions options;
  options.keyframes = 3;
  options.points = points;
  options.features = 100;
  options.threads = 1;
  return SynthesizeAtlas(options);
}

void Save(const std::string& path, const std::string& name, const Atlas& atlas) {
  Store::OpenForWriting(path).Save(name, atlas, {.threads = 1});
}

// What a reader finds: each atlas with its hash and those of its revisions, or why there is none.
std::string Found(const std::string& path) {
  try {
    Store store = Store::Open(path);
    std::string found;
    for (const std::string& name : store.Names())
      found += detail::Concat(name, " ", HashOf(store.Load(name, {.threads = 1})), "; ");
    for (const HistoryEntry& entry : store.Log()) {
      if (!entry.readable) continue;
      const std::string revision = detail::Concat(entry.atlas, "@", entry.revision);
      found += detail::Concat(revision, " ", HashOf(store.Load(revision, {.threads = 1})), "; ");
    }
    return found;
  } catch (const Error& error) {
    const bool is_nothing = error.kind() == ErrorKind::kNotFound ||
                            std::string(error.what()).find("an empty database") != std::string::npos;
    return is_nothing ? "" : error.problem();
  }
}

class StorePower : public ::testing::Test {
 protected:
  using Work = std::function<void(const std::string&)>;

  Files OnDisk() const {
    Files files;
    for (const char* suffix : {"", "-wal", "-journal"})
      if (std::filesystem::exists(path_ + suffix)) files[path_ + suffix] = FileBytes(path_ + suffix);
    return files;
  }
  void PutOnDisk(const Files& files) const {
    for (const char* suffix : {"", "-wal", "-journal", "-shm"}) std::filesystem::remove(path_ + suffix);
    for (const auto& [path, content] : files) std::ofstream(path, std::ios::binary) << content;
  }

  void CutThePowerDuring(const Work& work) {
    const std::string before = Found(path_);
    const Files old_files = OnDisk();
    StartRecording(path_);
    work(path_);
    const std::vector<DiskEvent> events = StopRecording();
    const std::string after = Found(path_);
    const std::vector<Files> states = StatesAfterPowerCut(old_files, events, 6);
    std::size_t old = 0;
    for (const Files& state : states) {
      PutOnDisk(state);
      const std::string found = Found(path_);
      EXPECT_TRUE(found == before || found == after) << found << "\n  is neither\n" << before << "\n  nor\n" << after;
      if (std::filesystem::exists(path_)) {
        EXPECT_EQ(Sql(path_, "PRAGMA integrity_check"), "ok");
      }
      old += found == before;
    }
    PutOnDisk(DurableState(old_files, events));
    EXPECT_EQ(Found(path_), after) << "what was reported as done is lost";
    std::cout << events.size() << " events, " << states.size() << " states, " << old << " of them the old store\n";
    EXPECT_GT(states.size(), 8U);
  }

  TemporaryFolder folder_;
  std::string path_ = folder_ / "s.db";
};

TEST_F(StorePower, FirstSave) {
  CutThePowerDuring([](const std::string& path) { Save(path, "a", SmallAtlas()); });
}

TEST_F(StorePower, SecondSave) {
  Save(path_, "a", SmallAtlas());
  CutThePowerDuring([](const std::string& path) { Save(path, "b", SmallAtlas(60)); });
}

TEST_F(StorePower, IncrementalSave) {
  Save(path_, "a", SmallAtlas());
  CutThePowerDuring([](const std::string& path) {
    Atlas atlas = SmallAtlas();
    atlas.maps[0].points[7].position.x() += 1;
    atlas.maps[0].keyframes[1].timestamp += 1;
    Save(path, "a", atlas);
  });
}

TEST_F(StorePower, Remove) {
  Save(path_, "a", SmallAtlas());
  Save(path_, "b", SmallAtlas(60));
  CutThePowerDuring([](const std::string& path) { Store::OpenForWriting(path).Remove("a"); });
}

TEST_F(StorePower, GiveUp) {
  Atlas atlas = SmallAtlas();
  for (int i = 0; i < 5; ++i) {
    atlas.maps[0].points.pop_back();
    atlas.maps[0].points[i].position.x() += 1;
    Save(path_, "a", atlas);
  }
  Store::OpenForWriting(path_).Tag("a@2", "kept");
  CutThePowerDuring([](const std::string& path) { Store::OpenForWriting(path).GiveUp({.keep = 2}); });
  EXPECT_EQ(Sql(path_, "SELECT count(*) FROM revision"), "3");
}

TEST_F(StorePower, Vacuum) {
  Save(path_, "a", SmallAtlas());
  Save(path_, "b", SmallAtlas(60));
  Store::OpenForWriting(path_).Remove("a");
  CutThePowerDuring([](const std::string& path) { Store::OpenForWriting(path).Vacuum(); });
}

TEST_F(StorePower, MigrateBackAndForth) {
  Save(path_, "a", SmallAtlas());
  CutThePowerDuring([](const std::string& path) { MigrateStore(path, {.back = true, .backup = false}); });
  CutThePowerDuring([](const std::string& path) { MigrateStore(path, {.backup = false}); });
}

TEST_F(StorePower, RestoredBackup) {
  const std::string backup = folder_ / "backup.db";
  Save(backup, "yesterday", SmallAtlas(60));
  Save(path_, "a", SmallAtlas());
  CutThePowerDuring([&](const std::string& path) { Store::Open(backup).Backup(path, true); });
}

}  // namespace
}  // namespace slamdb::store_test
