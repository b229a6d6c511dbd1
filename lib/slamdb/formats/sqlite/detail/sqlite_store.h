// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "slamdb/formats/rows/detail/store_backend.h"

// Stores that are SQLite files.
namespace slamdb::sqlite {

// As Store's functions of these names.
std::unique_ptr<detail::StoreBackend> OpenStore(const std::string& path, double lock_timeout);
std::unique_ptr<detail::StoreBackend> OpenStoreForWriting(const std::string& path, const StoreOptions& options);
bool IsYetToBeMade(const std::string& path, double lock_timeout);

}  // namespace slamdb::sqlite
