// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/run_files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <mutex>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/descriptor.h"
#include "slamdb/base/detail/links.h"
#include "slamdb/base/detail/recognize.h"
#include "slamdb/base/detail/server.h"
#include "slamdb/base/error.h"

namespace slamdb::detail {
namespace {

// A file, or a name in a folder, whether a file has it or not; of a server, which database it is.
using Key = std::tuple<dev_t, ino_t, std::string>;

struct Use {
  std::string said;
  bool output = false;
};

// By what is used: the whole of a file, then its atlases, so that one of ten thousand is found among them.
using Uses = std::multimap<std::pair<Key, AtlasName>, Use>;

struct Run {
  std::mutex mutex;
  bool keeps_inputs = false;
  Uses uses;
};

Run& TheRun() {
  static Run run;
  return run;
}

constexpr std::array<std::string_view, 3> kBesideStores = {"-wal", "-shm", "-journal"};
constexpr std::array<std::string_view, 2> kLogs = {"-wal", "-journal"};

// The database that a file of this name belongs to; empty: to none.
std::string DatabaseOf(const std::string& path) {
  if (IsServer(path)) return {};
  const std::string followed = FollowLinks(path).string();
  for (const std::string_view suffix : kBesideStores) {
    if (!followed.ends_with(suffix)) continue;
    const std::string database = followed.substr(0, followed.size() - suffix.size());
    struct stat status {};
    if (::stat(database.c_str(), &status) == 0 && S_ISREG(status.st_mode) && IsDatabase(database)) return database;
  }
  return {};
}

void RefuseBesideDatabase(const std::string& path) {
  const std::string database = DatabaseOf(path);
  if (!database.empty())
    throw Error(
        ErrorKind::kUsage, path, "",
        Concat("belongs to the SQLite database ", database, ", which cannot be read without it; name another output"));
}

// Under which a file is entered: two for one that is there. None for what is no regular file.
std::vector<Key> KeysOf(const std::string& path) {
  if (IsServer(path)) return {Key(0, 0, DatabaseOfServer(path))};  // no file has the inode 0
  std::vector<Key> keys;
  struct stat status {};
  if (::stat(path.c_str(), &status) == 0) {
    if (!S_ISREG(status.st_mode)) return {};
    keys.emplace_back(status.st_dev, status.st_ino, "");
  }
  const std::filesystem::path followed = FollowLinks(path);
  if (::stat(FolderOf(followed).c_str(), &status) == 0)
    keys.emplace_back(status.st_dev, status.st_ino, followed.filename());
  return keys;
}

// Of what lies beside a store.
std::vector<Key> KeysBeside(const std::string& path, const AtlasName& atlas, const std::vector<Key>& keys) {
  std::vector<Key> beside;
  if (!atlas || keys.empty() || IsServer(path)) return beside;
  const auto& [device, folder, name] = keys.back();
  for (const std::string_view suffix : kBesideStores) beside.emplace_back(device, folder, Concat(name, suffix));
  return beside;
}

// And those.
std::vector<Key> KeysOf(const std::string& path, const AtlasName& atlas) {
  std::vector<Key> keys = KeysOf(path);
  const std::vector<Key> beside = KeysBeside(path, atlas, keys);
  keys.insert(keys.end(), beside.begin(), beside.end());
  return keys;
}

bool Collide(const AtlasName& a, const AtlasName& b) { return !a || !b || (*a == *b && !a->empty()); }

std::string Said(const std::string& path, const AtlasName& atlas) {
  return atlas && !atlas->empty() ? path + "#" + *atlas : path;
}

// What is said of an output that collides with one of `used`.
std::string Problem(const std::string& said, const AtlasName& atlas, const AtlasName& used, const Use& use) {
  if (use.output)
    return "is an output of this run already" + (said == use.said ? "" : ", as " + use.said) + "; name another file";
  const std::string which = said == use.said ? "the input" : "the input " + use.said;
  return (used && !atlas ? "holds " : "is ") + which + ", which is never changed; name another output";
}

void Refuse(const Run& run, const std::vector<Key>& keys, const std::string& path, const AtlasName& atlas,
            bool outputs_too) {
  const std::string said = Said(path, atlas);
  const auto refuse = [&](Uses::const_iterator first, Uses::const_iterator last) {
    for (auto use = first; use != last; ++use)
      if (outputs_too || !use->second.output)
        throw Error(ErrorKind::kUsage, said, "", Problem(said, atlas, use->first.second, use->second));
  };
  for (const Key& key : keys) {
    const auto whole = run.uses.equal_range({key, std::nullopt});
    refuse(whole.first, whole.second);
    if (!atlas) {
      const auto is_of_it = [&](const auto& use) { return use.first.first == key; };
      refuse(whole.second, std::find_if_not(whole.second, run.uses.end(), is_of_it));
    } else if (!atlas->empty()) {
      const auto same = run.uses.equal_range({key, atlas});
      refuse(same.first, same.second);
    }
  }
}

// What lies beside a store is its, whichever atlas of it is meant: it is entered once.
void Enter(Run& run, const std::string& path, const AtlasName& atlas, bool output) {
  const std::vector<Key> keys = KeysOf(path);
  const Use use{.said = Said(path, atlas), .output = output};
  for (const Key& key : keys) run.uses.emplace(std::pair(key, atlas), use);
  for (const Key& key : KeysBeside(path, atlas, keys))
    if (const std::pair place(key, AtlasName("")); !run.uses.contains(place)) run.uses.emplace(place, use);
}

}  // namespace

bool IsDatabase(const std::string& path) {
  std::array<char, 16> head{};
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  const ssize_t got = file.value >= 0 ? ::pread(file.value, head.data(), head.size(), 0) : 0;
  if (got > 0 && IsSqlite({head.data(), static_cast<std::size_t>(got)})) return true;
  struct stat log {};
  return ::stat((path + "-wal").c_str(), &log) == 0 && log.st_size > 0;
}

std::string LogOfDatabase(const std::string& database) {
  for (const std::string_view suffix : kLogs) {
    const std::string log = Concat(database, suffix);
    struct stat status {};
    if (::stat(log.c_str(), &status) == 0 && status.st_size > 0) return log;
  }
  return {};
}

void RefuseLogOfAnother(const std::string& place) {
  const std::string database = LeadsTo(place);
  const std::string log = LogOfDatabase(database);
  struct stat status {};
  if (log.empty() || (::stat(database.c_str(), &status) == 0 && IsDatabase(database))) return;
  throw Error(ErrorKind::kAlreadyExists, log, "",
              Concat("is the log of a database that is gone, which SQLite would play into ", place,
                     " when that is opened; remove it, or name another output"));
}

void KeepInputs() {
  const std::lock_guard lock(TheRun().mutex);
  TheRun().keeps_inputs = true;
}

bool IsSameFile(const std::string& path, const AtlasName& atlas, const std::string& other,
                const AtlasName& other_atlas) {
  const std::vector<Key> keys = KeysOf(path, atlas), others = KeysOf(other, other_atlas);
  return Collide(atlas, other_atlas) && std::ranges::find_first_of(keys, others) != keys.end();
}

void EnterInput(const std::string& path, const AtlasName& atlas) {
  Run& run = TheRun();
  const std::lock_guard lock(run.mutex);
  if (run.keeps_inputs) Enter(run, path, atlas, /*output=*/false);
}

void EnterRevision(const std::string& path, const std::string& atlas, const std::string& revision) {
  if (revision == atlas) return;
  Run& run = TheRun();
  const std::lock_guard lock(run.mutex);
  for (const Key& key : KeysOf(path)) {
    auto use = run.uses.lower_bound({key, atlas});
    while (use != run.uses.end() && use->first == std::pair(key, AtlasName(atlas))) {
      const auto entered = use++;
      if (entered->second.output) continue;
      run.uses.erase(entered);
      run.uses.emplace(std::pair(key, AtlasName(revision)), Use{.said = Said(path, revision)});
    }
  }
}

void RefuseInput(const std::string& path, const AtlasName& atlas) {
  if (!atlas) RequireFile(path);
  RefuseBesideDatabase(path);
  Run& run = TheRun();
  const std::lock_guard lock(run.mutex);
  if (run.keeps_inputs) Refuse(run, KeysOf(path, atlas), path, atlas, /*outputs_too=*/false);
}

bool IsOfThisRun(const std::string& path) {
  Run& run = TheRun();
  const std::lock_guard lock(run.mutex);
  return std::ranges::any_of(KeysOf(path), [&](const Key& key) {
    const auto use = run.uses.lower_bound({key, std::nullopt});
    return use != run.uses.end() && use->first.first == key;
  });
}

void EnterOutput(const std::string& path, const AtlasName& atlas) {
  if (!atlas) RequireFile(path);
  RefuseBesideDatabase(path);
  Run& run = TheRun();
  const std::lock_guard lock(run.mutex);
  if (!run.keeps_inputs) return;
  Refuse(run, KeysOf(path, atlas), path, atlas, /*outputs_too=*/true);
  Enter(run, path, atlas, /*output=*/true);
}

void EnterPlaced(const std::string& path) {
  Run& run = TheRun();
  const std::lock_guard lock(run.mutex);
  if (run.keeps_inputs) Enter(run, path, std::nullopt, /*output=*/true);
}

}  // namespace slamdb::detail
