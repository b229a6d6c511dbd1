// SPDX-License-Identifier: BSD-3-Clause
#include "tests/formats/store/recorder.h"

#include <sqlite3.h>

#include <algorithm>
#include <functional>
#include <mutex>
#include <random>
#include <set>

namespace slamdb::store_test {
namespace {

// ---- a VFS over the system's that writes down what passes

struct Recording {
  std::mutex mutex;
  bool on = false;
  std::string prefix;
  std::vector<DiskEvent> events;
  sqlite3_vfs* system = nullptr;

  void Add(DiskEvent event) {
    const std::lock_guard lock(mutex);
    if (on && event.file.starts_with(prefix)) events.push_back(std::move(event));
  }
};
Recording& TheRecording() {
  static Recording recording;
  return recording;
}

struct RecordedFile {
  sqlite3_file base;
  const char* name;  // SQLite keeps it while the file is open; null for temporary files
  sqlite3_file* real;
};
RecordedFile& Self(sqlite3_file* file) { return *reinterpret_cast<RecordedFile*>(file); }
sqlite3_file* Real(sqlite3_file* file) { return Self(file).real; }
void Note(sqlite3_file* file, DiskEvent event) {
  if (Self(file).name == nullptr) return;
  event.file = Self(file).name;
  TheRecording().Add(std::move(event));
}

int Write(sqlite3_file* file, const void* bytes, int count, sqlite3_int64 place) {
  Note(file, {.kind = DiskEvent::Kind::kWrite,
              .file = {},
              .place = static_cast<std::uint64_t>(place),
              .bytes = std::string(static_cast<const char*>(bytes), static_cast<std::size_t>(count))});
  return Real(file)->pMethods->xWrite(Real(file), bytes, count, place);
}
int Truncate(sqlite3_file* file, sqlite3_int64 size) {
  Note(file, {.kind = DiskEvent::Kind::kTruncate, .file = {}, .place = static_cast<std::uint64_t>(size)});
  return Real(file)->pMethods->xTruncate(Real(file), size);
}
int Sync(sqlite3_file* file, int flags) {
  Note(file, {.kind = DiskEvent::Kind::kSync, .file = {}});
  return Real(file)->pMethods->xSync(Real(file), flags);
}

// What is passed on as it is.
template <auto method, class... Arguments>
int Pass(sqlite3_file* file, Arguments... arguments) {
  return (Real(file)->pMethods->*method)(Real(file), arguments...);
}

constexpr sqlite3_io_methods kMethods = {
    .iVersion = 2,
    .xClose = Pass<&sqlite3_io_methods::xClose>,
    .xRead = Pass<&sqlite3_io_methods::xRead, void*, int, sqlite3_int64>,
    .xWrite = Write,
    .xTruncate = Truncate,
    .xSync = Sync,
    .xFileSize = Pass<&sqlite3_io_methods::xFileSize, sqlite3_int64*>,
    .xLock = Pass<&sqlite3_io_methods::xLock, int>,
    .xUnlock = Pass<&sqlite3_io_methods::xUnlock, int>,
    .xCheckReservedLock = Pass<&sqlite3_io_methods::xCheckReservedLock, int*>,
    .xFileControl = Pass<&sqlite3_io_methods::xFileControl, int, void*>,
    .xSectorSize = Pass<&sqlite3_io_methods::xSectorSize>,
    .xDeviceCharacteristics = Pass<&sqlite3_io_methods::xDeviceCharacteristics>,
    .xShmMap = Pass<&sqlite3_io_methods::xShmMap, int, int, int, void volatile**>,
    .xShmLock = Pass<&sqlite3_io_methods::xShmLock, int, int, int>,
    .xShmBarrier = [](sqlite3_file* file) { Real(file)->pMethods->xShmBarrier(Real(file)); },
    .xShmUnmap = Pass<&sqlite3_io_methods::xShmUnmap, int>,
};

int Open(sqlite3_vfs*, const char* name, sqlite3_file* file, int flags, int* out_flags) {
  RecordedFile& self = Self(file);
  self.name = name;
  self.real = reinterpret_cast<sqlite3_file*>(&self + 1);
  sqlite3_vfs* system = TheRecording().system;
  const int code = system->xOpen(system, name, self.real, flags, out_flags);
  file->pMethods = self.real->pMethods == nullptr ? nullptr : &kMethods;
  return code;
}

int Delete(sqlite3_vfs*, const char* name, int sync) {
  TheRecording().Add({.kind = DiskEvent::Kind::kDelete, .file = name, .durable = sync != 0});
  sqlite3_vfs* system = TheRecording().system;
  return system->xDelete(system, name, sync);
}

// For as long as the process lives: connections and other VFSs keep addresses of it.
void Install() {
  if (TheRecording().system != nullptr) return;
  sqlite3_initialize();
  TheRecording().system = sqlite3_vfs_find(nullptr);
  static sqlite3_vfs vfs = *TheRecording().system;
  vfs.zName = "recorder";
  vfs.pNext = nullptr;
  vfs.szOsFile += static_cast<int>(sizeof(RecordedFile));
  vfs.xOpen = Open;
  vfs.xDelete = Delete;
  sqlite3_vfs_register(&vfs, 1);
}

// ---- the disk

void Apply(Files& files, const DiskEvent& event) {
  if (event.kind == DiskEvent::Kind::kDelete) {
    files.erase(event.file);
    return;
  }
  std::string& content = files[event.file];
  if (event.kind == DiskEvent::Kind::kTruncate) content.resize(event.place);
  if (event.kind != DiskEvent::Kind::kWrite) return;
  if (content.size() < event.place + event.bytes.size()) content.resize(event.place + event.bytes.size());
  content.replace(event.place, event.bytes.size(), event.bytes);
}

// Replays events; calls at_cut(durable, pending) before each sync and at the end.
void Replay(Files files, const std::vector<DiskEvent>& events,
            const std::function<void(const Files&, const std::vector<DiskEvent>&)>& at_cut) {
  std::vector<DiskEvent> pending;
  const auto make_durable = [&](const std::string& file) {
    std::erase_if(pending, [&](const DiskEvent& event) {
      if (event.file == file) Apply(files, event);
      return event.file == file;
    });
  };
  // What syncing their folder does. Of a file that was made anew since, what was written then stays pending.
  const auto make_deletions_durable = [&] {
    for (auto event = pending.begin(); event != pending.end();) {
      if (event->kind != DiskEvent::Kind::kDelete) {
        ++event;
        continue;
      }
      const std::string file = event->file;
      files.erase(file);
      const auto rest = std::remove_if(pending.begin(), event + 1, [&](const DiskEvent& e) { return e.file == file; });
      event = pending.erase(rest, event + 1);
    }
  };
  for (const DiskEvent& event : events) {
    if (event.kind == DiskEvent::Kind::kSync) {
      at_cut(files, pending);
      make_durable(event.file);
    } else {
      pending.push_back(event);
      if (event.durable) make_deletions_durable();
    }
  }
  at_cut(files, pending);
}

}  // namespace

void StartRecording(const std::string& prefix) {
  Install();
  const std::lock_guard lock(TheRecording().mutex);
  TheRecording().prefix = prefix;
  TheRecording().events.clear();
  TheRecording().on = true;
}

std::vector<DiskEvent> StopRecording() {
  const std::lock_guard lock(TheRecording().mutex);
  TheRecording().on = false;
  return std::move(TheRecording().events);
}

std::vector<Files> StatesAfterPowerCut(const Files& before, const std::vector<DiskEvent>& events, int subsets) {
  constexpr std::size_t kMostSingles = 16;  // of a long run of writes, those spread evenly over it
  std::set<Files> states;
  std::mt19937 random(1);
  Replay(before, events, [&](const Files& durable, const std::vector<DiskEvent>& pending) {
    const auto add = [&](const auto& is_there) {
      Files files = durable;
      for (std::size_t i = 0; i < pending.size(); ++i)
        if (is_there(i)) Apply(files, pending[i]);
      states.insert(std::move(files));
    };
    add([](std::size_t) { return false; });
    add([](std::size_t) { return true; });
    const std::size_t step = 1 + pending.size() / kMostSingles;
    for (std::size_t missing = 0; missing < pending.size(); missing += step)
      add([&](std::size_t i) { return i != missing; });
    for (int n = 0; n < subsets && pending.size() > 1; ++n) add([&](std::size_t) { return random() % 2 == 0; });
  });
  return {states.begin(), states.end()};
}

Files DurableState(const Files& before, const std::vector<DiskEvent>& events) {
  Files last;
  Replay(before, events, [&](const Files& durable, const std::vector<DiskEvent>&) { last = durable; });
  return last;
}

}  // namespace slamdb::store_test
