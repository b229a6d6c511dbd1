// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/export.h"

// Which version of the archive library comes with which Boost, and which Boost with which system.
namespace slamdb {

// The version that `17`, `1.71`, `ubuntu20.04` or `noetic` names; nothing when none is known by it.
[[nodiscard]] SLAMDB_EXPORT std::optional<std::uint32_t> BoostVersionByName(std::string_view name);

// `ubuntu20.04`, `noetic` and so on, for completion.
[[nodiscard]] SLAMDB_EXPORT std::vector<std::string> NamesOfSystems();

// What to say of a name that BoostVersionByName does not know: what there is.
[[nodiscard]] SLAMDB_EXPORT std::string WhyNoBoostVersion(std::string_view name);

// The releases that write this version, "Boost 1.73 to 1.75", and none where none is known.
[[nodiscard]] SLAMDB_EXPORT std::string BoostReleases(std::uint32_t version);

}  // namespace slamdb
