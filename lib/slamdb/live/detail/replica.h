// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "slamdb/live/detail/snapshot.h"

namespace slamdb::live {

// A copy at rest of a live atlas that follows it, snapshot by snapshot. After each it equals what ToModel would have
// given at that moment. Work beside the SLAM threads: it touches nothing of theirs. Not thread-safe.
class Replica {
 public:
  void Apply(Snapshot snapshot);
  const slamdb::Atlas& atlas() const { return atlas_; }

 private:
  slamdb::Atlas atlas_;
  std::vector<const Map*> sources_;  // of its maps
};

}  // namespace slamdb::live
