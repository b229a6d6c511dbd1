// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "slamdb/formats/format.h"
#include "slamdb/model/reprojection.h"

namespace slamdb::detail {

// The points of an atlas as rows, for the formats that hold points. Points flagged bad are left out. Refers to the
// atlas, which must outlive it. Constant after construction.
class PointRows {
 public:
  struct Row {
    const MapPoint* point;
    std::uint32_t map;  // row of maps()
  };

  // Throws Error when ExportOptions::map names a map that the atlas does not have.
  PointRows(const Atlas& atlas, const Target& target, const WriteOptions& options);

  std::size_t size() const { return rows_.size(); }
  const Row& operator[](std::size_t row) const { return rows_[row]; }

  const std::vector<const Map*>& maps() const { return maps_; }
  const Reprojection& reprojection(const Row& row) const { return reprojections_[row.map]; }

  MapId map_id(const Row& row) const { return maps_[row.map]->id; }
  float mean_error(const Row& row) const { return reprojection(row).Mean(*row.point); }

  // `3,162 points, 41 bad ones left out`, for Notices::Tell.
  std::string Summary() const;

 private:
  std::vector<const Map*> maps_;
  std::vector<Reprojection> reprojections_;
  std::vector<Row> rows_;
  std::size_t bad_ = 0;
};

// Red, green and blue of the points of a map: ten colours that are easy to tell apart, by map id.
std::array<std::uint8_t, 3> ColorOfMap(MapId id);

// Ids have 64 bits, and neither PLY nor PCD has such an integer that every reader takes. A column of ids is 32-bit
// unsigned when all of them fit, and otherwise double, which is exact up to 2^53.
enum class IdColumn { kUnsigned32, kDouble };
IdColumn ColumnForMapIds(const PointRows& points);
IdColumn ColumnForPointIds(const PointRows& points);
void AppendRawId(std::string& out, std::uint64_t id, IdColumn column);

}  // namespace slamdb::detail
