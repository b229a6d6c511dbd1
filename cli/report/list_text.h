// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "slamdb/many/list.h"

// The table of `slamdb list`.
namespace slamdb::cli {

// What is worth showing of these: no column that says nothing here. Atlases of one store go by their name, others by
// the whole of what they are called.
std::vector<ListKey> UsualColumns(std::span<const ListedAtlas> atlases);

// A line for each, with why it could not be read at its end. Where they do not fit into `width` columns of text, the
// least important are left out, and named below.
std::string ListText(std::span<const ListedAtlas> atlases, std::vector<ListKey> columns,
                     std::optional<std::size_t> width = {});

}  // namespace slamdb::cli
