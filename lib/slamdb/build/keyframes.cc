// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <iterator>

#include "slamdb/base/detail/parallel.h"
#include "slamdb/build/build.h"
#include "slamdb/build/detail/chain.h"
#include "slamdb/build/detail/columns.h"
#include "slamdb/build/detail/imu.h"
#include "slamdb/build/detail/new_features.h"
#include "slamdb/formats/import/detail/complete.h"
#include "slamdb/formats/import/detail/completed.h"
#include "slamdb/model/counters.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/detail/is_pose.h"
#include "slamdb/model/detail/spanning_tree.h"
#include "slamdb/model/index.h"
#include "slamdb/pictures/detail/record_camera.h"

namespace slamdb {
namespace {

using detail::Refuse;
using detail::RefuseRow;

constexpr std::size_t kGrain = 16;
constexpr std::uint64_t kIdEnd = std::uint64_t{1} << 31;  // ORB-SLAM3's optimisers number vertices in 32 bits
constexpr std::int32_t kLargestSide = 1 << 20, kMostLevels = 32;

const Camera& CameraOf(const AtlasIndex& index, CameraId id, std::string_view argument) {
  const Camera* camera = index.FindCamera(id);
  if (camera == nullptr) Refuse(argument, ": the atlas has no ", id, "; AddCamera (add_camera) makes one");
  const std::size_t least = camera->model == CameraModel::kKannalaBrandt8 ? 8 : 4;
  if (camera->model == CameraModel::kEquirectangular || camera->parameters.size() < least)
    Refuse(argument, ": ", id, " has ", camera->parameters.size(),
           " parameters, or a model that nothing is projected with", "; AddCamera (add_camera) makes one that serves");
  return *camera;
}

void RequirePair(const AtlasIndex& index, const NewKeyFrames& given, const Camera& left) {
  if (!given.right_camera) return;
  const Camera& right = CameraOf(index, given.right_camera, "right_camera");
  if (left.model != CameraModel::kKannalaBrandt8 || right.model != CameraModel::kKannalaBrandt8)
    Refuse("right_camera: is of fisheye pairs, of two kannala-brandt-8 cameras; rectified pairs have right_x");
  if (!detail::IsPose(given.left_from_right)) Refuse("left_from_right: is no pose");
}

void RequireCamera(const AtlasIndex& index, const NewKeyFrames& given) {
  const Camera& camera = CameraOf(index, given.camera, "camera");
  RequirePair(index, given, camera);
  if (!given.distortion.empty() && (camera.model != CameraModel::kPinhole || given.distortion.size() > 5))
    Refuse("distortion: is k1 k2 p1 p2 [k3] of a pinhole; a fisheye lens has its own parameters");
  for (std::size_t row = 0; row < given.distortion.size(); ++row)
    if (!std::isfinite(given.distortion[row])) RefuseRow("distortion", row, "is not finite");
  const auto is_side = [](std::int32_t side) { return side >= 1 && side <= kLargestSide; };
  if ((given.width != 0 || given.height != 0) && (!is_side(given.width) || !is_side(given.height)))
    Refuse("image_size: ", given.width, " x ", given.height, " pixels are impossible");
  if (!(given.baseline >= 0) || !std::isfinite(given.baseline)) Refuse("baseline: is at least 0 metres");
  if (!(given.depth_threshold >= 0) || !std::isfinite(given.depth_threshold))
    Refuse("depth_threshold: is at least 0 metres");
  if (given.levels < 1 || given.levels > kMostLevels) Refuse("levels: are 1 to ", kMostLevels);
  if (!(given.scale_factor > 1 && given.scale_factor <= 4)) Refuse("scale_factor: is above 1, and 4 at most");
}

void RequireColumns(const NewKeyFrames& given) {
  const std::size_t rows = given.timestamps.size();
  detail::RequireLength("poses", given.camera_from_world, rows, "timestamps");
  detail::RequireLength("features", given.features, rows, "timestamps");
  detail::RequireLengthOrNone("ids", given.ids, rows, "timestamps");
  for (std::size_t row = 0; row < rows; ++row) {
    if (!std::isfinite(given.timestamps[row])) RefuseRow("timestamps", row, "is not finite; times are seconds");
    if (!detail::IsPose(given.camera_from_world[row]))
      RefuseRow("poses", row, "is no pose: it is not finite, or its quaternion is not of length 1");
    detail::RequireFeatures(given, row);
  }
}

// What all of them record.
KeyFrame BlankOf(const CameraSettings& settings, const NewKeyFrames& given, const Map& map) {
  constexpr float kDepthBaselines = 40;  // ThDepth of ORB-SLAM3's own settings
  KeyFrame blank;
  detail::RecordCamera(settings, blank);
  if (given.width == 0) blank.bounds = {};  // around the keypoints
  blank.intrinsics.baseline = static_cast<float>(given.baseline);
  blank.intrinsics.baseline_fx = blank.intrinsics.baseline * blank.intrinsics.fx;
  blank.half_baseline = blank.intrinsics.baseline / 2;
  if (given.right_camera) detail::RecordPair(given.right_camera, given.left_from_right, blank);
  blank.intrinsics.depth_threshold = given.depth_threshold > 0 ? static_cast<float>(given.depth_threshold)
                                                               : kDepthBaselines * blank.intrinsics.baseline;
  blank.pyramid = DerivePyramid(given.levels, given.scale_factor);
  blank.origin_map = static_cast<std::uint32_t>(map.id.value());
  return blank;
}

Column<KeyFrame> KeyFramesOf(const Atlas& atlas, const Map& map, NewKeyFrames& given, const Camera& camera) {
  const CameraSettings settings{
      .camera = camera, .distortion = given.distortion, .width = given.width, .height = given.height};
  const KeyFrame blank = BlankOf(settings, given, map);
  Column<KeyFrame> keyframes(given.timestamps.size(), blank);
  const std::uint64_t frame = std::max(LeastCounters(atlas).frame, atlas.next_ids.frame);
  detail::Completed completed;
  detail::ParallelFor(keyframes.size(), kGrain, 0, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      KeyFrame& keyframe = keyframes[row];
      keyframe.id = given.ids[row];
      keyframe.frame_id = frame + row;
      keyframe.timestamp = given.timestamps[row];
      keyframe.camera_from_world = given.camera_from_world[row];
      keyframe.features = std::move(given.features[row]);
      detail::CompleteNewFeatures(settings, given, keyframe);
      detail::CompleteFeatures(keyframe, completed);
      keyframe.imu_initialized = map.imu_initialized;
      if (given.imu) detail::RecordImu(*given.imu, row, keyframe);
    }
  });
  return keyframes;
}

// `first`: the first new row.
void CompleteTree(Map& map, std::size_t first) {
  map.first_keyframe = detail::RootOf(map);
  for (std::size_t row = first; row < map.keyframes.size(); ++row)
    map.keyframes[row].first_connection = map.keyframes[row].id == map.first_keyframe;
  detail::AdoptOrphans(map);
  detail::CompleteIds(map);
}

}  // namespace

std::vector<KeyFrameId> AddKeyFrames(Atlas& atlas, MapId map_id, NewKeyFrames given) {
  Map& map = detail::MapOf(atlas, map_id);
  const AtlasIndex index(atlas);
  RequireCamera(index, given);
  RequireColumns(given);
  detail::RequireImu(map, given);
  given.ids = detail::IdsOf(std::move(given.ids), given.timestamps.size(),
                            std::max(LeastCounters(atlas).keyframe, atlas.next_ids.keyframe), kIdEnd,
                            [&](KeyFrameId id) { return static_cast<bool>(index.LocateKeyFrame(id)); });
  const std::vector<detail::ChainStep> chain =
      given.imu ? detail::PlanChain(map, given) : std::vector<detail::ChainStep>();
  Column<KeyFrame> keyframes = KeyFramesOf(atlas, map, given, *index.FindCamera(given.camera));
  if (keyframes.empty()) return {};
  const std::size_t first = map.keyframes.size();
  map.keyframes.reserve(first + keyframes.size());
  std::ranges::move(keyframes, std::back_inserter(map.keyframes));
  CompleteTree(map, first);
  detail::FollowChain(map, chain);
  if (given.imu) map.inertial = true;
  RaiseCounters(atlas);
  return std::move(given.ids);
}

}  // namespace slamdb
