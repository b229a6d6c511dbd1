// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <unordered_map>

#include "slamdb/align/detail/map_views.h"
#include "slamdb/model/index.h"

namespace slamdb::detail {

// A map as it would be without one of its keyframes: without the points that fewer than two others see, and with
// descriptors of the others. Where points are stays as it was found with it.
class KnownMap {
 public:
  KnownMap(const MapViews& map) : map_(map) {}  // NOLINT(google-explicit-constructor): a map is known as it is
  // Without the keyframe of a left view; kNoRow: with all.
  KnownMap(const MapViews& map, std::uint32_t without);

  const MapViews& views() const { return map_; }
  bool LeavesOut(std::uint32_t view) const { return view == without_ || (has_pair_ && view == without_ + 1); }
  // Null: the point is not known.
  const Descriptor* DescriptorOf(std::uint32_t point) const {
    if (!changed_.empty())
      if (const auto changed = changed_.find(point); changed != changed_.end()) return changed->second;
    return map_.points()[point].descriptor;
  }

 private:
  const MapViews& map_;
  std::uint32_t without_ = kNoRow;
  bool has_pair_ = false;
  std::unordered_map<std::uint32_t, const Descriptor*> changed_;  // by point
};

}  // namespace slamdb::detail
