// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/base/file.h"
#include "slamdb/export.h"
#include "slamdb/formats/layouts/infer.h"

namespace slamdb {

// Finds the layout of an .osa file: a known one, when it comes to the last byte and what it reads is like what
// ORB-SLAM3 writes; or else the smallest change of one, members more or less, in other forms or order, in KeyFrame,
// MapPoint, Map and Atlas. Members that are new are called unknown1, unknown2, ..., with a type that has their bytes.
// Of several that fit, the one counts against whose meaning least speaks: points lie where keyframes see them, ids
// refer to each other, times rise. Where much speaks against that one, too, the doubts say so. Where longs have 4
// bytes, of known layouts alone.
//
// Proves it: the file is read in the layout and written again. InferredLayout::same_bytes says whether the same bytes
// came of it. Tries are bounded: seconds. Deterministic. Thread-safe.
//
// A text archive is of a known layout, or of one that nobody can find: it has no records that can be told apart.
//
// Throws Error: kUsage for a choice that is not there; kDamaged and kUnsupported for what is no Boost archive;
// kNotPossible when no layout was found.
[[nodiscard]] SLAMDB_EXPORT InferredLayout InferLayout(const Source& source, const InferOptions& options = {});

}  // namespace slamdb
