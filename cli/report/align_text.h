// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "slamdb/align/align_all.h"
#include "slamdb/align/optimize_joined.h"
#include "slamdb/align/report_json.h"

namespace slamdb::cli {

// How maps lie to each other, and what says so, for people. `metric` by row of the list of maps: lengths are metres.
std::string AlignText(const AlignedMaps& aligned, const std::vector<MapName>& names, const std::vector<bool>& metric);

// Which atlases of a store were left alone, and why.
std::string UnlikeText(const SearchedStore& store);

// What tightening the joined maps came to: a block for each round.
std::string OptimizedJoinText(const std::vector<OptimizedJoin>& rounds);

}  // namespace slamdb::cli
