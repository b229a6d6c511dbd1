// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "slamdb/formats/rows/stored.h"

// What a list tells of an atlas, as columns of its row.
namespace slamdb::rows {

// atlas.sensors: a bit for each.
std::int64_t BitsOf(const std::vector<MapSensor>& sensors);
std::vector<MapSensor> SensorsOf(std::int64_t bits);

// What the row of an atlas says that cannot be, as far as it can be told without the others; empty: nothing.
std::string ProblemOf(const StoredAtlas& atlas);

}  // namespace slamdb::rows
