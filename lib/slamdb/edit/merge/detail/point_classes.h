// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include "slamdb/model/atlas.h"
#include "slamdb/model/index.h"

namespace slamdb::detail {

// Points that a side replaced by others. All that go into one form a class, which goes by the name of one of them: of
// those that ours has, else of those that theirs has, the one of the lowest id.
class PointClasses {
 public:
  PointClasses() = default;
  PointClasses(const AtlasIndex& base, const AtlasIndex& ours, const AtlasIndex& theirs);

  MapPointId Of(MapPointId id) const {
    const auto found = classes_.find(id.value());
    return found == classes_.end() ? id : MapPointId(found->second);
  }
  // {gone, the name of its class}, ascending.
  std::vector<std::pair<MapPointId, MapPointId>> Gone() const;

 private:
  std::unordered_map<std::uint64_t, std::uint64_t> classes_;
};

}  // namespace slamdb::detail
