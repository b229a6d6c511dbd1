// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/format.h"

namespace slamdb::detail {

// Points as a PLY file (Stanford polygon format 1.0), binary little endian or ascii: write only. schema/ply.md has the
// properties. MeshLab, CloudCompare, Open3D and PCL read it.
extern const Format kPlyFormat;

}  // namespace slamdb::detail
