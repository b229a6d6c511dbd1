// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/live/listed.h"

namespace slamdb::live {

// Which links go into the record of an object: those to what its map lists.
class LinkFilter {
 public:
  explicit LinkFilter(const Map* map) : map_(map) {}

  bool Has(const Listed* target) {
    if (target->IsListedIn(map_)) return true;
    waits_ = waits_ || target->Owner() == nullptr;
    return false;
  }

  // Whether a target was in no map yet: it may come, and then the link belongs into the record.
  bool waits() const { return waits_; }

 private:
  const Map* map_;
  bool waits_ = false;
};

}  // namespace slamdb::live
