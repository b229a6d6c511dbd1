// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "slamdb/base/file.h"
#include "slamdb/formats/sqlite/detail/packing.h"
#include "slamdb/model/keyframe.h"

namespace slamdb::sqlite {

// keyframe.details: calibration, image bounds, pyramid, IMU preintegration and calibration, and what else of a keyframe
// has no column of its own. Layout: schema/store.md.
void EncodeDetails(const KeyFrame& keyframe, ByteWriter& out);

// Throws Error when the blob is damaged.
void DecodeDetails(Bytes blob, KeyFrame& keyframe);

// The REAL columns of a keyframe other than its timestamp, in the schema's order: camera_from_world, velocity, IMU
// bias.
using KeyframeReals = std::array<float, 16>;
KeyframeReals RealsOf(const KeyFrame& keyframe);
void SetReals(KeyFrame& keyframe, const KeyframeReals& reals);

}  // namespace slamdb::sqlite
