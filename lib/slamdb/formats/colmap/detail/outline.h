// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "slamdb/formats/colmap/detail/model.h"
#include "slamdb/formats/colmap/options.h"
#include "slamdb/formats/format.h"
#include "slamdb/pictures/camera_settings.h"

// What of an atlas goes into models and databases of COLMAP, and under which ids and names. The ids are those of the
// whole atlas, so that models of several maps and one database fit together.
namespace slamdb::colmap {

// An image: of a keyframe the only one, or the left or the right one of a fisheye stereo pair.
struct View {
  const KeyFrame* keyframe = nullptr;
  std::uint32_t image = 0;   // its id: the keyframe's and one more where these fit
  std::uint32_t camera = 0;  // row of Outline::cameras
  std::uint32_t rig = 0;     // row of Outline::rigs
  bool right = false;        // stands behind its left one
  bool undistorted = false;  // its keypoints are those without distortion, for want of one that leads to them
  std::string name;
  std::string picture;  // the path of its file; empty: not known
};

struct MapOutline {
  const Map* map = nullptr;
  std::vector<View> views;                 // keyframe after keyframe, as the map lists them
  std::vector<std::uint32_t> view_of_row;  // of Map::keyframes: its first view; kNoRow: left out
};

// One camera of a rig; ids are those of the file.
struct OutlineCamera {
  std::uint32_t id = 0;
  CameraSettings settings;
};

// One camera, or a fisheye stereo pair.
struct OutlineRig {
  std::uint32_t id = 0;
  std::uint32_t left = 0, right = 0;  // rows of Outline::cameras; the same: one camera
  Pose right_from_left;
  bool is_pair() const { return left != right; }
};

struct Outline {
  std::vector<MapOutline> maps;
  std::vector<OutlineCamera> cameras;
  std::vector<OutlineRig> rigs;

  std::uint64_t bad_keyframes = 0, not_finite = 0;  // keyframes left out
  bool renumbered = false;                          // ids of keyframes do not fit
  std::uint64_t without_picture = 0;                // keyframes that KeyFramePictures has none of
};

// Of the maps that options choose; those without keyframes and points are left out.
//
// Throws Error (kNotFound) when the chosen map is not there.
Outline OutlineOf(const Atlas& atlas, const Target& target, const WriteOptions& options,
                  const KeyFramePictures& pictures);

// Of the views of the maps: a fisheye pair is one.
std::size_t CountKeyFrames(std::span<const MapOutline> maps);

// The column that the keypoints of a view are in.
struct ViewKeypoints {
  const Column<Keypoint>* keypoints = nullptr;
  std::size_t first_row = 0;  // of the first one in Features::map_points and descriptors
};
ViewKeypoints KeypointsOf(const View& view);

// The right camera from the world, for a right view, in double.
Pose PoseOf(const View& view);

}  // namespace slamdb::colmap
