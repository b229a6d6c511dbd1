// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/base/file.h"
#include "slamdb/model/detail/packing.h"
#include "slamdb/model/keyframe.h"

namespace slamdb::sqlite {

using detail::ByteReader;
using detail::ByteWriter;

// keyframe_features.columns: the features of a keyframe, column after column, as narrow as their values allow. What
// follows from other columns to the very same bytes is left out: the grid, undistorted keypoints that equal the
// keypoints as detected, columns of one repeated value. Layout: schema/store.md. Thread-safe.
void EncodeFeatures(const KeyFrame& keyframe, ByteWriter& out);

// Fills keyframe.features but for its three counts. `keyframe.bounds` and the counts are set already, because the grid
// is derived with them. Throws Error when the blob is damaged.
void DecodeFeatures(Bytes blob, KeyFrame& keyframe);

}  // namespace slamdb::sqlite
