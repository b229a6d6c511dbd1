// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "slamdb/formats/format.h"

namespace slamdb::detail {

// The maps to write: that of ExportOptions::map, or all of them, by their place in Atlas::maps. Throws Error of kind
// kNotFound when the atlas has no map of that id.
std::vector<const Map*> ChooseMaps(const Atlas& atlas, const WriteOptions& options, const Target& target);

// Warns when more than one of the maps has content: they are not aligned with each other, and side by side in one file
// they look as if they were. `how_told_apart` ends the sentence (`the property "map" tells them apart`).
void WarnOfSeveralFrames(const std::vector<const Map*>& maps, const std::string& how_told_apart, Notices& notices);
void WarnOfSeveralFrames(std::size_t maps, const std::string& how_told_apart, Notices& notices);

// Warns of edges of keyframes that are written to keyframes that are not.
void WarnOfEdgesOutside(std::size_t edges, Notices& notices);

}  // namespace slamdb::detail
