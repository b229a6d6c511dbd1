// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/salvage.h"

namespace slamdb::detail {

// Reads what is whole in a truncated or damaged .osa file, binary or text. Objects stand in the archive one behind the
// other, those of a map as its keyframes, then its points; cameras and counters come last. Nothing tells where an
// object ends but reading it, so damage is noticed when a count is impossible or the next object is not where it must
// be; the object in front is then given up too, unless it looks whole. Reading goes on where the pointer to a later
// object of the file stands, keyframe, point, map or camera: its class, its number in the file, and a whole record
// with the next pointer behind it, or one that looks whole. The counters are the last numbers of the file. Where the
// beginning of a map is lost, up to anywhere in its keyframes, it goes by the origin map of its first keyframe; where
// that of the file is, the archive is taken for one of ORB-SLAM3 on 64-bit Linux.
// Numbers that were changed in a record without changing its shape are read as they are. Throws Error when the file is
// empty or cannot be read. Thread-safe.
Salvage SalvageOrbslam3(const Source& source, const ReadOptions& options);

}  // namespace slamdb::detail
