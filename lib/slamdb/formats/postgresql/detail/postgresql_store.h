// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "slamdb/formats/rows/detail/store_backend.h"

// Stores in a database of a PostgreSQL server.
namespace slamdb::postgresql {

// As Store's functions of these names.
std::unique_ptr<detail::StoreBackend> OpenStore(const std::string& uri, double lock_timeout);
std::unique_ptr<detail::StoreBackend> OpenStoreForWriting(const std::string& uri, const StoreOptions& options);
bool IsYetToBeMade(const std::string& uri, double lock_timeout);

}  // namespace slamdb::postgresql
