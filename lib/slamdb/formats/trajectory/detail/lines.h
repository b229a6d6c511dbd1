// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <functional>
#include <string>

#include "slamdb/base/detail/table.h"
#include "slamdb/formats/trajectory/detail/poses.h"

namespace slamdb::detail {

struct ReadPose {
  double timestamp;  // seconds
  Rigid3f world_from_camera;
};

// Reads a table whose rows are poses; the comment `# map 2` begins map 2. `pose` makes a pose of the row that a table
// is at. Throws Error naming the line that is none, and the column when it is a cell.
Atlas ReadPoses(const Source& source, const ReadOptions& options, const TableKind& kind,
                const std::function<ReadPose(const Table&)>& pose);

// The seven numbers behind the time in the order of the kind's columns.
std::array<double, 7> NumbersBehindTime(const Table& table);

// `# map 2`, the comment line that begins a map.
std::string MapComment(MapId id);

}  // namespace slamdb::detail
