// SPDX-License-Identifier: BSD-3-Clause
#include "cli/whole_store.h"

#include <utility>

#include "slamdb/formats/formats.h"

namespace slamdb::cli {

std::optional<Store> OpenWholeStore(const std::string& input, const InputFormat& from, double wait) {
  const Location location(input);
  if (!from.empty() || !location.name.empty() || !HoldsNamedAtlases(location.path)) return std::nullopt;
  Store store = Store::Open(location.path, wait);
  if (store.Names().size() < 2) return std::nullopt;
  return store;
}

}  // namespace slamdb::cli
