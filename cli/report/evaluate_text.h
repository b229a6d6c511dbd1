// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/base/notices.h"
#include "slamdb/evaluate/evaluate.h"

namespace slamdb::cli {

// How far the trajectories are from the truth, for people; `in_full` with every relation and statistic.
std::string EvaluateText(const EvaluationReport& report, bool in_full);

// `map 0`, `maps 0, 1`; empty for a trajectory of no map.
std::string MapsText(const TrajectoryEvaluation& evaluation);

// What is doubtful, each behind its map.
void TellWarnings(const EvaluationReport& report, Notices& notices);

}  // namespace slamdb::cli
