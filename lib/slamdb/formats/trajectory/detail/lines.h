// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "slamdb/formats/trajectory/detail/poses.h"

namespace slamdb {

// One line of a trajectory file that is not a comment.
struct PoseLine {
  std::string_view time;           // the first cell, still text
  std::span<const double> values;  // the cells behind it
};

// Reads a file of numbers line by line. Cells are separated by any of `separators`, comments begin with `#`, empty
// lines are skipped; the comment `# map 2` begins map 2. `pose` makes a pose of a line, or returns nullopt when the
// line is not one. Throws Error naming the line that is not.
struct ReadPose {
  double timestamp;
  Rigid3f world_from_camera;
};
Atlas ReadPoseLines(const Source& source, const ReadOptions& options, std::string_view separators,
                    const std::string& expected, const std::function<std::optional<ReadPose>(const PoseLine&)>& pose);

// A decimal number that fills the whole text; nullopt when it does not.
std::optional<double> ParseNumber(std::string_view text);
std::optional<std::int64_t> ParseInteger(std::string_view text);

// How many numbers the first line that is no comment has; 0 when it holds anything else.
std::size_t NumbersInFirstLine(const Probe& probe, std::string_view separators);

// `# map 2`, the comment line that begins a map.
std::string MapComment(MapId id);

}  // namespace slamdb
