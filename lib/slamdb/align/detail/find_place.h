// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "slamdb/align/detail/known_map.h"
#include "slamdb/align/detail/picture_query.h"
#include "slamdb/align/detail/prepared_map.h"
#include "slamdb/align/detail/verify.h"

namespace slamdb::detail {

// A pose that a picture may have been taken from, and what of the map it shows then.
struct Place {
  std::size_t map = 0;  // row of the prepared maps
  PoseFit fit;
  std::vector<PictureMatch> inliers;
  std::vector<std::uint32_t> views;  // left ones that see most of these, the most first
};

// The pose of a picture by what is seen from about a keyframe; nullopt when too few points agree.
// Leaves the view of the query at the pose.
std::optional<Place> TryPlace(PictureQuery& query, const KnownMap& known, const PreparedMap& map, std::uint32_t view);

inline constexpr PictureCells kPictureCells = {6, 4};
// What the picture shows of the map from that pose.
SeenShare LookFrom(PictureQuery& query, const KnownMap& known, const Place& place);

}  // namespace slamdb::detail
