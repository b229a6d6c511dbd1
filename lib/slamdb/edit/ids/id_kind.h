// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "slamdb/model/ids.h"

namespace slamdb {

// What an id is of. Frames are the images that keyframes are made of; they are not in the atlas themselves.
enum class IdKind : std::uint8_t { kMap, kKeyFrame, kPoint, kFrame, kCamera };
inline constexpr std::size_t kIdKinds = 5;
inline constexpr std::uint64_t kNoId = MapId::kNone;

}  // namespace slamdb
