// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "slamdb/formats/format.h"
#include "slamdb/formats/stella/detail/stella_map.h"
#include "slamdb/model/index.h"

namespace slamdb::stella {

// A keyframe as it is written: only what is written too is referred to.
struct OutgoingKeyFrame {
  const KeyFrame* keyframe = nullptr;
  std::size_t camera = 0, orb_params = 0;  // rows of the lists of Outgoing
  std::size_t rows = 0;                    // keypoints, of the left camera
  std::vector<std::int32_t> points;        // which they see, -1: none
  bool has_stereo = false;                 // x_rights and depths are written
  KeyFrameId parent;
  std::vector<KeyFrameId> children, loop_edges;  // ascending
};

// A point as it is written.
struct OutgoingPoint {
  const MapPoint* point = nullptr;
  KeyFrameId reference;  // sees it
};

// The columns of a keyframe as they are written, `rows` each.
struct OutgoingFeatures {
  std::span<const Keypoint> undistorted;  // of the keyframe, or `changed`
  Column<Keypoint> changed;
  std::span<const float> right_x, depth;  // of the keyframe, or padded; or none
  Column<float> padded_right_x, padded_depth;
};

// What both formats write of a point: `1st_keyfrm`, -1 where none fits; how often it was seen or found, from 1 on, as
// ORB-SLAM3 counts from there when it loads a map.
std::int64_t FirstKeyFrameOf(const MapPoint& point);
inline std::uint64_t CountOf(std::int32_t recorded) { return recorded > 0 ? static_cast<std::uint32_t>(recorded) : 1; }

// Keypoints with a response, or a size that is not their octave's: what only a database holds.
std::uint64_t CountShapes(const OutgoingKeyFrame& written);

// What is written of an atlas, in one file: maps that are chosen, each with a root of its own.
// Refers to the atlas.
class Outgoing {
 public:
  // Says what is left out. Throws Error (kNotPossible) when ids do not fit into 31 bits, or stand twice.
  Outgoing(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices);

  const std::vector<LensCamera>& cameras() const { return cameras_; }
  const std::vector<OrbParams>& orb_params() const { return orb_params_; }
  const std::vector<OutgoingKeyFrame>& keyframes() const { return keyframes_; }  // by id
  const std::vector<OutgoingPoint>& points() const { return points_; }           // by id
  std::uint64_t next_keyframe() const { return next_keyframe_; }
  std::uint64_t next_point() const { return next_point_; }

  OutgoingFeatures FeaturesOf(const OutgoingKeyFrame& keyframe) const;

 private:
  // What the notices tell.
  struct Losses {
    std::uint64_t bad_keyframes = 0, without_pose = 0, without_position = 0, bad_points = 0, unseen_points = 0,
                  cut_loops = 0, right_keypoints = 0, merges = 0, without_descriptor = 0, rows = 0, sizes = 0,
                  slots = 0, observations = 0, told = 0;
    void Tell(Notices& notices) const;
  };

  void CollectKeyFrames(const std::vector<const Map*>& maps);
  void CollectPoints(const std::vector<const Map*>& maps);
  void FindSlots(int threads);
  void PlacePoint(const MapPoint& point);
  struct SlotCounts {
    std::uint64_t lost = 0, told = 0;  // keypoints of a point that is elsewhere, and that learn of one
  };
  SlotCounts PlaceSlots(OutgoingKeyFrame& written) const;
  void KeepSeenPoints();
  KeyFrameId ParentOf(const KeyFrame& keyframe);
  void FindTree();
  void FindCameras(const Atlas& atlas);
  void FindOrbParams();
  void CountRows(OutgoingKeyFrame& written);
  bool IsWritten(KeyFrameId id) const { return id && keyframe_rows_.Find(id.value()) != kNoRow; }

  std::string path_;
  std::vector<LensCamera> cameras_;
  std::vector<OrbParams> orb_params_;
  std::vector<OutgoingKeyFrame> keyframes_;
  std::vector<OutgoingPoint> points_;
  IdTable keyframe_rows_, point_rows_;
  std::map<KeyFrameId, KeyFrameId> left_out_;  // keyframes, and their parents
  std::uint64_t next_keyframe_ = 0, next_point_ = 0;
  Losses losses_;
};

}  // namespace slamdb::stella
