// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/repair/detail/triangulate.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "slamdb/base/detail/parallel.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/index.h"

namespace slamdb::detail {
namespace {

constexpr std::uint64_t kLargestId = std::numeric_limits<std::int32_t>::max();
constexpr std::size_t kGrain = 64;           // points
constexpr std::size_t kMostPairs = 28;       // of views that are tried: all pairs of eight
constexpr double kMostCosine = 0.9998;       // of two rays with a parallax, as ORB-SLAM3 wants it
constexpr double kOutlierChiSquare = 5.991;  // of a reprojection, in units of the octave's variance

// A slot of a keyframe that holds the point.
struct Slot {
  std::uint32_t keyframe;  // row
  std::int32_t feature;
};

// What a slot tells of where the point is.
struct View {
  Slot slot;
  const Camera* camera;
  Eigen::Matrix3d rotation;  // camera_from_world
  Eigen::Vector3d translation;
  Eigen::Vector2f pixel;
  Eigen::Vector3d ray;  // in the camera, scaled to z = 1
  double sigma2;
  std::optional<Eigen::Vector3d> by_depth;  // where it is, by the depth alone

  bool is_right(const KeyFrame& keyframe) const {
    return keyframe.features.is_fisheye_stereo() && slot.feature >= keyframe.features.left_count;
  }
};

// A place for the point, and the views that it projects to.
struct Guess {
  Eigen::Vector3d position;
  std::vector<std::size_t> inliers;
  double error = 0;  // sum over them
};

// What all points are triangulated with.
struct Cameras {
  const AtlasIndex& index;
  const std::vector<CameraId>& unknown_lenses;

  // Null: nothing tells its rays.
  const Camera* Find(CameraId id) const {
    return std::ranges::find(unknown_lenses, id) == unknown_lenses.end() ? index.FindCamera(id) : nullptr;
  }
};

std::optional<View> ViewOf(const Cameras& cameras, const KeyFrame& keyframe, const Slot& slot) {
  const Features& features = keyframe.features;
  const Keypoint* keypoint = ObservedKeypoint(features, slot.feature);
  const bool right = features.is_fisheye_stereo() && slot.feature >= features.left_count;
  const Camera* camera = cameras.Find(right ? keyframe.right_camera : keyframe.camera);
  if (keypoint == nullptr || camera == nullptr) return std::nullopt;
  const auto octave = static_cast<std::size_t>(std::max(keypoint->octave, 0));
  if (octave >= keyframe.pyramid.sigma2.size()) return std::nullopt;
  const Rigid3f pose = right ? RightCameraFromWorld(keyframe) : keyframe.camera_from_world;
  View view{.slot = slot,
            .camera = camera,
            .rotation = pose.rotation.normalized().toRotationMatrix().cast<double>(),
            .translation = pose.translation.cast<double>(),
            .pixel = {keypoint->x, keypoint->y},
            .ray = Unproject(*camera, {keypoint->x, keypoint->y}).cast<double>(),
            .sigma2 = static_cast<double>(keyframe.pyramid.sigma2[octave]),
            .by_depth = {}};
  if (!view.rotation.allFinite() || !view.translation.allFinite() || !view.ray.allFinite() || !(view.sigma2 > 0))
    return std::nullopt;
  const auto in_camera =
      features.is_fisheye_stereo() ? std::nullopt : UnprojectDepth(features, keyframe.intrinsics, slot.feature);
  if (in_camera && in_camera->allFinite())
    view.by_depth = view.rotation.transpose() * (in_camera->cast<double>() - view.translation);
  return view;
}

// The least squares of the views' projection equations.
std::optional<Eigen::Vector3d> Intersect(const std::vector<View>& views, const std::vector<std::size_t>& rows) {
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  for (const std::size_t row : rows) {
    Eigen::Matrix<double, 3, 4> pose;
    pose << views[row].rotation, views[row].translation;
    for (const int axis : {0, 1}) {
      const Eigen::RowVector4d equation = views[row].ray[axis] * pose.row(2) - pose.row(axis);
      normal += equation.transpose() * equation;
    }
  }
  const Eigen::Vector4d point = Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d>(normal).eigenvectors().col(0);
  if (!(std::abs(point.w()) > 1e-12)) return std::nullopt;
  return Eigen::Vector3d(point.head<3>() / point.w());
}

Guess Judge(const std::vector<View>& views, const Eigen::Vector3d& position) {
  Guess guess{.position = position, .inliers = {}};
  for (std::size_t row = 0; row < views.size(); ++row) {
    const View& view = views[row];
    const Eigen::Vector3d in_camera = view.rotation * position + view.translation;
    if (!in_camera.allFinite() || !(in_camera.z() > 0)) continue;
    const auto pixel = Project(*view.camera, in_camera.cast<float>());
    if (!pixel) continue;
    const double error = static_cast<double>((*pixel - view.pixel).squaredNorm()) / view.sigma2;
    if (!(error <= kOutlierChiSquare)) continue;
    guess.inliers.push_back(row);
    guess.error += error;
  }
  return guess;
}

bool HasParallax(const std::vector<View>& views, const std::vector<std::size_t>& rows) {
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const View &a = views[rows[i]], &b = views[rows[j]];
      const Eigen::Vector3d first = a.rotation.transpose() * a.ray, second = b.rotation.transpose() * b.ray;
      if (first.dot(second) < kMostCosine * first.norm() * second.norm()) return true;
    }
  return false;
}

bool HoldsInPlace(const std::vector<View>& views, const std::vector<std::size_t>& rows) {
  const auto has_depth = [&](std::size_t row) { return views[row].by_depth.has_value(); };
  return std::ranges::any_of(rows, has_depth) || HasParallax(views, rows);
}

// The place that most views agree on.
std::optional<Guess> Locate(const std::vector<View>& views) {
  std::optional<Guess> best;
  const auto consider = [&](const std::optional<Eigen::Vector3d>& position) {
    if (!position || !position->allFinite()) return;
    Guess guess = Judge(views, *position);
    const bool better = !best || guess.inliers.size() > best->inliers.size() ||
                        (guess.inliers.size() == best->inliers.size() && guess.error < best->error);
    if (better && HoldsInPlace(views, guess.inliers)) best = std::move(guess);
  };
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    consider(views[i].by_depth);
    for (std::size_t j = 0; j < i && pairs < kMostPairs; ++j, ++pairs) consider(Intersect(views, {i, j}));
  }
  if (best && best->inliers.size() > 2 && HasParallax(views, best->inliers)) consider(Intersect(views, best->inliers));
  return best;
}

// Of a keyframe's slots one each in its left and its right image: the first.
std::vector<Observation> ObservationsOf(const Map& map, const std::vector<View>& views,
                                        const std::vector<std::size_t>& inliers) {
  std::map<KeyFrameId, Observation> by_keyframe;
  for (const std::size_t row : inliers) {
    const View& view = views[row];
    const KeyFrame& keyframe = map.keyframes[view.slot.keyframe];
    Observation& observation = by_keyframe.try_emplace(keyframe.id, Observation{keyframe.id}).first->second;
    std::int32_t& side = view.is_right(keyframe) ? observation.right : observation.left;
    if (side < 0) side = view.slot.feature;
  }
  std::vector<Observation> observations;
  for (const auto& [id, observation] : by_keyframe) observations.push_back(observation);
  return observations;
}

// The values that ORB-SLAM3 derives from the observations; the first observer is the reference.
MapPoint Describe(const Map& map, const IdTable& keyframes, MapPointId id, const Eigen::Vector3f& position,
                  const std::vector<Observation>& observations) {
  MapPoint point{.id = id, .position = position};
  std::vector<Descriptor> descriptors;
  std::vector<Eigen::Vector3f> centers;
  for (const Observation& observation : observations) {
    const KeyFrame& keyframe = map.keyframes[keyframes.Find(observation.keyframe.value())];
    point.observations.push_back(observation);
    point.observation_count += ObservationWeight(keyframe, observation);
    for (const std::int32_t row : {observation.left, observation.right})
      if (row >= 0) descriptors.push_back(keyframe.features.descriptors[static_cast<std::size_t>(row)]);
    if (observation.left >= 0) centers.push_back(CameraCenter(keyframe));
    if (observation.right >= 0) centers.push_back(RightCameraCenter(keyframe));
  }
  const Observation& first = observations.front();
  const KeyFrame& reference = map.keyframes[keyframes.Find(first.keyframe.value())];
  point.first_keyframe = static_cast<std::int64_t>(reference.id.value());
  point.first_frame = static_cast<std::int64_t>(reference.frame_id);
  point.reference = reference.id;
  point.normal = MeanViewingDirection(position, centers);
  point.descriptor = descriptors[MostDistinctiveDescriptor(descriptors)];
  const Keypoint* keypoint = ObservedKeypoint(reference, first.left >= 0 ? first.left : first.right);
  const DistanceRange range =
      DeriveDistanceRange((position - CameraCenter(reference)).norm(), keypoint->octave, reference.pyramid);
  point.min_distance = range.min;
  point.max_distance = range.max;
  return point;
}

using LostPoints = std::map<MapPointId, std::vector<Slot>>;

LostPoints FindLostPoints(const AtlasIndex& index, const Map& map) {
  LostPoints lost;
  for (std::uint32_t row = 0; row < map.keyframes.size(); ++row) {
    const Features& features = map.keyframes[row].features;
    const std::size_t slots = std::min(features.map_points.size(), features.descriptors.size());
    for (std::size_t feature = 0; feature < slots; ++feature) {
      const MapPointId id = features.map_points[feature];
      if (id && id.value() <= kLargestId && !index.LocatePoint(id))
        lost[id].push_back({row, static_cast<std::int32_t>(feature)});
    }
  }
  return lost;
}

std::optional<MapPoint> Triangulate(const Cameras& cameras, const Map& map, const IdTable& keyframes, MapPointId id,
                                    const std::vector<Slot>& slots) {
  std::vector<View> views;
  for (const Slot& slot : slots)
    if (const auto view = ViewOf(cameras, map.keyframes[slot.keyframe], slot)) views.push_back(*view);
  const std::optional<Guess> guess = Locate(views);
  if (!guess) return std::nullopt;
  return Describe(map, keyframes, id, guess->position.cast<float>(), ObservationsOf(map, views, guess->inliers));
}

// Empties the slots that hold the point and are not of its observations.
void EmptyOtherSlots(const MapPoint& point, const std::vector<Slot>& slots, Map& map) {
  for (const Slot& slot : slots) {
    KeyFrame& keyframe = map.keyframes[slot.keyframe];
    const auto observes = [&](const Observation& observation) {
      return observation.keyframe == keyframe.id &&
             (observation.left == slot.feature || observation.right == slot.feature);
    };
    if (std::ranges::none_of(point.observations, observes))
      keyframe.features.map_points[static_cast<std::size_t>(slot.feature)] = MapPointId();
  }
}

}  // namespace

std::vector<MapPointId> TriangulateLostPoints(Atlas& atlas, const std::vector<CameraId>& unknown_lenses, int threads) {
  const AtlasIndex index(atlas);
  const Cameras cameras{index, unknown_lenses};
  std::vector<std::vector<std::optional<MapPoint>>> made(atlas.maps.size());
  std::vector<LostPoints> lost;
  for (std::size_t row = 0; row < atlas.maps.size(); ++row) {
    const Map& map = atlas.maps[row];
    lost.push_back(FindLostPoints(index, map));
    const IdTable keyframes = KeyFrameTable(map);
    const std::vector<LostPoints::value_type> list(lost[row].begin(), lost[row].end());
    made[row].resize(list.size());
    ParallelFor(list.size(), kGrain, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        made[row][i] = Triangulate(cameras, map, keyframes, list[i].first, list[i].second);
    });
  }
  std::vector<MapPointId> ids;  // the index is of no use from here on
  std::set<MapPointId> seen;    // in two maps: the first one's
  for (std::size_t row = 0; row < atlas.maps.size(); ++row)
    for (std::optional<MapPoint>& point : made[row]) {
      if (!point || !seen.insert(point->id).second) continue;
      EmptyOtherSlots(*point, lost[row].at(point->id), atlas.maps[row]);
      ids.push_back(point->id);
      atlas.maps[row].points.push_back(*std::move(point));
    }
  return ids;
}

}  // namespace slamdb::detail
