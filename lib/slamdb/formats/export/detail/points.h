// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "slamdb/formats/format.h"
#include "slamdb/model/reprojection.h"

namespace slamdb::detail {

// Whether points are left out whose positions are not finite, as some formats must not have them.
enum class Positions { kAll, kFinite };

// The points of an atlas as rows, map after map, for the formats that hold points. Points flagged bad are left out.
// Refers to the atlas, which must outlive it. Constant after construction.
class PointRows {
 public:
  struct Row {
    const MapPoint* point;
    std::uint32_t map;  // row of maps()
  };

  // Throws Error when ExportOptions::map names a map that the atlas does not have.
  PointRows(const Atlas& atlas, const Target& target, const WriteOptions& options,
            Positions positions = Positions::kAll);

  std::size_t size() const { return rows_.size(); }
  const Row& operator[](std::size_t row) const { return rows_[row]; }

  const std::vector<const Map*>& maps() const { return maps_; }
  const Reprojection& reprojection(const Row& row) const { return reprojections_[row.map]; }

  MapId map_id(const Row& row) const { return maps_[row.map]->id; }
  float mean_error(const Row& row) const { return reprojection(row).Mean(*row.point); }

  // The first row of each map, and size(): rows [begins()[m], begins()[m + 1]) are those of maps()[m].
  const std::vector<std::size_t>& begins() const { return begins_; }

  // Points that are left out, since they are flagged bad.
  std::size_t bad() const { return bad_; }
  // `3,162 points, 41 bad ones left out`, for Notices::Tell.
  std::string Summary() const;
  // Warns of those that are left out for their positions.
  void WarnOfNotFinite(Notices& notices) const;

 private:
  std::vector<const Map*> maps_;
  std::vector<Reprojection> reprojections_;
  std::vector<Row> rows_;
  std::vector<std::size_t> begins_;
  std::size_t bad_ = 0, not_finite_ = 0;
};

// Ids have 64 bits, and neither PLY nor PCD has such an integer that every reader takes. A column of ids is 32-bit
// unsigned when all of them fit, and otherwise double, which is exact up to 2^53.
enum class IdColumn { kUnsigned32, kDouble };
constexpr bool FitsUnsigned32(std::uint64_t id) { return id <= std::numeric_limits<std::uint32_t>::max(); }
IdColumn ColumnForMapIds(const PointRows& points);
IdColumn ColumnForPointIds(const PointRows& points);
void AppendRawId(std::string& out, std::uint64_t id, IdColumn column);

}  // namespace slamdb::detail
