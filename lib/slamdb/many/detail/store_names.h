// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "slamdb/many/add.h"
#include "slamdb/many/inputs.h"

namespace slamdb::detail {

struct StoreName {
  std::string name;
  bool with_folder = false;  // because others would be called the same without
};

// What each input is to be called, as the options have it. Names may be none that an atlas can have, and inputs of the
// same path have the same.
std::vector<StoreName> StoreNamesOf(const std::vector<AtlasInput>& inputs, const AddOptions& options);

}  // namespace slamdb::detail
