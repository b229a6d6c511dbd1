// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

#include "slamdb/formats/format.h"
#include "slamdb/formats/stella/detail/outgoing.h"
#include "slamdb/formats/stella/detail/stella_map.h"

namespace slamdb::stella {

// What a MessagePack file of stella_vslam or OpenVSLAM holds. Unknown keys are skipped, as those programs do.
//
// Throws Error: kDamaged with byte and keyframe or landmark.
StoredMap DecodeMessagePack(std::string_view bytes, const std::string& path, const ReadOptions& options);

// Returns how many keypoints lose their response or size.
std::uint64_t WriteMessagePack(const Outgoing& map, const Target& target, const WriteOptions& options);

}  // namespace slamdb::stella
