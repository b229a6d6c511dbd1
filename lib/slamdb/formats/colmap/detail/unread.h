// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "slamdb/base/notices.h"

namespace slamdb::colmap {

// What is left out of models that were read.
struct Unread {
  std::uint64_t images = 0;          // twice there, or of a camera that is not
  std::uint64_t points = 0;          // twice there
  std::uint64_t unseen = 0;          // points that are no image's keypoint
  std::uint64_t keypoints = 0;       // of points that are not there, or that the image sees twice
  std::uint64_t track_elements = 0;  // of keypoints that are not there, or see another point
  std::uint64_t colors = 0;          // of points
  std::uint64_t names = 0;           // of images, which are no times
  std::uint64_t undistorted = 0;     // keypoints of lenses that we have not
  std::uint64_t moved_models = 0;    // whose ids others had
  std::uint64_t rigs = 0;            // of other kinds than a fisheye stereo pair
  std::uint64_t strangers = 0;       // images that the database has not
  std::uint64_t descriptors = 0;     // of keypoints, that are not ORB's
  std::uint64_t undescribed = 0;     // keypoints without descriptor
  std::uint64_t rights = 0;          // right images by their names, of pairs that no rig makes
};

// Says it.
void Tell(const Unread& unread, bool has_database, bool with_descriptors, Notices& notices);

}  // namespace slamdb::colmap
