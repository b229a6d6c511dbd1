// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "bench/measure.h"
#include "bench/process.h"

namespace slamdb::bench {

struct RoundOptions {
  std::string program;                                    // this one, to start as a fresh process
  int rounds = 15;                                        // pairs a row
  std::vector<std::string> only;                          // rows to measure; empty: all
  std::vector<Cores> cores = {Cores::kOne, Cores::kAll};  // each row on these
  bool cold = false;                                      // rows that read a file also with nothing of it in memory
};

// Measures everything on one prepared atlas and prints its rows of the table: ours and what it is held against in
// alternation, so that what else the machine does falls on both; medians, and of the ratios of the pairs the quartiles
// with the least and the greatest besides.
void MeasureRows(const Workplace& workplace, const RoundOptions& options, std::ostream& out);
void PrintTableHead(std::ostream& out);

}  // namespace slamdb::bench
