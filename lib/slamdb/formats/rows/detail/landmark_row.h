// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstring>

#include "slamdb/formats/rows/detail/columns.h"
#include "slamdb/model/detail/packing.h"
#include "slamdb/model/detail/record.h"
#include "slamdb/model/landmark.h"

// An MRPT landmark as a row of the table `landmark`.
namespace slamdb::rows {

using LandmarkReals = std::array<double, 12>;
LandmarkReals RealsOf(const Landmark& landmark);
void SetReals(const LandmarkReals& reals, Landmark& landmark);

// Which row it is, and what stands beside it.
struct LandmarkKeys {
  std::int64_t row = 0, map = 0;
  bool unique = true;  // the first of its id in the list
  std::int64_t hash = 0;
};

// The columns of the table, in its order. What it gives is valid until it is asked again.
class LandmarkRow {
 public:
  static constexpr std::size_t kColumns = 21;
  const std::array<Value, kColumns>& Of(const LandmarkKeys& keys, const Landmark& landmark);

 private:
  std::array<Value, kColumns> columns_;
  LandmarkReals reals_{};
  detail::ByteWriter features_;
};

// What ReadLandmark takes, in this order.
inline constexpr const char* kLandmarkColumns =
    "row, id, hash, x, y, z, nx, ny, nz, cov_11, cov_22, cov_33, cov_12, cov_13, cov_23, last_seen, seen_count, exact, "
    "features";

// False: the numbers in its columns are not those in `exact`. Throws what `damaged()` gives where a blob is of a wrong
// length, and Error where the features are damaged.
template <class Columns, class Damaged>
bool ReadLandmark(const Columns& row, Landmark& landmark, const Damaged& damaged) {
  bool same = true;
  landmark.id = LandmarkId(static_cast<std::uint64_t>(row.Integer(1)));
  LandmarkReals reals;
  const Bytes exact = row.Blob(17);
  if (exact.empty()) {
    for (std::size_t i = 0; i < reals.size(); ++i) reals[i] = row.Real(3 + static_cast<int>(i));
  } else {
    if (exact.size() != sizeof(reals)) throw damaged();
    std::memcpy(reals.data(), exact.data(), sizeof(reals));
    same = TakeColumns(row, 3, reals);
  }
  SetReals(reals, landmark);
  landmark.last_seen = static_cast<std::uint64_t>(row.Integer(15));
  landmark.seen_count = static_cast<std::uint32_t>(row.Integer(16));
  landmark.features = detail::DecodeLandmarkFeatures(row.Blob(18));
  return same;
}

}  // namespace slamdb::rows
