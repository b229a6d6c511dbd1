// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>

#include "slamdb/formats/colmap/detail/outline.h"
#include "slamdb/model/index.h"

// Atlases as models of COLMAP, and back.
namespace slamdb::colmap {

// What a model does not hold of the maps, with counts.
struct Unheld {
  std::uint64_t bad_points = 0;      // flagged bad
  std::uint64_t strange_points = 0;  // not finite, or with an id that another one of the map has, or none
  std::uint64_t observations = 0;    // of keypoints that are not there, or that another point has
  std::uint64_t alone = 0;           // of points that no other image sees
  std::uint64_t slots = 0;           // keypoints that say they see a point which does not say so
  std::uint64_t stereo = 0;          // right columns and depths
  std::uint64_t matches = 0;         // of left and right keypoints of a fisheye pair that are not one point
  std::uint64_t descriptors = 0;     // of keypoints, which a database holds
  std::uint64_t keypoints = 0;       // whose scales, angles and scores are not held
};

// A map as a model: keypoints as detected with the lens that distorts them, points in their order with the keypoints
// that observe them, which are consistent.
//
// Cost: linear. Deterministic whatever the threads.
Model ModelOf(const Outline& outline, const MapOutline& map, const WriteOptions& options, Unheld& unheld);

// Which row of Model::points an id is.
IdTable PointRowsOf(const Model& model);

// Warns of keyframes and points that an export leaves out for their numbers.
void WarnOfLeftOut(const Outline& outline, const Unheld& unheld, Notices& notices);
// Says what else was left out.
void Tell(const Outline& outline, const Unheld& unheld, std::string_view format, bool with_database, Notices& notices);

class FeatureDatabase;

// A model that was read, and where it stood.
struct NamedModel {
  std::string path;
  std::uint64_t map = 0;  // its id: the number of the folder
  Model model;
};

// The models as maps of one atlas, as ORB-SLAM3 records it as far as they tell. Cameras are refused by name where
// slamdb has none such.
//
// `database`: where scales, angles and descriptors of keypoints are; may be null.
//
// Throws Error (kUnsupported) for those, and what FeatureDatabase throws.
Atlas AtlasOf(std::span<NamedModel> models, FeatureDatabase* database, const ReadOptions& options, Notices& notices);

}  // namespace slamdb::colmap
