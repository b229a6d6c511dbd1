// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "slamdb/model/atlas.h"
#include "slamdb/synthetic/detail/rig.h"
#include "slamdb/synthetic/detail/room.h"
#include "slamdb/synthetic/synthesize.h"

namespace slamdb::synthetic {

// What a keyframe of a room sees. The points of the map have ids from `first_point_id`.
struct View {
  const SyntheticOptions& options;
  const Rig& rig;
  const Room& room;
  std::uint64_t map = 0;
  std::uint64_t first_point_id = 0;

  // The features of the `index`th keyframe of the map: its points, then clutter, by octave as the ORB extractor lists
  // them, with grids and bag of words. Thread-safe.
  Features See(std::size_t index) const;
};

}  // namespace slamdb::synthetic
