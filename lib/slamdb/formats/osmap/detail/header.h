// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/file.h"

namespace slamdb::osmap {

// The bits of Options that a reader has to know.
inline constexpr std::uint32_t kDelimited = 1U << 0;  // features file: messages behind their lengths
inline constexpr std::uint32_t kNoPoints = 1U << 2, kNoKeyFrames = 1U << 3, kNoFeatures = 1U << 4;
inline constexpr std::uint32_t kPointFeaturesOnly = 1U << 6;  // keypoints without a point are left out

// fx, fy, cx, cy. Pixels.
using CameraMatrix = std::array<float, 4>;
// As the end of an error; empty: it is one. All 0: of a keyframe whose camera nobody knows.
std::string WhyNoCamera(const CameraMatrix& camera);

struct Side {
  std::string file;                    // name; empty: there is none
  std::optional<std::uint64_t> count;  // of what is in it
};

// The YAML file.
struct Header {
  Side points, keyframes, features;
  std::uint32_t options = 0;
  std::vector<CameraMatrix> cameras;
};

bool IsHeader(const Probe& probe);

// A file beside the header, or beside the link that leads to it; the folder that its name begins with is that of
// whoever saved it.
std::string PathOf(const std::string& header, const Side& side);

// Reads YAML as OpenCV writes it. Throws Error (kDamaged) with the line.
Header ParseHeader(std::string_view text, const std::string& path);
std::string HeaderText(const Header& header);

}  // namespace slamdb::osmap
