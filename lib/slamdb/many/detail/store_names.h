// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "slamdb/many/add.h"
#include "slamdb/many/inputs.h"

namespace slamdb::detail {

struct StoreName {
  std::string name;
  bool with_folder = false;          // because others would be called the same without
  std::vector<std::string> derived;  // what it would be called if other inputs were there
};

// What each input is to be called, as the options have it: no two the same, but inputs of one path. Whom no folder
// tells from another one gets a number, the first in the order of inputs none: `map`, `map-2`. Names may be none that
// an atlas can have.
std::vector<StoreName> StoreNamesOf(const std::vector<AtlasInput>& inputs, const AddOptions& options);

// The names of a store, found by what stands before a number: ten thousand that begin alike are not looked through.
class HeldNames {
 public:
  void Add(const std::string& name);
  // Those that the input may have had on a day with other inputs: with more folders or fewer, and with a number behind
  // that.
  std::vector<std::string> DerivedOf(const StoreName& name) const;

 private:
  std::map<std::string, std::set<std::string>> by_stem_;  // with and without a number
};

}  // namespace slamdb::detail
