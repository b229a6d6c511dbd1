// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace slamdb::detail {

// What LZF made smaller, `size` bytes of it: runs of literals, and references to what stands before. Of Marc Lehmann's
// liblzf, which PCL has inside.
// nullopt: it is not that. Allocates nothing for a size that the bytes cannot have.
std::optional<std::string> DecompressLzf(std::string_view compressed, std::size_t size);

}  // namespace slamdb::detail
