// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/align.h"

#include <array>

#include "slamdb/align/detail/align_pair.h"
#include "slamdb/align/detail/prepared_map.h"
#include "slamdb/base/error.h"

namespace slamdb {

Alignment AlignMaps(MapRef first, MapRef second, const AlignOptions& options) {
  const detail::PreparedMaps prepared(std::array{first, second}, options);
  return detail::AlignPair(prepared[0], prepared[1], prepared.trained_words(), options);
}

}  // namespace slamdb
