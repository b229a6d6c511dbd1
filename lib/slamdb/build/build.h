// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "slamdb/build/imu.h"
#include "slamdb/export.h"
#include "slamdb/model/atlas.h"

// Atlases of columns: what a SLAM or SfM system has in arrays becomes keyframes and points that ORB-SLAM3 loads.
// What is not given is derived as ORB-SLAM3 derives it.
//
// Each function throws Error (kUsage) that names the column, the row and what it should be, and then changes nothing.
namespace slamdb {

// Adds a camera. Without an id it gets the next one.
//
// Throws Error (kUsage) when the parameters are not those of the model, or the id is taken.
SLAMDB_EXPORT CameraId AddCamera(Atlas& atlas, CameraModel model, std::vector<float> parameters, CameraId id = {});

// Adds an empty map. Without an id it gets the next one.
//
// Throws Error (kUsage) when the id is taken.
SLAMDB_EXPORT MapId AddMap(Atlas& atlas, MapId id = {});

// Keyframes of one camera or one fisheye pair, row by row.
struct NewKeyFrames {
  std::vector<double> timestamps;          // seconds
  std::vector<Rigid3f> camera_from_world;  // left camera; unit quaternions
  // As long as its keypoints or empty: undistorted, right_x, depth, right_of_left; descriptors also have those of the
  // right keypoints behind the left ones, in a fisheye pair. Keypoints of size 0 get ORB's. All else is derived.
  std::vector<Features> features;
  std::vector<KeyFrameId> ids;     // empty: the next ones
  CameraId camera, right_camera;   // the latter of a fisheye pair only
  std::vector<double> distortion;  // k1 k2 p1 p2 [k3] of a pinhole (Brown)
  std::int32_t width = 0;          // of the pictures, pixels
  std::int32_t height = 0;         // both 0: around the keypoints
  double baseline = 0;             // metres: of a rectified pair, or as chosen for an RGB-D camera
  double depth_threshold = 0;      // metres, beyond which stereo points are far; 0: 40 baselines
  Rigid3f left_from_right;         // of a fisheye pair
  std::int32_t levels = 8;         // of the image pyramid
  float scale_factor = 1.2F;       // between them
  std::optional<NewImu> imu;       // of sessions with one
};

// Adds keyframes to a map, behind those it has, and returns their ids.
//
// Undistorted keypoints follow from the lens, right_x and depth from each other, the grid from the picture's size.
// Parents are those that were made before, until points tell better ones (AddPoints).
// Bags of words stay empty: ORB-SLAM3 makes them when it loads the map, RecomputeWords before that.
// With an IMU the map is inertial, and the keyframes go into its chain in time, whatever they were added after.
// SetImuStage says how far it is.
//
// Throws Error: kUsage as above; kNotFound when there is no such map.
// Cost: linear in the atlas.
SLAMDB_EXPORT std::vector<KeyFrameId> AddKeyFrames(Atlas& atlas, MapId map, NewKeyFrames given);

// "Point `point` of the columns is keypoint `keypoint` of that keyframe". Of a fisheye pair the keypoints of the right
// picture stand behind those of the left one.
struct NewObservation {
  std::uint64_t point = 0;
  KeyFrameId keyframe;
  std::uint64_t keypoint = 0;
};

// Points, row by row. All but positions and observations may be empty.
struct NewPoints {
  std::vector<Eigen::Vector3f> positions;  // world
  std::vector<NewObservation> observations;
  std::vector<MapPointId> ids;                      // empty: the next ones
  std::vector<Descriptor> descriptors;              // empty: the most distinctive of those observed
  std::vector<Eigen::Vector3f> normals;             // empty: mean viewing directions
  std::vector<KeyFrameId> references;               // empty: the observer of the lowest id
  std::vector<float> min_distances, max_distances;  // empty: by the reference's octave
};

// Adds points to a map, behind those it has, and returns their ids. Each must be observed.
//
// Keypoints see them then. Covisibility of all that see them is counted anew; keyframes that were covisible with none
// before get the parent that they share most points with.
//
// Throws Error: kUsage as above; kNotFound when there is no such map.
// Cost: linear in the atlas, and in the observers of the points that those keyframes see.
SLAMDB_EXPORT std::vector<MapPointId> AddPoints(Atlas& atlas, MapId map, NewPoints given, int threads = 0);

// camera_from_world of a camera in the world.
//
// Throws Error (kUsage) that says why the numbers are no pose; `argument` is what it calls them.
SLAMDB_EXPORT Rigid3f CameraFromWorldOf(const Eigen::Matrix4d& world_from_camera, const std::string& argument);
SLAMDB_EXPORT Rigid3f CameraFromWorldOf(const Eigen::Quaterniond& world_from_camera, const Eigen::Vector3d& center,
                                        const std::string& argument);

}  // namespace slamdb
