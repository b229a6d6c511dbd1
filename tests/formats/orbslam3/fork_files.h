// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <random>
#include <string>
#include <string_view>

#include "slamdb/base/error.h"
#include "slamdb/base/notices.h"
#include "slamdb/formats/layouts/layout.h"
#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/synthetic/synthesize.h"

// Files of forks, forged in memory.
namespace slamdb {

// Reads the bytes in a layout, as Orbslam3ReadOptions names it; empty: in the one that fits.
inline Atlas ReadFork(std::string_view bytes, const std::string& layout, Notices* notices = nullptr) {
  ReadOptions options;
  options.threads = 1;
  options.of<Orbslam3ReadOptions>().layout = layout;
  Notices unheard;
  return ReadOrbslam3({std::as_bytes(std::span(bytes)), "fork.osa"}, options, notices == nullptr ? unheard : *notices);
}

// The bytes of the atlas in a layout.
inline std::string WriteFork(const Atlas& atlas, const std::string& layout, Notices* notices = nullptr) {
  std::string encoded;
  WriteOptions options;
  options.of<Orbslam3WriteOptions>().layout = layout;
  Notices unheard;
  const auto append = [&](Bytes bytes) { encoded.append(reinterpret_cast<const char*>(bytes.data()), bytes.size()); };
  WriteOrbslam3(atlas, Target(append, "fork.osa"), options, notices == nullptr ? unheard : *notices);
  return encoded;
}

// Small, inertial, with two maps and everything that v1.0 has.
inline Atlas SmallWorld(std::uint64_t seed = 1) {
  SyntheticOptions options;
  options.sensor = Sensor::kFisheyeStereo;
  options.inertial = true;
  options.maps = 2;
  options.keyframes = 4;
  options.points = 20;
  options.features = 60;
  options.seed = seed;
  options.threads = 1;
  return SynthesizeAtlas(options);
}

// SuperPoint: 256 floats each.
inline Atlas WithFloatDescriptors() {
  Atlas atlas = SynthesizeAtlas({.keyframes = 3, .points = 15, .features = 30, .threads = 1});
  const auto matrix = [](std::size_t rows) {
    Matrix made{.rows = static_cast<std::int32_t>(rows), .columns = 256, .type = 5, .continuous = true};
    made.data.resize(rows * 256 * sizeof(float), std::byte{0x3e});
    return made;
  };
  for (KeyFrame& keyframe : atlas.maps[0].keyframes) {
    keyframe.carried.Make().descriptors = matrix(keyframe.features.descriptors.size());
    keyframe.features.descriptors.clear();
    keyframe.features.descriptors_form = MatrixForm::kEmpty;
  }
  for (MapPoint& point : atlas.maps[0].points) {
    point.carried.Make().descriptors = matrix(1);
    point.descriptor = {};
    point.descriptor_form = MatrixForm::kEmpty;
  }
  return atlas;
}

// v1.0 with one change: `{"class": "MapPoint", "after": "nObs", "add": [["mnVisible", "i32"]]}`; and more classes.
inline std::string Changed(const std::string& change, const std::string& classes = "{}") {
  return ToJson(ParseLayout(R"({"base": "v1.0", "classes": )" + classes + R"(, "changes": [)" + change + "]}"));
}

}  // namespace slamdb
