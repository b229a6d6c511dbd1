// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "slamdb/model/atlas.h"

// What two maps have that does not go together, whichever comes first.
namespace slamdb::detail {

// A map, and what messages call it.
struct NamedMap {
  const Map* map;
  std::string name;
};

// Whether it has keyframes, and lengths that are not metres: monocular without an initialised IMU.
bool HasArbitraryScale(const Map& map);

// What becomes of the two: maps of one atlas, or one map.
enum class Together { kSideBySide, kJoined };

struct Mixture {
  std::string_view aspect;
  std::string sentence;
};

// At most one for each aspect: IMU and its state, stereo and monocular, scale, cameras. Where maps are joined, what
// the result loses by it; the scale is then the business of ScaleProblem and JoinMaps. Ids of cameras are those of
// one atlas.
std::vector<Mixture> MixturesOf(const NamedMap& first, const NamedMap& second, Together together);

// Why one map of two, of which the second was moved by a transform of this scale, holds two scales or two baselines;
// empty when it does not. A scale within a thousandth of 1 counts as none.
std::string ScaleProblem(const NamedMap& first, const NamedMap& second, double scale);

// What else there is to know of the scale of such a map; empty when nothing.
std::string ScaleWarning(const NamedMap& first, const NamedMap& second, double scale);

}  // namespace slamdb::detail
