// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "slamdb/base/detail/server.h"

namespace slamdb::detail {

// Bytes of the file; nullopt: there is none, as of a server.
inline std::optional<std::uint64_t> FileSize(const std::string& path) {
  if (IsServer(path)) return std::nullopt;
  std::error_code unknown;
  const std::uint64_t size = std::filesystem::file_size(path, unknown);
  return unknown ? std::nullopt : std::optional(size);
}

}  // namespace slamdb::detail
