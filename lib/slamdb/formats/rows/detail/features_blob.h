// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/base/file.h"
#include "slamdb/model/detail/packing.h"
#include "slamdb/model/keyframe.h"

namespace slamdb::rows {

using detail::ByteReader;
using detail::ByteWriter;

// The features of a keyframe, column after column, as narrow as their values allow: picture.columns, what the picture
// gave, and keyframe_features.points, the links to points. What follows from other columns to the very same bytes is
// left out: the grid, undistorted keypoints that equal the keypoints as detected, columns of one repeated value.
// Layout: schema/store.md. Thread-safe.
void EncodePicture(const KeyFrame& keyframe, ByteWriter& out);
void EncodePoints(const KeyFrame& keyframe, ByteWriter& out);

// Fills keyframe.features but for its three counts. `keyframe.bounds` and the counts are set already, because the grid
// is derived with them. Throws Error when a blob is damaged.
void DecodeFeatures(Bytes picture, Bytes points, KeyFrame& keyframe);

// ---- stores before version 7 have both in one blob

void DecodeWholeFeatures(Bytes blob, KeyFrame& keyframe);

struct SplitFeatures {
  std::string picture;
  Bytes points;  // of the blob that was split
};
// A damaged blob becomes a damaged picture without points, and the other way round.
SplitFeatures Split(Bytes whole);
std::string Join(Bytes picture, Bytes points);

}  // namespace slamdb::rows
