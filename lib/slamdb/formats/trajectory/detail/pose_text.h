// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <string>
#include <vector>

#include "slamdb/formats/format.h"
#include "slamdb/formats/trajectory/detail/poses.h"

// Trajectories as their text has them: with every digit, which an atlas of single precision has no place for.
namespace slamdb::detail {

// world_from_camera.
struct PoseText {
  std::string seconds;                  // without exponent
  std::array<std::string, 3> position;  // metres
  std::array<std::string, 4> rotation;  // x y z w, of unit length
  double timestamp = 0;
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  Eigen::Quaterniond quaternion = Eigen::Quaterniond::Identity();  // of unit length
};

struct MapText {
  MapId id;
  std::vector<PoseText> poses;  // in the order of the file
};
using TrajectoryText = std::vector<MapText>;

// What rows without names are.
enum class PoseLayout {
  kTum,    // seconds, x y z, quaternion x y z w
  kEuroc,  // nanoseconds, x y z, quaternion w x y z
  kKitti,  // the rows of a 3x4 matrix; times in another file
};

// Reads a trajectory; the comment `# map 2` begins map 2. Rows without a pose (lost, not a number) are left out and
// named. Throws Error naming line, column, what is there and what was expected.
TrajectoryText ReadTrajectoryText(const Source& source, PoseLayout layout, const ReadOptions& options,
                                  Notices& notices);

// The same as an atlas of poses, in single precision; names as a loss what that cannot hold.
Atlas ReadPoses(const Source& source, PoseLayout layout, const ReadOptions& options, Notices& notices);

// The maps to write by time, and what is selected of them.
void Select(TrajectoryText& maps, const Selection& selection);

// How formats write a trajectory that was read as text. They return how many poses they wrote, and tell it.
using WriteText = std::size_t (*)(const TrajectoryText&, const Target&, const WriteOptions&, Notices&);
std::size_t WriteTumText(const TrajectoryText& maps, const Target& target, const WriteOptions& options,
                         Notices& notices);
std::size_t WriteEurocText(const TrajectoryText& maps, const Target& target, const WriteOptions& options,
                           Notices& notices);
std::size_t WriteKittiText(const TrajectoryText& maps, const Target& target, const WriteOptions& options,
                           Notices& notices);

// Fills position and rotation as text.
void SetText(PoseText& pose, const Eigen::Vector3f& position,
             const Eigen::Quaternion<float, Eigen::DontAlign>& rotation);

// A header, and the lines of each map; with several maps, of which it warns, `# map 2` stands above each. Tells the
// summary.
struct MapLines {
  MapId id;
  std::string lines;
};
void WriteMapLines(const std::vector<MapLines>& maps, std::string_view header, const PoseCount& count,
                   const Target& target, const WriteOptions& options, Notices& notices);

}  // namespace slamdb::detail
