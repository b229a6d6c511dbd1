// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "slamdb/export.h"
#include "slamdb/formats/export/options.h"
#include "slamdb/formats/format.h"
#include "slamdb/model/trajectory_pose.h"

// Trajectories in and out of files, and out of atlases.
namespace slamdb {

// Whether files of the format are trajectories and nothing else: tum, euroc, kitti.
[[nodiscard]] SLAMDB_EXPORT bool IsTrajectory(const Format& format);

// The poses of a trajectory, in the order of the file. The second takes an input that was looked at before.
//
// Throws Error as ReadAtlas, and kNotPossible when the file holds several trajectories.
[[nodiscard]] SLAMDB_EXPORT std::vector<TrajectoryPose> ReadTrajectory(const Location& location,
                                                                       const ReadOptions& options = {},
                                                                       Notices* notices = nullptr);
[[nodiscard]] SLAMDB_EXPORT std::vector<TrajectoryPose> ReadTrajectory(const HeldSource& held,
                                                                       const ReadOptions& options = {},
                                                                       Notices* notices = nullptr);

// The same of a file that may hold several, each behind a line `# map ID`; those without poses are left out.
[[nodiscard]] SLAMDB_EXPORT std::vector<MapTrajectory> ReadTrajectories(const HeldSource& held,
                                                                        const ReadOptions& options = {},
                                                                        Notices* notices = nullptr);

// The trajectories of the maps of an atlas, by time, as they would be written to a file and read from it: keyframes
// that are flagged bad or not finite, and maps without any other, are left out; numbers are those of the shortest
// decimals of their floats, so that both have the same errors.
//
// Cost: O(n log n).
[[nodiscard]] SLAMDB_EXPORT std::vector<MapTrajectory> TrajectoriesOf(const Atlas& atlas,
                                                                      PoseFrame frame = PoseFrame::kCamera,
                                                                      Notices* notices = nullptr);

// Writes a trajectory as another one, with every digit that it has; of a selection what ReadOptions say.
// Returns how many poses were written.
//
// Throws Error as ReadAtlas and WriteAtlas do, and kNotFound, before anything is written, when nothing of what is there
// is selected.
SLAMDB_EXPORT std::size_t ConvertTrajectory(const Location& input, const Location& output, const ReadOptions& read = {},
                                            const WriteOptions& write = {}, Notices* notices = nullptr);
SLAMDB_EXPORT std::size_t ConvertTrajectory(const HeldSource& held, const Location& output,
                                            const ReadOptions& read = {}, const WriteOptions& write = {},
                                            Notices* notices = nullptr);

}  // namespace slamdb
