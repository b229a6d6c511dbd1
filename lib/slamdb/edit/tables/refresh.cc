// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "slamdb/edit/tables/detail/edited.h"
#include "slamdb/model/detail/observed.h"

namespace slamdb::detail {
std::uint64_t RefreshMoved(const AtlasIndex& index, const std::vector<EditedMap>& edited, Atlas& atlas) {
  std::uint64_t refreshed = 0;
  for (std::size_t m = 0; m < atlas.maps.size(); ++m) {
    const EditedRows& rows = edited[m].points;
    const auto has_moved = [&](const Observation& observation) {
      const std::uint32_t row = index.KeyFrameRow(m, observation.keyframe);
      return row != kNoRow && edited[m].keyframes.moved[row] != 0;
    };
    const auto find = [&](KeyFrameId id) { return index.FindKeyFrame(m, id); };
    for (std::size_t row = 0; row < rows.moved.size(); ++row) {
      MapPoint& point = atlas.maps[m].points[row];
      if (rows.moved[row] == 0 && !std::ranges::any_of(point.observations, has_moved)) continue;
      refreshed += RefreshView(find, rows.own_normal[row] != 0, rows.own_range[row] != 0, point) ? 1 : 0;
    }
  }
  return refreshed;
}

}  // namespace slamdb::detail
