// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/export/detail/points.h"

#include <limits>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/export/detail/maps.h"
#include "slamdb/formats/export/detail/raw.h"
#include "slamdb/formats/export/detail/rows.h"

namespace slamdb::detail {
namespace {

constexpr std::uint64_t kLargestUnsigned32 = std::numeric_limits<std::uint32_t>::max();

}  // namespace

PointRows::PointRows(const Atlas& atlas, const Target& target, const WriteOptions& options)
    : maps_(ChooseMaps(atlas, options, target)) {
  std::size_t all = 0;
  for (const Map* map : maps_) all += map->points.size();
  rows_.reserve(all);
  for (std::uint32_t row = 0; row < maps_.size(); ++row) {
    reprojections_.emplace_back(atlas, *maps_[row]);
    for (const MapPoint& point : maps_[row]->points)
      if (!point.bad) rows_.push_back({&point, row});
  }
  bad_ = all - rows_.size();
}

std::string PointRows::Summary() const { return CountWritten(rows_.size(), "point", bad_); }

std::array<std::uint8_t, 3> ColorOfMap(MapId id) {
  // The "Tableau 10" palette.
  static constexpr std::array<std::array<std::uint8_t, 3>, 10> kColors = {{{31, 119, 180},
                                                                           {255, 127, 14},
                                                                           {44, 160, 44},
                                                                           {214, 39, 40},
                                                                           {148, 103, 189},
                                                                           {140, 86, 75},
                                                                           {227, 119, 194},
                                                                           {127, 127, 127},
                                                                           {188, 189, 34},
                                                                           {23, 190, 207}}};
  return kColors[id.value() % kColors.size()];
}

IdColumn ColumnForMapIds(const PointRows& points) {
  for (const Map* map : points.maps())
    if (map->id.value() > kLargestUnsigned32) return IdColumn::kDouble;
  return IdColumn::kUnsigned32;
}

IdColumn ColumnForPointIds(const PointRows& points) {
  for (std::size_t row = 0; row < points.size(); ++row)
    if (points[row].point->id.value() > kLargestUnsigned32) return IdColumn::kDouble;
  return IdColumn::kUnsigned32;
}

void AppendRawId(std::string& out, std::uint64_t id, IdColumn column) {
  if (column == IdColumn::kUnsigned32)
    AppendRaw(out, static_cast<std::uint32_t>(id));
  else
    AppendRaw(out, static_cast<double>(id));
}

}  // namespace slamdb::detail
