// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/format.h"

namespace slamdb::detail {

// The source, held so that its format can be told and then be read. A stream is refused by its beginning.
HeldSource Hold(const Source& source, const ReadOptions& options);

// The format to read a held source with: that of the options, or by content, then by suffix. Throws Error when there is
// none, or it does not read, or holds no atlases by name and one is named.
const Format& FormatToRead(const Source& source, const ReadOptions& options);

// The format to write a target with: that of the options, or by suffix. Throws Error likewise.
const Format& FormatToWrite(const Target& target, const WriteOptions& options);

}  // namespace slamdb::detail
