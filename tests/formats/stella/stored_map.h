// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "slamdb/formats/format.h"

// Maps of stella_vslam, made with nlohmann's JSON library as stella_vslam makes them.
namespace slamdb {

using nlohmann::json;

// Two key frames with three and two keypoints, which both see landmark 7; key frame 4 is the root.
json SmallStellaMap();
// The same as OpenVSLAM wrote it.
json SmallOpenVslamMap();

std::string Packed(const json& map);
Atlas ReadStella(const std::string& bytes, Notices& notices);
Atlas ReadStella(const json& map);

}  // namespace slamdb
