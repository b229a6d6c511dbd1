// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "slamdb/model/atlas.h"

namespace slamdb::detail {

// Bytes that an entity takes in a binary .osa file (schema/orbslam3.md), but for the few that Boost writes before the
// first of a class.
std::uint64_t ArchiveBytes(const KeyFrame& keyframe);
std::uint64_t ArchiveBytes(const MapPoint& point);
std::uint64_t ArchiveBytes(const Atlas& atlas);

// The part of the above that each observation takes.
inline constexpr std::uint64_t kArchiveBytesPerObservation = 24;

}  // namespace slamdb::detail
