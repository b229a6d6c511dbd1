// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ostream>
#include <random>
#include <string>
#include <vector>

// Tables as text in the dialects that people have.
namespace slamdb {

struct NamedTable {
  const char* name;
  std::vector<std::string> names;
  std::vector<std::vector<std::string>> rows;
  bool plus_signs = true;  // numbers may have them
};
void PrintTo(const NamedTable& table, std::ostream* out);

// With line ends, separators, quotes, decimal commas, plus signs, comments and empty lines as they fall.
std::string InSomeDialect(const NamedTable& table, std::mt19937_64& random);

}  // namespace slamdb
