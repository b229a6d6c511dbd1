// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <unordered_map>
#include <vector>

#include "slamdb/formats/colmap/detail/model.h"

namespace slamdb::colmap {

// Where an image is: its pose, and the other of the pair that it is one of.
struct Place {
  Pose camera_from_world;
  std::optional<std::uint32_t> right;  // of a left image: the row of the right one
  Pose right_from_left;
  bool is_right = false;
};

// The poses of images by frames and rigs where there are any; those of the images themselves are copies.
class Places {
 public:
  explicit Places(const Model& model);

  const Place& operator[](std::size_t image) const { return places_[image]; }
  bool HasOtherRigs() const { return other_rigs_; }

 private:
  void Add(const Frame& frame, const Rig& rig);
  bool IsFisheye(std::uint32_t image) const;

  const Model& model_;
  std::unordered_map<std::uint64_t, std::uint32_t> images_, cameras_, rigs_;
  std::vector<Place> places_;
  bool other_rigs_ = false;
};

}  // namespace slamdb::colmap
