// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/base/file.h"
#include "slamdb/export.h"
#include "slamdb/formats/layouts/infer.h"

namespace slamdb {

// Finds the layout of an .osa file, as InferLayoutOf does, and proves it: the file is read in the layout and written
// again. InferredLayout::same_bytes says whether the same bytes came of it.
//
// A text archive is of a known layout, or of one that nobody can find: it has no records that can be told apart.
//
// Throws Error: kUsage for a choice that is not there; kDamaged and kUnsupported for what is no Boost archive;
// kNotPossible when no layout was found.
[[nodiscard]] SLAMDB_EXPORT InferredLayout InferLayout(const Source& source, const InferOptions& options = {});

}  // namespace slamdb
