// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace slamdb::cli {

// A sentence of the library, which speaks of its own options and functions, in the words of the command:
// `is there already; WriteOptions::overwrite replaces it` becomes `is there already; -O/--overwrite replaces it`.
std::string InCommandWords(std::string_view sentence);

// The same of the sentences of a report as JSON; names in it stay as they are.
std::string ReportInCommandWords(std::string_view json);

// What is replaced by what for that, in this order. Python has the same in its own spelling.
struct Word {
  std::string_view library, command;
};
std::span<const Word> Words();

}  // namespace slamdb::cli
