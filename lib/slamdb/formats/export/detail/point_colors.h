// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "slamdb/formats/export/detail/points.h"
#include "slamdb/formats/export/options.h"
#include "slamdb/model/colors.h"

namespace slamdb::detail {

// The colours of points. Values are spread between their 2nd and 98th percentile, so that a few gross ones do not make
// all others alike. Refers to the rows. Constant after construction.
class PointColors {
 public:
  PointColors(const PointRows& points, const WriteOptions& options);

  Color operator[](std::size_t row) const {
    return values_.empty() ? ColorOfMap(points_.map_id(points_[row])) : ColorOfShare((values_[row] - low_) * scale_);
  }

  // `reprojection error from 0.1 (violet) to 2.31 pixels (yellow)`.
  std::string Legend() const;
  // The same as a note, where the colour tells something else than the map.
  void Tell(Notices& notices) const;

 private:
  const PointRows& points_;
  PointColor by_;
  std::vector<float> values_;  // of the rows; none by map
  double low_ = 0, high_ = 0, scale_ = 0;
};

}  // namespace slamdb::detail
