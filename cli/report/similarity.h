// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "slamdb/model/similarity.h"

namespace slamdb::cli {

// `translation 1.2 0 3, rotation 90 degrees about 0 0 1, scale 2`; what does nothing is left out.
// `unit`: what follows lengths, as " m".
std::string SimilarityText(const Similarity3d& transform, std::string_view unit = "");

}  // namespace slamdb::cli
