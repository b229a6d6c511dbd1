// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/report/detail/html.h"
#include "slamdb/report/pages.h"

// The parts that pages share.
namespace slamdb::report {

// `sound`, `not sound`, `not readable`: one word for the filter.
std::string VerdictWord(const AtlasReport& report);
// The verdict in its colour.
void AppendVerdict(Html& html, const AtlasReport& report);

// How long the trajectories of all maps are, with their unit: `52.3 m`, `8.21 units`, `60.5 m and units`.
std::string LengthText(const AtlasStatistics& statistics);

// What a check found, by rule, errors first, each with what comes of it and what to do.
void AppendFindings(Html& html, const CheckReport& report, const Wording& wording);

// Every measure of the gates, and which of the limits it keeps.
void AppendGates(Html& html, const AtlasReport& report);

}  // namespace slamdb::report
