// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/detail/distance_table.h"

namespace slamdb::detail {

DistanceTable::DistanceTable(const std::vector<Bits>& rows, const std::vector<Bits>& columns)
    : columns_(columns.size()), distances_(rows.size() * columns.size()) {
  const BitColumns others(columns);
  for (std::size_t row = 0; row < rows.size(); ++row) others.DistancesTo(rows[row], &distances_[row * columns_]);
}

}  // namespace slamdb::detail
