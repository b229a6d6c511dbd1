// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/repair/detail/triangulate.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>

#include "slamdb/base/detail/parallel.h"
#include "slamdb/model/covariance.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/detail/observed.h"
#include "slamdb/model/index.h"

namespace slamdb::detail {
namespace {

constexpr std::size_t kGrain = 64;      // points
constexpr std::size_t kMostTried = 8;   // views from which places are guessed; all views judge them
constexpr int kSteps = 4;               // of a refinement
constexpr int kRounds = 8;              // of refinements, each over the views that agreed with the one before
constexpr double kMostCosine = 0.9998;  // of two rays with a parallax, as ORB-SLAM3 wants it
constexpr double kOutlierOfTwo = 5.991, kOutlierOfThree = 7.815;  // chi-square of a pixel, and of one with a depth

// A slot of a keyframe that holds the point.
struct Slot {
  std::uint32_t keyframe;  // row
  std::int32_t feature;
};

// What a slot tells of where the point is.
struct View {
  Slot slot;
  bool right;  // of a fisheye pair
  const Camera* camera;
  Eigen::Matrix3d rotation;  // camera_from_world
  Eigen::Vector3d translation;
  Eigen::Vector2d pixel;
  Eigen::Vector3d ray;  // in the world, of unit length
  double sigma2;
  double baseline_fx = 0;
  std::optional<double> depth;

  Eigen::Vector3d ToCamera(const Eigen::Vector3d& position) const { return rotation * position + translation; }
};

// A place for the point, and the views that agree with it.
struct Guess {
  Eigen::Vector3d position;
  std::vector<std::size_t> inliers;
  double error = 0;  // sum over them

  bool IsBetterThan(const std::optional<Guess>& other) const {
    return !other || inliers.size() > other->inliers.size() ||
           (inliers.size() == other->inliers.size() && error < other->error);
  }
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
            .right = right,
            .camera = camera,
            .rotation = pose.rotation.normalized().toRotationMatrix().cast<double>(),
            .translation = pose.translation.cast<double>(),
            .pixel = {keypoint->x, keypoint->y},
            .ray = Unproject(*camera, {keypoint->x, keypoint->y}).cast<double>(),
            .sigma2 = static_cast<double>(keyframe.pyramid.sigma2[octave]),
            .depth = {}};
  view.ray = view.rotation.transpose() * view.ray.normalized();
  if (!view.rotation.allFinite() || !view.translation.allFinite() || !view.ray.allFinite() || !(view.sigma2 > 0))
    return std::nullopt;
  const float baseline_fx = keyframe.intrinsics.baseline_fx;
  if (features.is_fisheye_stereo() || !(baseline_fx > 0) || !std::isfinite(baseline_fx)) return view;
  view.baseline_fx = static_cast<double>(baseline_fx);
  const auto in_camera = UnprojectDepth(features, keyframe.intrinsics, slot.feature);
  if (in_camera && std::isfinite(in_camera->z())) view.depth = static_cast<double>(in_camera->z());
  return view;
}

bool HasParallax(const View& a, const View& b) { return a.ray.dot(b.ray) < kMostCosine; }

// Of the rows' rays the two with the widest angle, or nearly: the farthest from the first, and the farthest from that.
std::pair<std::size_t, std::size_t> WidestPair(const std::vector<View>& views, const std::vector<std::size_t>& rows) {
  const auto farthest_from = [&](std::size_t from) {
    return *std::ranges::min_element(rows, {}, [&](std::size_t row) { return views[from].ray.dot(views[row].ray); });
  };
  const std::size_t first = farthest_from(rows.front());
  return {first, farthest_from(first)};
}

// Where the view's depth alone puts the point.
std::optional<Eigen::Vector3d> AtDepth(const View& view) {
  if (!view.depth) return std::nullopt;
  const Eigen::Vector3d in_camera = view.rotation * view.ray;
  return view.rotation.transpose() * (in_camera * (*view.depth / in_camera.z()) - view.translation);
}

// The place that is nearest to both rays.
std::optional<Eigen::Vector3d> Intersect(const View& a, const View& b) {
  if (!HasParallax(a, b)) return std::nullopt;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right_side = Eigen::Vector3d::Zero();
  for (const View* view : {&a, &b}) {
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - view->ray * view->ray.transpose();
    normal += across;
    right_side -= across * (view->rotation.transpose() * view->translation);
  }
  return normal.ldlt().solve(right_side);
}

// How far the place is from what the view saw, in pixels: of the image, and, where it has a depth, of the column that
// the right image of a stereo pair would have.
std::optional<Eigen::Vector3d> ResidualOf(const View& view, const Eigen::Vector3d& in_camera) {
  if (!in_camera.allFinite() || !(in_camera.z() > 0)) return std::nullopt;
  const auto pixel = Project(*view.camera, in_camera.cast<float>());
  if (!pixel) return std::nullopt;
  Eigen::Vector3d residual = Eigen::Vector3d::Zero();
  residual.head<2>() = pixel->cast<double>() - view.pixel;
  if (view.depth) residual.z() = residual.x() - view.baseline_fx * (1 / in_camera.z() - 1 / *view.depth);
  return residual;
}

Guess Judge(const std::vector<View>& views, const Eigen::Vector3d& position) {
  Guess guess{.position = position, .inliers = {}};
  for (std::size_t row = 0; row < views.size(); ++row) {
    const View& view = views[row];
    const auto residual = ResidualOf(view, view.ToCamera(position));
    if (!residual) continue;
    const double error = residual->squaredNorm() / view.sigma2;
    if (!(error <= (view.depth ? kOutlierOfThree : kOutlierOfTwo))) continue;
    guess.inliers.push_back(row);
    guess.error += error;
  }
  return guess;
}

// The least squares of the residuals of the views that agree, from the guess on.
std::optional<Eigen::Vector3d> Refine(const std::vector<View>& views, const Guess& guess) {
  Eigen::Vector3d position = guess.position;
  for (int step = 0; step < kSteps; ++step) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right_side = Eigen::Vector3d::Zero();
    for (const std::size_t row : guess.inliers) {
      const View& view = views[row];
      const Eigen::Vector3d in_camera = view.ToCamera(position);
      const auto residual = ResidualOf(view, in_camera);
      const auto by_camera = ProjectionJacobian(*view.camera, in_camera);
      if (!residual || !by_camera) return std::nullopt;
      Eigen::Matrix3d jacobian = Eigen::Matrix3d::Zero();
      jacobian.topRows<2>() = *by_camera;
      if (view.depth) {
        jacobian.row(2) = by_camera->row(0);
        jacobian(2, 2) += view.baseline_fx / (in_camera.z() * in_camera.z());
      }
      jacobian *= view.rotation;
      normal += jacobian.transpose() * jacobian / view.sigma2;
      right_side -= jacobian.transpose() * *residual / view.sigma2;
    }
    position += normal.ldlt().solve(right_side);
  }
  return position;
}

bool HoldsInPlace(const std::vector<View>& views, const std::vector<std::size_t>& rows) {
  if (rows.empty()) return false;
  if (std::ranges::any_of(rows, [&](std::size_t row) { return views[row].depth.has_value(); })) return true;
  const auto [first, second] = WidestPair(views, rows);
  return HasParallax(views[first], views[second]);
}

// Up to kMostTried rows of views, evenly spaced.
std::vector<std::size_t> RowsToTry(std::size_t views) {
  const std::size_t count = std::min(views, kMostTried);
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < count; ++i) rows.push_back(i * views / count);
  return rows;
}

// The place that most views agree on: where two rays with a parallax meet, or where a depth puts it.
std::optional<Guess> Locate(const std::vector<View>& views) {
  std::optional<Guess> best;
  const auto consider = [&](const std::optional<Eigen::Vector3d>& position) {
    if (!position || !position->allFinite()) return false;
    Guess guess = Judge(views, *position);
    if (!guess.IsBetterThan(best) || !HoldsInPlace(views, guess.inliers)) return false;
    best = std::move(guess);
    return true;
  };
  const std::vector<std::size_t> tried = RowsToTry(views.size());
  for (std::size_t i = 0; i < tried.size(); ++i) {
    consider(AtDepth(views[tried[i]]));
    for (std::size_t j = 0; j < i; ++j) consider(Intersect(views[tried[i]], views[tried[j]]));
  }
  if (!views.empty()) {
    std::vector<std::size_t> all(views.size());
    std::iota(all.begin(), all.end(), 0);
    const auto [first, second] = WidestPair(views, all);
    consider(Intersect(views[first], views[second]));
  }
  for (int round = 0; round < kRounds && best && consider(Refine(views, *best)); ++round) {
  }
  const bool most_agree = best && 2 * best->inliers.size() > views.size();  // else nothing tells who is right
  return most_agree ? best : std::nullopt;
}

// Of a keyframe's slots one each in its left and its right image: the first.
std::vector<Observation> ObservationsOf(const Map& map, const std::vector<View>& views,
                                        const std::vector<std::size_t>& inliers) {
  std::map<KeyFrameId, Observation> by_keyframe;
  for (const std::size_t row : inliers) {
    const View& view = views[row];
    const KeyFrameId keyframe = map.keyframes[view.slot.keyframe].id;
    Observation& observation = by_keyframe.try_emplace(keyframe, Observation{keyframe}).first->second;
    std::int32_t& side = view.right ? observation.right : observation.left;
    if (side < 0) side = view.slot.feature;
  }
  std::vector<Observation> observations;
  for (const auto& [id, observation] : by_keyframe) observations.push_back(observation);
  return observations;
}

// The values that ORB-SLAM3 derives from the observations; the first observer is the reference.
MapPoint Describe(const AtlasIndex& index, std::size_t map, MapPointId id, const Eigen::Vector3f& position,
                  const std::vector<Observation>& observations) {
  const auto find = [&](KeyFrameId keyframe) { return index.FindKeyFrame(map, keyframe); };
  MapPoint point{.id = id, .position = position};
  for (const Observation& observation : observations) {
    point.observations.push_back(observation);
    point.observation_count += ObservationWeight(*find(observation.keyframe), observation);
  }
  const KeyFrame& reference = *find(observations.front().keyframe);
  point.first_keyframe = static_cast<std::int64_t>(reference.id.value());
  point.first_frame = static_cast<std::int64_t>(reference.frame_id);
  point.reference = reference.id;
  point.normal = ObservedNormal(point, find).value_or(Eigen::Vector3f::Zero());
  const std::vector<Descriptor> descriptors = ObservedDescriptors(point, find);
  point.descriptor = descriptors[MostDistinctiveDescriptor(descriptors)];
  const DistanceRange range = ObservedRange(point, reference);
  point.min_distance = range.min;
  point.max_distance = range.max;
  return point;
}

// A point that no map holds, the slots that hold it, and what was made of them.
struct LostPoint {
  MapPointId id;
  std::vector<Slot> slots;
  std::optional<MapPoint> made;
};

// Ascending by id.
std::vector<LostPoint> FindLostPoints(const AtlasIndex& index, const Map& map) {
  std::map<MapPointId, std::vector<Slot>> lost;
  for (std::uint32_t row = 0; row < map.keyframes.size(); ++row) {
    const Features& features = map.keyframes[row].features;
    const std::size_t slots = std::min(features.map_points.size(), features.descriptors.size());
    for (std::size_t feature = 0; feature < slots; ++feature) {
      const MapPointId id = features.map_points[feature];
      if (id && id.value() <= kLargestId && !index.LocatePoint(id))
        lost[id].push_back({row, static_cast<std::int32_t>(feature)});
    }
  }
  std::vector<LostPoint> points;
  for (auto& [id, slots] : lost) points.push_back({id, std::move(slots), {}});
  return points;
}

std::optional<MapPoint> Triangulate(const Cameras& cameras, std::size_t map_row, const LostPoint& point) {
  const Map& map = cameras.index.atlas().maps[map_row];
  std::vector<View> views;
  for (const Slot& slot : point.slots)
    if (const auto view = ViewOf(cameras, map.keyframes[slot.keyframe], slot)) views.push_back(*view);
  const std::optional<Guess> guess = Locate(views);
  if (!guess) return std::nullopt;
  return Describe(cameras.index, map_row, point.id, guess->position.cast<float>(),
                  ObservationsOf(map, views, guess->inliers));
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
  std::vector<std::vector<LostPoint>> lost;  // by row of Atlas::maps
  for (std::size_t row = 0; row < atlas.maps.size(); ++row) {
    std::vector<LostPoint>& points = lost.emplace_back(FindLostPoints(index, atlas.maps[row]));
    ParallelFor(points.size(), kGrain, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) points[i].made = Triangulate(cameras, row, points[i]);
    });
  }
  std::vector<MapPointId> ids;  // the index is of no use from here on
  std::set<MapPointId> seen;    // in two maps: the first one's
  for (std::size_t row = 0; row < atlas.maps.size(); ++row)
    for (LostPoint& point : lost[row]) {
      if (!point.made || !seen.insert(point.id).second) continue;
      EmptyOtherSlots(*point.made, point.slots, atlas.maps[row]);
      ids.push_back(point.id);
      atlas.maps[row].points.push_back(*std::move(point.made));
    }
  return ids;
}

}  // namespace slamdb::detail
