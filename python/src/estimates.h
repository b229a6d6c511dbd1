// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "python/src/arguments.h"
#include "slamdb/many/estimates.h"

// What trajectories are read with, and how they are paired and aligned, by keyword arguments.
namespace slamdb::python {

// time_unit, times.
TrajectoryReadOptions TimesOf(Arguments& given);

// Of an atlas, or a file.
Estimates EstimatesOf(const AtlasOrPath& source, const EstimatesOptions& options, Notices& notices);

// max_dt, time_offset, estimate_time_offset, by_index, align, joint.
void TakeEvaluation(Arguments& given, EvaluationOptions& options);

}  // namespace slamdb::python
