// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/App.hpp>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "cli/limits.h"

namespace slamdb::cli {

// `500MB`, `1.5GiB`, `1000000`: bytes, in units of 1000, or with an i of 1024, in letters of either case.
std::optional<std::uint64_t> ParseByteSize(std::string_view text);

// An option that takes one.
CLI::Option* AddByteSize(CLI::App& verb, const std::string& names, const Limits& limits,
                         std::function<void(std::uint64_t bytes)> take, const std::string& description);

}  // namespace slamdb::cli
