// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

// What SQLite asks of the disk, so that a test can cut the power at any moment of it.
namespace slamdb::store_test {

struct DiskEvent {
  enum class Kind { kWrite, kTruncate, kDelete, kSync };
  Kind kind;
  std::string file;         // path
  std::uint64_t place = 0;  // of a write; the new size of a file that is truncated
  std::string bytes = {};   // of a write
  bool durable = false;     // a deletion whose folder was synced
};

using Files = std::map<std::string, std::string>;  // content by path

// Records everything that happens to files whose path begins with `prefix`, but for the shared memory of the log's
// index, which no power cut leaves. Recording goes on until Stop().
void StartRecording(const std::string& prefix);
std::vector<DiskEvent> StopRecording();

// Each state in which a power cut may leave the disk, once: at each sync, and at the end, the writes that no sync has
// made durable are all there, or none of them, or all but one, or some (`subsets` of them by fixed seeds).
std::vector<Files> StatesAfterPowerCut(const Files& before, const std::vector<DiskEvent>& events, int subsets);

// The same at the end alone, when only what was synced is there.
Files DurableState(const Files& before, const std::vector<DiskEvent>& events);

}  // namespace slamdb::store_test
