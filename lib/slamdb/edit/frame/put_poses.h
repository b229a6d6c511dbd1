// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "slamdb/export.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/keyframe_pose.h"

namespace slamdb {

struct PutPosesOptions {
  std::vector<PointPosition> points;   // those of which it is known; the others follow their reference keyframe
  double max_time_difference = 0.005;  // seconds, between a keyframe and its pose, where the time of both is known
  // What was taken off all poses and points that are put, in whole numbers; zero: they stay as they are. It is added
  // again where the atlas reaches as far. Of an atlas that does not, another origin may have been taken off: the whole
  // numbers are that bring the poses and points nearest to what they are of, by the median, and a warning names what is
  // left off.
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  bool of_body = false;  // poses are of the body (IMU): each keyframe's calibration leads to its camera
  int threads = 0;       // 0: every core
};

// What PutPoses did.
struct PutPosesReport {
  std::uint64_t keyframes = 0;        // that were put
  std::uint64_t followers = 0;        // keyframes without a pose, that went with their parent
  std::uint64_t points = 0;           // that were put
  std::uint64_t unknown_poses = 0;    // of no keyframe of the atlas, or of one that is bad or had a pose already
  std::uint64_t unknown_points = 0;   // of no point of the atlas, or of one that is bad or seen elsewhere
  std::uint64_t maps = 0;             // in which something was put
  double largest_shift = 0;           // of a camera, the map's units
  std::vector<std::string> warnings;  // a sentence each
  std::vector<std::string> losses;    // what is not put as it was given: numbers that floats round visibly
};

// Puts what another program made of the poses of an atlas into it: keyframes by id, or by time where a pose has none.
// A keyframe without a pose goes with its parent in the spanning tree; a point without a position goes with its
// reference keyframe, and scales about it where the pose has a scale. Viewing directions and distance ranges of points,
// positions of bodies and directions of velocities follow. All else stays as it is.
// Maps for which there is nothing are not touched, and what did not change keeps its bytes.
//
// Warns where a pose is of another lens than the keyframe's: then neither poses nor points fit the keypoints as well as
// the program says.
//
// Throws Error, and then changes nothing: kNotPossible when no pose is of a keyframe of the atlas, one with an id is of
// another time than the keyframe, or one is of the body where the keyframe has no calibration; kUsage when a pose or a
// position is not finite. Cost: linear, but for sorting times; the bytes are the same for any number of threads.
SLAMDB_EXPORT PutPosesReport PutPoses(Atlas& atlas, const std::vector<KeyFramePose>& poses,
                                      const PutPosesOptions& options = {});

}  // namespace slamdb
