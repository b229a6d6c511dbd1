// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/align/align.h"
#include "slamdb/align/detail/prepared_map.h"

namespace slamdb::detail {

// AlignMaps of maps that are prepared. `own_vocabulary`: their words are of a trained one.
Alignment AlignPair(const PreparedMap& first, const PreparedMap& second, bool own_vocabulary,
                    const AlignOptions& options);

}  // namespace slamdb::detail
