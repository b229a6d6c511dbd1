// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/whole_store.h"

#include "slamdb/formats/formats.h"

namespace slamdb {

std::optional<Store> OpenWholeStore(const std::string& input, double lock_timeout) {
  const Location location(input);
  if (!location.name.empty() || !HoldsNamedAtlases(location.path)) return std::nullopt;
  Store store = Store::Open(location.path, lock_timeout);
  if (store.Names().size() < 2) return std::nullopt;
  return store;
}

}  // namespace slamdb
