// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/formats/salvage.h"
#include "slamdb/model/atlas.h"

// The objects of landmarks in MRPT's streams, one by one.
namespace slamdb::mrpt {

enum class Layout { kMrpt2, kMrpt3 };

// Which layout the stream starts with; nullopt when it does not start with a landmarks map or a landmark of MRPT 2 or
// 3. An empty map looks the same in both and is taken for MRPT 2's. `bytes` may be the head of the stream only.
std::optional<Layout> LayoutOf(std::string_view bytes);

// Every object of the stream, the maps with ids 0, 1, ...; bare landmarks, one behind the other, share a map.
// Throws Error naming byte and landmark.
std::vector<Map> ReadMaps(const std::string& path, std::string_view bytes);

// The landmarks in front of what is damaged; no object behind it can be told from it.
Salvage SalvageMaps(const std::string& path, std::string_view bytes);

// Appends one landmark as MRPT 2 or 3 has it in a map. With `own_slots` an ORB descriptor of MRPT 2 goes where its
// writer puts it, otherwise where its reader looks for it.
void AppendLandmark2(std::string& out, const Landmark& landmark, bool own_slots);
void AppendLandmark3(std::string& out, const Landmark& landmark);

// A line of saveToTextFile.
void AppendLandmarkText(std::string& out, const Landmark& landmark);

}  // namespace slamdb::mrpt
