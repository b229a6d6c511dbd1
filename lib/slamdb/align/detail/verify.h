// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "slamdb/align/detail/known_map.h"
#include "slamdb/align/detail/map_views.h"
#include "slamdb/model/similarity.h"

namespace slamdb::detail {

// What pictures of one map show of the points of another, when the maps lie as a transform says: whatever must be
// visible and is not found speaks against it, however many matches speak for it.
struct SeenShare {
  std::uint64_t views = 0;                   // that should see enough points to tell
  std::uint64_t agreeing_views = 0;          // that find a fifth of them
  std::uint64_t visible = 0, found = 0;      // points, summed over the views
  std::uint64_t cells = 0, found_cells = 0;  // parts of the pictures with enough points, and where some are found
  std::uint64_t in_front = 0;                // points that would hide what the picture sees

  double found_share() const { return visible == 0 ? 0 : static_cast<double>(found) / static_cast<double>(visible); }
  double cell_share() const { return cells == 0 ? 0 : static_cast<double>(found_cells) / static_cast<double>(cells); }
  double front_share() const { return visible == 0 ? 0 : static_cast<double>(in_front) / static_cast<double>(visible); }
};

// Into how many parts a picture is divided.
struct PictureCells {
  int columns = 3, rows = 2;
  int count() const { return columns * rows; }
};

// The same of one picture. `depths`: by keypoint, of what it shows, where that is known, 0 elsewhere.
SeenShare LookFrom(const View& view, std::span<const double> depths, const KnownMap& points,
                   const Similarity3d& map_from_points, PictureCells cells = {});

// The same of all pictures of a map. `map_from_points`: from the map of the points to that of the pictures.
// Looks at some hundred pictures at most, at equal steps.
// Deterministic for any number of threads.
SeenShare LookFor(const MapViews& points, const MapViews& pictures, const Similarity3d& map_from_points, int threads);

// The same of some points and some pictures alone.
SeenShare LookFor(const MapViews& points, std::span<const std::uint32_t> some_points, const MapViews& pictures,
                  std::span<const std::uint32_t> some_views, const Similarity3d& map_from_points, int threads);

}  // namespace slamdb::detail
