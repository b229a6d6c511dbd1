// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "slamdb/formats/orbslam3/detail/decoder.h"

namespace slamdb::orbslam3 {

// The bytes of each part by its name; what belongs to none is `other`.
void ListPartSizes(const PartBytes& bytes, std::size_t file_bytes, std::vector<PartSize>& sizes);

}  // namespace slamdb::orbslam3
