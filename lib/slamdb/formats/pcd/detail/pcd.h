// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/format.h"

namespace slamdb::detail {

// Points as a PCD file (Point Cloud Library, version 0.7), binary or ascii: write only. schema/pcd.md has the fields.
// PCL, Open3D and CloudCompare read it.
extern const Format kPcdFormat;

}  // namespace slamdb::detail
