// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/slam_files.h"
#include "slamdb/formats/detail/select.h"
#include "slamdb/formats/import/detail/complete.h"
#include "slamdb/formats/import/detail/keypoints.h"
#include "slamdb/formats/import/detail/pinhole_cameras.h"
#include "slamdb/formats/orbslam2/detail/orbslam2.h"
#include "slamdb/formats/orbslam2/detail/read.h"

namespace slamdb {
namespace {

using detail::Concat;
using detail::Counted;

// A camera for each calibration matrix that keyframes have.
void MakeCameras(Atlas& atlas) {
  detail::PinholeCameras cameras;
  for (KeyFrame& keyframe : atlas.maps[0].keyframes) {
    const Eigen::Matrix3f& k = keyframe.calibration_matrix;
    keyframe.camera = cameras.IdOf({k(0, 0), k(1, 1), k(0, 2), k(1, 2)}, atlas);
  }
}

void FillSizes(KeyFrame& keyframe) {
  for (Column<Keypoint>* keypoints : {&keyframe.features.keypoints, &keyframe.features.undistorted})
    for (Keypoint& keypoint : *keypoints) keypoint.size = detail::PatchAt(keypoint.octave, keyframe.pyramid);
}

void Tell(const orbslam2::RecordedMap& recorded, Notices& notices) {
  notices.Note(
      "a map of ORB-SLAM2 does not say what camera and vocabulary it was made with: cameras are pinholes of the "
      "undistorted image, distortion is unknown, diameters of keypoints are those of their octaves, the vocabulary has "
      "no name");
  if (recorded.without_pose > 0)
    notices.Warn(Concat("the file has no pose of ", Counted(recorded.without_pose, "keyframe"), ": at the origin"));
  if (recorded.loose_keyframes + recorded.loose_points > 0)
    notices.Warn(
        Concat("not in the map, but linked to it, and not flagged bad: ", Counted(recorded.loose_keyframes, "keyframe"),
               ", ", Counted(recorded.loose_points, "map point"), "; they are kept"));
}

Atlas Read(const Source& source, const ReadOptions& options, Notices& notices) {
  orbslam2::RecordedMap recorded = orbslam2::ReadMap(source, options);
  Tell(recorded, notices);
  Atlas atlas;
  atlas.maps.push_back(std::move(recorded.map));
  Map& map = atlas.maps[0];
  map.id = MapId(0);
  atlas.next_ids.keyframe = recorded.next_keyframe;
  atlas.next_ids.map_point = recorded.next_point;
  MakeCameras(atlas);
  for (KeyFrame& keyframe : map.keyframes) FillSizes(keyframe);
  detail::CompleteAtlas(atlas, "ORB-SLAM2", options.threads, notices);
  detail::Select(options.selection, atlas);
  return atlas;
}

}  // namespace

const Format detail::kOrbslam2Format{
    .id = "orbslam2",
    .title = "ORB-SLAM2 map (BoostArchiver)",
    .kind = FileKind::kBinary,
    .reads = (Content::kAtlas & ~(Content::kInertial | Content::kMaps)) | Content::kTracking,
    .sniff = detail::IsOrbslam2Map,
    .read = Read};

}  // namespace slamdb
