// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/rows/detail/landmark_row.h"

#include <algorithm>

namespace slamdb::rows {

LandmarkReals RealsOf(const Landmark& landmark) {
  const Eigen::Vector3d &mean = landmark.mean, &normal = landmark.normal;
  return {mean.x(),        mean.y(),        mean.z(),        normal.x(),      normal.y(),      normal.z(),
          landmark.cov_11, landmark.cov_22, landmark.cov_33, landmark.cov_12, landmark.cov_13, landmark.cov_23};
}

void SetReals(const LandmarkReals& reals, Landmark& landmark) {
  landmark.mean = {reals[0], reals[1], reals[2]};
  landmark.normal = {reals[3], reals[4], reals[5]};
  std::size_t next = 6;
  for (double* value :
       {&landmark.cov_11, &landmark.cov_22, &landmark.cov_33, &landmark.cov_12, &landmark.cov_13, &landmark.cov_23})
    *value = reals[next++];
}

const std::array<Value, LandmarkRow::kColumns>& LandmarkRow::Of(const LandmarkKeys& keys, const Landmark& landmark) {
  columns_[0] = keys.row;
  columns_[1] = keys.map;
  columns_[2] = ToColumn(landmark.id);
  columns_[3] = ValueOrNull(keys.unique ? ToReference(landmark.id) : std::nullopt);
  columns_[4] = keys.hash;
  reals_ = RealsOf(landmark);
  std::ranges::copy(reals_, &columns_[5]);
  features_.Clear();
  detail::EncodeLandmarkFeatures(landmark.features, features_);
  columns_[17] = ToColumn(landmark.last_seen);
  columns_[18] = std::int64_t{landmark.seen_count};
  columns_[19] = features_.bytes();
  const bool fits = std::ranges::all_of(reals_, [](double value) { return FitsReal(value); });
  columns_[20] = fits ? Value() : Value(std::as_bytes(std::span(reals_)));
  return columns_;
}

}  // namespace slamdb::rows
