// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "slamdb/model/atlas.h"

// What people want to know of an entity before its fields.
namespace slamdb::cli {

inline constexpr std::size_t kNameColumns = 24;  // of the names of fields

// Where the camera of a keyframe is, which way it looks, and when that was.
std::string WhereIs(const KeyFrame& keyframe, const Map& map);

// Takes out of an entity, as JSON, what does not apply to it: the IMU's fields of a keyframe without IMU, those of a
// second camera where there is one, what undistorting did not change, empty lists. Returns the line that says so.
std::string Fold(nlohmann::ordered_json& entity);

}  // namespace slamdb::cli
