// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>
#include <vector>

namespace slamdb {

// Where an object stands in an .osa file, its pointer included, and which row it is.
struct EntityRange {
  std::size_t begin, end;
  std::size_t map, row;
};

struct EntityRanges {
  std::vector<EntityRange> keyframes, points, cameras;
};

// Of a whole file, binary or text.
EntityRanges RangesOf(std::string_view file);

}  // namespace slamdb
