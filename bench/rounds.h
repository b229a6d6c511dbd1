// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "bench/measure.h"

namespace slamdb::bench {

struct RoundOptions {
  std::string program;  // this one, to start as a fresh process
  int rounds = 7;
  std::vector<std::string> only;  // rows to measure; empty: all
};

// Measures everything on one prepared atlas and prints its rows of the table: ours and the reference in alternation, so
// that what else the machine does falls on both; the median of the ratios of the pairs, with the least and the
// greatest.
void MeasureRows(const Workplace& workplace, const RoundOptions& options, std::ostream& out);
void PrintTableHead(std::ostream& out);

// Starts the program with these arguments and waits. Returns what it printed. Throws Error when it fails.
std::string RunProgram(const std::vector<std::string>& arguments);

}  // namespace slamdb::bench
