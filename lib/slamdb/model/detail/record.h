// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include "slamdb/base/file.h"
#include "slamdb/model/detail/packing.h"
#include "slamdb/model/keyframe.h"
#include "slamdb/model/landmark.h"

// Parts of entities as bytes, in an order that never changes: hashes are over these bytes (digest.h), and blobs of the
// store hold them. Layout: schema/store.md.
namespace slamdb::detail {

// Calibration, image bounds, pyramid, IMU preintegration and calibration, and what else of a keyframe is neither a
// column of its row in a store, nor a link, nor of its features.
void EncodeDetails(const KeyFrame& keyframe, ByteWriter& out);
// Throws Error (kDamaged) when the bytes are not those of EncodeDetails.
void DecodeDetails(Bytes blob, KeyFrame& keyframe);

void EncodeLandmarkFeatures(const std::vector<LandmarkFeature>& features, ByteWriter& out);
// Throws Error (kDamaged) when the bytes are not those of EncodeLandmarkFeatures.
std::vector<LandmarkFeature> DecodeLandmarkFeatures(Bytes blob);

// Nothing for null.
void EncodeCarried(const Boxed<Carried>& carried, ByteWriter& out);
// Null for no bytes. Throws Error (kDamaged) when the bytes are not those of EncodeCarried.
Boxed<Carried> DecodeCarried(Bytes blob);

// camera_from_world (w x y z, then the translation), velocity and IMU bias of a keyframe.
using KeyframeReals = std::array<float, 16>;
KeyframeReals RealsOf(const KeyFrame& keyframe);
void SetReals(KeyFrame& keyframe, const KeyframeReals& reals);

}  // namespace slamdb::detail
