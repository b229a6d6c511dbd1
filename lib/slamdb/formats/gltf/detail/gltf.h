// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/format.h"

namespace slamdb::detail {

// A scene as binary glTF 2.0: points, cameras and their path, a node for each map and keyframe: write only.
// schema/gltf.md says what is where. Blender, three.js, Windows and phones show it.
extern const Format kGltfFormat;

}  // namespace slamdb::detail
