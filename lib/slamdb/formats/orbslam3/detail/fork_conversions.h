// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <span>

#include "slamdb/formats/orbslam3/detail/fork_program.h"

namespace slamdb::orbslam3 {

// What members that stand side by side mean, by their names (`mTimeStamp.seconds`, `mTimeStamp.nanoseconds`), and how
// many of them it takes. Null: nothing, or not in these types. `own`: the type that v1.0 has for the first of them.
template <class Entity>
struct FoundConversion {
  std::shared_ptr<const Conversion<Entity>> conversion;
  std::size_t members = 1;
};

template <class Entity>
FoundConversion<Entity> FindConversion(std::span<const LayoutMember> members, std::span<const TypeNode> nodes,
                                       const LayoutType& own);

}  // namespace slamdb::orbslam3
