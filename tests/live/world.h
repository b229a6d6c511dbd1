// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gmock/gmock.h>

#include "slamdb/live/atlas.h"
#include "slamdb/live/frame.h"
#include "slamdb/live/keyframe.h"
#include "slamdb/live/map.h"
#include "slamdb/live/map_point.h"
#include "slamdb/model/derive.h"
#include "tests/support/kind_of.h"

namespace slamdb::live {

enum class Eyes { kMono, kStereo, kFisheyePair };

// A stage for cases computed by hand: cameras that look along z without rotation, focal length 100, image 640 x 480,
// eight octaves of factor 2 (so that scales are powers of two).
class World {
 public:
  static constexpr int kFeatures = 40;

  explicit World(Eyes eyes = Eyes::kMono) : eyes_(eyes) {
    const std::vector<float> fisheye = {100, 100, 320, 240, 0, 0, 0, 0};
    if (eyes == Eyes::kFisheyePair) {
      left = atlas.AddCamera(new KannalaBrandt8(fisheye));
      std::vector<float> other = fisheye;
      other[2] = 310;
      right = atlas.AddCamera(new KannalaBrandt8(other));
    } else {
      left = atlas.AddCamera(new Pinhole({100, 100, 320, 240}));
    }
  }

  Map* map() { return atlas.GetCurrentMap(); }

  // Keypoint i: at (10 i, 20), octave i % 8, descriptor all zeros but byte 0 = i. Stereo: even ones have depth 2. A
  // fisheye pair has the first half of the keypoints left, the rest right, a baseline of 0.5 in x.
  slamdb::KeyFrame Image() const {
    slamdb::KeyFrame image;
    image.intrinsics = {.fx = 100, .fy = 100, .inverse_fx = 0.01F, .inverse_fy = 0.01F, .cx = 320, .cy = 240};
    image.intrinsics.baseline_fx = 10;
    image.intrinsics.depth_threshold = 3;
    image.bounds = {.grid_columns = 64,
                    .grid_rows = 48,
                    .inverse_cell_width = 0.1F,
                    .inverse_cell_height = 0.1F,
                    .min_x = 0,
                    .min_y = 0,
                    .max_x = 640,
                    .max_y = 480};
    image.pyramid = DerivePyramid(8, 2);
    Features& features = image.features;
    features.count = kFeatures;
    for (int i = 0; i < kFeatures; ++i) {
      const Keypoint keypoint{.angle = 0,
                              .response = 1,
                              .size = 31,
                              .x = 10.0F * static_cast<float>(i),
                              .y = 20,
                              .class_id = -1,
                              .octave = i % 8};
      const bool is_right = eyes_ == Eyes::kFisheyePair && i >= kFeatures / 2;
      (is_right ? features.right_keypoints : features.keypoints).push_back(keypoint);
      features.descriptors.push_back({static_cast<std::uint8_t>(i)});
      features.depth.push_back(eyes_ == Eyes::kStereo && i % 2 == 0 ? 2.0F : -1.0F);
      features.right_x.push_back(features.depth.back() > 0 ? keypoint.x - 5 : -1.0F);
    }
    features.undistorted = features.keypoints;
    if (eyes_ == Eyes::kFisheyePair) {
      features.left_count = features.right_count = kFeatures / 2;
      image.left_from_right.translation.x() = 0.5F;
    }
    return image;
  }

  Frame MakeFrame(const Eigen::Vector3f& center) {
    Frame frame(atlas, Image(), left, right);
    frame.SetPose({Quaternionf::Identity(), -center});
    return frame;
  }

  KeyFrame* AddKeyFrame(const Eigen::Vector3f& center = Eigen::Vector3f::Zero()) {
    Frame frame = MakeFrame(center);
    auto* keyframe = new KeyFrame(frame, map());
    map()->AddKeyFrame(keyframe);
    return keyframe;
  }

  MapPoint* AddPoint(KeyFrame* reference, const Eigen::Vector3f& position = {0, 0, 4}) {
    auto* point = new MapPoint(position, reference, map());
    map()->AddMapPoint(point);
    return point;
  }

  // Both sides of an observation.
  static void Observe(MapPoint* point, KeyFrame* keyframe, int row) {
    point->AddObservation(keyframe, row);
    keyframe->AddMapPoint(point, static_cast<std::size_t>(row));
  }

  // `count` new points that all of the keyframes see, from slot `first_row` up.
  std::vector<MapPoint*> Share(const std::vector<KeyFrame*>& keyframes, int count, int first_row) {
    std::vector<MapPoint*> points;
    for (int i = 0; i < count; ++i) {
      points.push_back(AddPoint(keyframes.front()));
      for (KeyFrame* keyframe : keyframes) Observe(points.back(), keyframe, first_row + i);
    }
    return points;
  }

  Atlas atlas;
  GeometricCamera *left = nullptr, *right = nullptr;

 private:
  Eyes eyes_;
};

}  // namespace slamdb::live
