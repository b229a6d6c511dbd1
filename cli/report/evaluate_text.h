// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/evaluate/evaluate.h"

namespace slamdb::cli {

// How far the trajectories are from the truth, for people; `in_full` with every relation and statistic.
std::string EvaluateText(const EvaluationReport& report, bool in_full);

}  // namespace slamdb::cli
