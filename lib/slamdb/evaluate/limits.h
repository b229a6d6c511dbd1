// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "slamdb/evaluate/evaluate.h"

namespace slamdb {

// What CI holds an evaluation against. Absolute errors of positions are the ATE of the literature, relative ones the
// RPE.
struct EvaluationLimits {
  std::optional<double> max_ate_rmse, max_ate;  // units of the truth; the second holds for every pose
  std::optional<double> max_rotation_rmse;      // degrees, absolute
  std::optional<double> max_rpe_rmse;           // units of the truth, for every delta
  std::optional<double> min_paired;             // percent of the estimate's poses
  std::optional<double> min_coverage;           // percent of the truth's time span

  SLAMDB_EXPORT bool any() const;
};

// A sentence for each limit that is broken; none when all hold. What could not be measured breaks its limit, and a map
// that could not be evaluated breaks all of them.
[[nodiscard]] SLAMDB_EXPORT std::vector<std::string> BreachesOf(const EvaluationReport& report,
                                                                const EvaluationLimits& limits);

}  // namespace slamdb
