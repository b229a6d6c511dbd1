// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/format.h"

namespace slamdb::detail {

// Maps of ORB-SLAM2 as osmap saves them: a header in YAML, and three files of Protocol Buffers beside it. See
// schema/osmap.md.
extern const Format kOsmapFormat;

}  // namespace slamdb::detail

namespace slamdb::osmap {

Atlas Read(const Source& source, const ReadOptions& options, Notices& notices);
void Write(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices);

}  // namespace slamdb::osmap
