// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "slamdb/align/align.h"
#include "slamdb/model/detail/json.h"

// What reports of alignments, loops and pictures have in common.
namespace slamdb::detail {

inline Json PairsJson(const std::vector<AlignedPair>& pairs) {
  Json json = Json::array();
  for (const AlignedPair& pair : pairs)
    json.push_back({{"first", JsonId(pair.first)},
                    {"second", JsonId(pair.second)},
                    {"inliers", pair.inliers},
                    {"first_from_second", JsonOf(pair.first_from_second)}});
  return json;
}

// Row by row.
inline Json MatrixJson(const Eigen::MatrixXd& matrix) {
  Json json = Json::array();
  for (const auto& row : matrix.rowwise()) json.push_back(std::vector<double>(row.begin(), row.end()));
  return json;
}

}  // namespace slamdb::detail
