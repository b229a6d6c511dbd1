// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>

#include "slamdb/base/detail/file_stream.h"
#include "slamdb/formats/layouts/detail/inference.h"
#include "slamdb/formats/orbslam3/detail/archive_header.h"
#include "slamdb/formats/salvage.h"

namespace slamdb::orbslam3 {

// The known layout that the records of keyframes and map points have, whatever stands around them; of several the one
// that comes farthest from the beginning on, as they may differ in their classes alone. Null when there is none.
const Layout* KnownLayoutOf(const layouts::ArchiveBytes& archive, std::span<const layouts::MapRecords> maps);

// InferLayout, where its records were looked for.
InferredLayout InferLayoutOf(const Source& source, layouts::RecordLayouts& records, const InferOptions& options);

// Reads what is whole in a binary archive of a fork: all of it in a layout that reads it to the end, or else every
// keyframe and map point that is whole where its number says it stands. Nothing when the records are those of v1.0, and
// make sense as such.
std::optional<Salvage> SalvageFork(Bytes bytes, const std::string& path, const ArchiveHeader& header);

// Every keyframe and map point that is whole as of v1.0 where its number says it stands, for files of forks whose Map
// or Atlas alone is another. Nothing when no keyframe is.
std::optional<Salvage> SalvageOwnRecords(Bytes bytes, const std::string& path, const ArchiveHeader& header);

bool HasKeyFrames(const Atlas& atlas);

// Reads what is whole in the layout that is given, as options name it, whose members are kept. Nothing where that is
// v1.0's.
//
// Throws Error: kDamaged where no keyframe is whole in it, kNotPossible for a text archive that is not whole, and as
// ForkProgram does.
std::optional<Salvage> SalvageInLayout(Bytes bytes, const std::string& path, const ArchiveHeader& header,
                                       const std::string& given);

}  // namespace slamdb::orbslam3
