// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "cli/options.h"
#include "slamdb/formats/store/store.h"

namespace slamdb::cli {

// The store that is meant whole by an input without #NAME; nullopt when the input is one atlas: a file, or a store that
// holds no more. `from`: the format or layout that the user says it has, or empty.
std::optional<Store> OpenWholeStore(const std::string& input, const InputFormat& from, double wait);

}  // namespace slamdb::cli
