// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "slamdb/base/notices.h"
#include "slamdb/model/atlas.h"

namespace slamdb {

// The maps to write: that of id `map`, or all of them, by their place in Atlas::maps. Throws Error (`path` names the
// output) when the atlas has no map of that id.
std::vector<const Map*> ChooseMaps(const Atlas& atlas, std::optional<MapId> map, const std::string& path);

// Warns when more than one of the maps has content: they are not aligned with each other, and side by side in one file
// they look as if they were. `how_told_apart` ends the sentence (`the property "map" tells them apart`).
void WarnOfSeveralFrames(const std::vector<const Map*>& maps, const std::string& how_told_apart, Notices& notices);

}  // namespace slamdb
