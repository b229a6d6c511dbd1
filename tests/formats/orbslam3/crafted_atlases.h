// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "tests/formats/orbslam3/crafted_archive.h"

namespace slamdb {

struct Crafted {
  std::string bytes;
  std::vector<CraftedArchive::Field> fields;
};

// One map, two keyframes, two points, a pinhole: the smallest sound atlas. With the default craft its MD5 sums are
// kTinyMd5 and kTinyTextMd5, those of the same atlas saved by Boost 1.74 from ORB-SLAM3's own classes.
Crafted CraftTinyAtlas(const Craft& craft);
inline constexpr const char* kTinyMd5 = "d28c76bd79e25bec66d00db8e05155d8";
inline constexpr const char* kTinyTextMd5 = "a36f9cb4f61004ff696805e95ae0395a";

// Everything irregular that decodes: two maps of which the first is empty, a fisheye and a pinhole camera, a null
// keyframe pointer, a point listed twice, the second map listed twice, IMU measurements, an empty matrix, absent ids.
Crafted CraftOddAtlas(const Craft& craft);

}  // namespace slamdb
