// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string_view>

#include "slamdb/formats/format.h"

namespace slamdb {

// Every format, in the order in which their sniffers are asked.
std::span<const Format> Formats();

// The format of that id. Throws Error naming the known ids.
const Format& FormatById(std::string_view id);

// The format of a file that is there: by content first, then by suffix; `id` (--from) overrides. Throws Error that says
// what the file looks like when no format reads it (`not an atlas: this looks like a COLMAP database`).
const Format& FormatOfInput(const Location& location, std::string_view id = {});

// The format to write: `id` (--to), or by suffix. Throws Error naming the suffixes.
const Format& FormatOfOutput(const Location& location, std::string_view id = {});

// Reads with the format of the input.
Atlas ReadAtlas(const Location& location, const ReadOptions& options, Notices& notices, std::string_view from = {});

// Writes with the format of the output. Names in `notices`, as losses, what the atlas has and the target cannot hold;
// with `strict` it throws Error for the first of them and writes nothing.
void WriteAtlas(const Atlas& atlas, const Location& location, const WriteOptions& options, Notices& notices,
                std::string_view to = {}, bool strict = false);

}  // namespace slamdb
