// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/base/detail/json.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/content.h"
#include "slamdb/model/similarity.h"
#include "slamdb/model/statistics.h"

// Parts of the model as JSON, one form each for all reports.
namespace slamdb::detail {

// null for none.
Json JsonId(std::uint64_t id);
template <class Entity>
Json JsonId(Id<Entity> id) {
  return JsonId(id.value());
}

// [x, y, z]
Json JsonOf(const Eigen::Vector3d& vector);
// {"translation": [x, y, z], "rotation_xyzw": [x, y, z, w], "scale": s}
Json JsonOf(const Similarity3d& transform);
// {"count": n, "mean": .., "median": .., "max": ..}
Json JsonOf(const Distribution& numbers);
// {"name": .., "checksum": ..}
Json JsonOf(const Vocabulary& vocabulary);
// {"text": .., "boost_version": .., "long_bytes": .., "size_bytes": ..}
Json JsonOf(const ArchiveEncoding& encoding);
// {"map": n, "keyframe": n, "point": n, "frame": n, "camera": n, "initial_keyframe": n}
Json JsonOf(const Counters& next_ids);
// Every count under its name.
Json JsonOf(const ContentCounts& counts);

}  // namespace slamdb::detail
