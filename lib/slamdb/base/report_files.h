// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace slamdb {

// The files that a report is about, which only the caller of the library knows: paths, or STORE.db#NAME.
// Reports as JSON hold them as `input` and `output`; what is empty is null there.
struct ReportFiles {
  std::string input;
  std::string output;  // empty: nothing was written
};

}  // namespace slamdb
