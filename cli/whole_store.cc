// SPDX-License-Identifier: BSD-3-Clause
#include "cli/whole_store.h"

#include <utility>

#include "slamdb/formats/formats.h"
#include "slamdb/many/whole_store.h"

namespace slamdb::cli {

std::optional<Store> OpenWholeStore(const std::string& input, const InputFormat& from, double wait) {
  return from.empty() ? slamdb::OpenWholeStore(input, wait) : std::nullopt;
}

}  // namespace slamdb::cli
