// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "slamdb/export.h"
#include "slamdb/pictures/picture_list.h"

namespace slamdb {

// Of COLMAP's database.
enum class ColmapSchema {
  kOld,  // of COLMAP 3.8 to 3.11, which later versions bring up to date when they open it
  kNew,  // of COLMAP 4, with rigs and frames; 3.8 cannot open it
};

// The picture files that keyframes were made of.
// Each keyframe gets the one that is nearest in time, at most half of the median way from one picture to the next away.
struct SLAMDB_EXPORT KeyFramePictures {
  std::vector<PictureFile> files;  // as FindPictures finds them; none: names are made of the timestamps
  std::string folder;              // names are relative to it; empty: they are the files' own, without folder
};

// How models and databases of COLMAP are written.
struct SLAMDB_EXPORT ColmapWriteOptions {
  KeyFramePictures pictures;
  bool with_database = false;  // of models: database.db in the same folder
  ColmapSchema schema = ColmapSchema::kOld;
};

// How models of COLMAP are read.
struct SLAMDB_EXPORT ColmapReadOptions {
  std::string database;  // where keypoints' scales and angles and descriptors are; empty: database.db in the folder of
                         // the model or those above, up to two
  // Gets what was taken off all positions, which reach too far for the floats of an atlas; zero where nothing was.
  // Null: a warning says it.
  Eigen::Vector3d* origin = nullptr;
};

}  // namespace slamdb
