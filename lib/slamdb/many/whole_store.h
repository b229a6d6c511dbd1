// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "slamdb/export.h"
#include "slamdb/formats/store/store.h"

namespace slamdb {

// The store that is meant whole by an input without #NAME; nothing when the input is one atlas: a file, or a store that
// holds no more.
//
// Throws Error as Store::Open does.
[[nodiscard]] SLAMDB_EXPORT std::optional<Store> OpenWholeStore(const std::string& input, double lock_timeout = 5);

}  // namespace slamdb
