// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "slamdb/model/atlas.h"

namespace slamdb {

// The sound atlases that twins break, small enough for every test.
enum class Base { kMonocular, kRgbd, kFisheyeStereo, kInertial, kTwoMaps };
const Atlas& SoundAtlas(Base base);  // made once; thread-safe

// A way to break one rule: `corrupt` makes of a sound atlas one in which that rule finds something.
struct Twin {
  std::string_view rule;
  Base base;
  void (*corrupt)(Atlas&);
  // Other rules that the same breach breaks as well; when empty, none may.
  std::vector<std::string_view> also = {};
};

// At least one for each rule of the catalogue, in its order.
std::span<const Twin> Twins();

}  // namespace slamdb
