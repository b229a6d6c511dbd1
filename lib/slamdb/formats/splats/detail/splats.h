// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/format.h"

namespace slamdb::detail {

// Scenes for those who train NeRFs and Gaussian splats of pictures: schema/splats.md.
extern const Format kNerfFormat, kGaussianFormat;

}  // namespace slamdb::detail
