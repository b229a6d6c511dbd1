// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "slamdb/export.h"
#include "slamdb/formats/store/store.h"

namespace slamdb::live {

class Atlas;

struct CheckpointOptions {
  double interval = 10;  // seconds from the start of one save to that of the next, at most 1e9; 0: only by Save()
  std::string provenance = "checkpoint";  // for the store's history
  bool sync = true;                       // a save survives power loss
  int threads = 1;                        // for the work beside the SLAM threads; 0: every core
};

struct CheckpointReport {
  std::uint64_t number = 0;                 // counts the saves, from 1: the whole atlas
  std::uint64_t keyframes = 0, points = 0;  // that were copied: new, changed or erased
  double pause = 0;                         // seconds for which changes of the atlas had to wait
  double duration = 0;                      // seconds for all of it
  SaveReport saved;
};

// Keeps an atlas of a store up to date with a live one while SLAM threads work on it.
// It holds them only while it copies what changed since the last time; writing is done beside them, in one transaction:
// the store always holds one whole moment.
// A save that fails (disk full, store locked) loses nothing: the next one writes what it would have written.
// One checkpointer for an atlas at a time; it must go before the atlas does.
// All methods are thread-safe.
class SLAMDB_EXPORT Checkpointer {
 public:
  // Saves the whole atlas to `location` (`store.db#name`), replacing one of that name, and starts the thread.
  // Throws Error when that fails, and (kUsage) when the location is no store, the interval is negative or no number, or
  // the atlas has a checkpointer.
  Checkpointer(Atlas& atlas, const std::string& location, const CheckpointOptions& options = {});
  // Ends the thread; what changed since the last save is not saved.
  ~Checkpointer();
  Checkpointer(const Checkpointer&) = delete;
  Checkpointer& operator=(const Checkpointer&) = delete;

  // Saves what changed now, in this thread. Not inside a Change. Throws Error.
  CheckpointReport Save();

  CheckpointReport LastSave() const;               // that succeeded
  std::optional<std::string> LastFailure() const;  // of the latest save of the thread; none: it succeeded

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace slamdb::live
