// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/many/add.h"
#include "slamdb/many/inputs.h"

namespace slamdb::detail {

struct StoreName {
  std::string name;
  bool with_folder = false;          // because others would be called the same without
  std::vector<std::string> derived;  // what it would be called if other inputs were there, see DerivedNamesIn
};

// What each input is to be called, as the options have it: no two the same, but inputs of one path. Whom no folder
// tells from another one gets a number, the first in the order of inputs none: `map`, `map-2`. Names may be none that
// an atlas can have.
std::vector<StoreName> StoreNamesOf(const std::vector<AtlasInput>& inputs, const AddOptions& options);

// Whether `name` is `stem`, also with a number behind it.
bool IsNumbered(std::string_view name, std::string_view stem);

// The names in `held`, by name, that the input may have had on a day with other inputs: with more folders or fewer, and
// with a number behind that.
template <class Value>
std::vector<std::string> DerivedNamesIn(const std::map<std::string, Value>& held, const StoreName& name) {
  std::vector<std::string> found;
  for (const std::string& stem : name.derived)
    for (auto entry = held.lower_bound(stem); entry != held.end() && entry->first.starts_with(stem); ++entry)
      if (IsNumbered(entry->first, stem)) found.push_back(entry->first);
  return found;
}

}  // namespace slamdb::detail
