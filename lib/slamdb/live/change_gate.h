// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>

#include "slamdb/export.h"

namespace slamdb::live {

// Lets any number of threads change a live atlas at the same time, and holds all of them while a snapshot is taken, so
// that no snapshot sees half a change.
// Two atomic operations for a change; waiting sleeps.
// A snapshot that waits is served before changes that begin later.
class SLAMDB_EXPORT ChangeGate {
 public:
  ChangeGate() = default;
  ChangeGate(const ChangeGate&) = delete;
  ChangeGate& operator=(const ChangeGate&) = delete;

 private:
  friend class Change;
  friend class ClosedGate;

  void Enter();
  void Leave();
  void Close();
  void Open();

  static constexpr std::uint32_t kClosed = 1U << 31;
  std::atomic<std::uint32_t> state_ = 0;  // changes that are under way, and kClosed
  std::mutex closer_;                     // one snapshot at a time
};

// A change that is under way, for as long as the object lives.
// Every method of the live classes that changes something holds one; clients hold one around calls that belong together
// (`point->AddObservation(...)` and `keyframe->AddMapPoint(...)`), so that a save has both or none. Changes nest.
// It is the outermost lock: begin it before taking any mutex, and do not wait inside it for a thread that changes the
// atlas.
class [[nodiscard]] Change {
 public:
  SLAMDB_EXPORT explicit Change(ChangeGate& gate);
  SLAMDB_EXPORT ~Change();
  Change(const Change&) = delete;
  Change& operator=(const Change&) = delete;

 private:
  ChangeGate& gate_;
};

// Waits until the changes that are under way are done and holds new ones until it goes.
// Under it the whole graph may be read without any lock.
// Throws Error (kUsage) in a thread that is inside a Change of the same gate, which would wait for itself.
class [[nodiscard]] ClosedGate {
 public:
  SLAMDB_EXPORT explicit ClosedGate(ChangeGate& gate);
  SLAMDB_EXPORT ~ClosedGate();
  ClosedGate(const ClosedGate&) = delete;
  ClosedGate& operator=(const ClosedGate&) = delete;

 private:
  ChangeGate& gate_;
  std::unique_lock<std::mutex> alone_;
};

}  // namespace slamdb::live
