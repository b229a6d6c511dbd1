// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "slamdb/formats/sqlite/detail/packing.h"
#include "slamdb/model/landmark.h"

namespace slamdb::sqlite {

// landmark.features. Layout: schema/store.md.
void EncodeLandmarkFeatures(const std::vector<LandmarkFeature>& features, ByteWriter& out);

// Throws Error when the blob is damaged.
std::vector<LandmarkFeature> DecodeLandmarkFeatures(Bytes blob);

}  // namespace slamdb::sqlite
