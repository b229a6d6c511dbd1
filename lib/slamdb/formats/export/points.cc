// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/export/detail/points.h"

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/export/detail/maps.h"
#include "slamdb/formats/export/detail/raw.h"
#include "slamdb/formats/export/detail/rows.h"

namespace slamdb::detail {
PointRows::PointRows(const Atlas& atlas, const Target& target, const WriteOptions& options, Positions positions)
    : maps_(ChooseMaps(atlas, options, target)) {
  std::size_t all = 0;
  for (const Map* map : maps_) all += map->points.size();
  rows_.reserve(all);
  for (std::uint32_t row = 0; row < maps_.size(); ++row) {
    reprojections_.emplace_back(atlas, *maps_[row]);
    begins_.push_back(rows_.size());
    for (const MapPoint& point : maps_[row]->points) {
      if (point.bad)
        ++bad_;
      else if (positions == Positions::kFinite && !point.position.allFinite())
        ++not_finite_;
      else
        rows_.push_back({&point, row});
    }
  }
  begins_.push_back(rows_.size());
}

std::string PointRows::Summary() const { return CountWritten(rows_.size(), "point", bad_); }

void PointRows::WarnOfNotFinite(Notices& notices) const {
  if (not_finite_ > 0) notices.Warn("left out because the position is not finite: " + Counted(not_finite_, "point"));
}

IdColumn ColumnForMapIds(const PointRows& points) {
  for (const Map* map : points.maps())
    if (!FitsUnsigned32(map->id.value())) return IdColumn::kDouble;
  return IdColumn::kUnsigned32;
}

IdColumn ColumnForPointIds(const PointRows& points) {
  for (std::size_t row = 0; row < points.size(); ++row)
    if (!FitsUnsigned32(points[row].point->id.value())) return IdColumn::kDouble;
  return IdColumn::kUnsigned32;
}

void AppendRawId(std::string& out, std::uint64_t id, IdColumn column) {
  if (column == IdColumn::kUnsigned32)
    AppendRaw(out, static_cast<std::uint32_t>(id));
  else
    AppendRaw(out, static_cast<double>(id));
}

}  // namespace slamdb::detail
