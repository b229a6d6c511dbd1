// SPDX-License-Identifier: BSD-3-Clause
// Map points to landmarks and back.
#include <algorithm>
#include <atomic>
#include <numbers>
#include <unordered_map>

#include "slamdb/base/detail/parallel.h"
#include "slamdb/base/detail/steps.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/landmarks/detail/points.h"
#include "slamdb/edit/landmarks/landmarks.h"
#include "slamdb/model/counters.h"
#include "slamdb/model/covariance.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/index.h"

namespace slamdb {
namespace {

constexpr std::size_t kGrain = 1024;  // points

double RoundedToFloat(double value) { return static_cast<double>(static_cast<float>(value)); }

// What all landmarks of a map are made with.
class LandmarkMaker {
 public:
  LandmarkMaker(const Atlas& atlas, const Map& map, double pixel_sigma)
      : map_(map), keyframes_(KeyFrameTable(map)), covariances_(atlas, map, pixel_sigma) {}

  Landmark Make(const MapPoint& point) const {
    Landmark landmark;
    landmark.id = LandmarkId(point.id.value());
    GaussianPoint pose{.mean = point.position.cast<double>()};
    pose.covariance = covariances_.Of(point).value_or(pose.covariance).unaryExpr(&RoundedToFloat);
    landmark.set_pose(pose);
    landmark.normal = detail::LandmarkNormalOf(point);
    landmark.seen_count = static_cast<std::uint32_t>(point.observations.size());
    for (const Observation& observation : point.observations)
      if (const KeyFrame* keyframe = Find(observation.keyframe))
        landmark.last_seen = std::max(landmark.last_seen, TicksOfSeconds(keyframe->timestamp));
    if (const Observation* reference = ReferenceObservation(point))
      if (const KeyFrame* keyframe = Find(reference->keyframe)) AddFeature(point, *keyframe, *reference, landmark);
    return landmark;
  }

 private:
  const KeyFrame* Find(KeyFrameId id) const {
    const std::uint32_t row = keyframes_.Find(id.value());
    return row == kNoRow ? nullptr : &map_.keyframes[row];
  }

  // Its own, or the first when the reference keyframe does not observe it.
  static const Observation* ReferenceObservation(const MapPoint& point) {
    if (point.observations.empty()) return nullptr;
    const auto found =
        std::find_if(point.observations.begin(), point.observations.end(),
                     [&](const Observation& observation) { return observation.keyframe == point.reference; });
    return found == point.observations.end() ? &point.observations.front() : &*found;
  }

  static void AddFeature(const MapPoint& point, const KeyFrame& keyframe, const Observation& observation,
                         Landmark& landmark) {
    const std::int32_t row = observation.left >= 0 ? observation.left : observation.right;
    const Keypoint* keypoint = ObservedKeypoint(keyframe, row);
    if (keypoint == nullptr) return;
    const bool is_right = observation.left < 0;
    const Rigid3f left = keyframe.camera_from_world.Normalized();
    const Rigid3f camera_from_world = is_right ? keyframe.left_from_right.Normalized().Inverse() * left : left;
    LandmarkFeature& feature = landmark.CreateOneFeature();
    feature.x = keypoint->x;
    feature.y = keypoint->y;
    feature.keypoint_id = static_cast<std::uint64_t>(row);
    feature.type = FeatureType::kOrb;
    feature.response = keypoint->response;
    feature.orientation = keypoint->angle * std::numbers::pi_v<float> / 180;
    feature.octave = static_cast<std::uint8_t>(std::clamp(keypoint->octave, 0, 255));
    feature.position_in_camera = (camera_from_world * point.position).cast<double>();
    feature.depth = feature.initial_depth = feature.position_in_camera.z();
    if (point.has_descriptor())
      feature.descriptors.push_back({DescriptorKind::kOrb, {point.descriptor.begin(), point.descriptor.end()}});
  }

  const Map& map_;
  IdTable keyframes_;
  PointCovariances covariances_;
};

// Which map each point id of an atlas belongs to; hands out new ones.
class PointIds {
 public:
  explicit PointIds(const Atlas& atlas) : next_(std::max(atlas.next_ids.map_point, LeastCounters(atlas).map_point)) {
    for (const Map& map : atlas.maps)
      for (const MapPoint& point : map.points) owners_.emplace(point.id.value(), &map);
  }

  // The landmark's own id for a point of the map, or a new one.
  LandmarkId Claim(const Landmark& landmark, const Map& map) {
    if (landmark.is_numbered() && owners_.emplace(landmark.id.value(), &map).first->second == &map) return landmark.id;
    return LandmarkId(next_++);
  }
  std::uint64_t next() const { return next_; }

 private:
  std::unordered_map<std::uint64_t, const Map*> owners_;
  std::uint64_t next_;
};

}  // namespace

MakeLandmarksReport MakeLandmarks(Atlas& atlas, const MakeLandmarksOptions& options) {
  if (!(options.pixel_sigma > 0)) throw Error(ErrorKind::kUsage, "the sigma of a keypoint must be above 0");
  MakeLandmarksReport report;
  detail::Steps steps(options.progress, "making landmarks", atlas.maps.size());
  for (Map& map : atlas.maps) {
    std::vector<const MapPoint*> good;
    good.reserve(map.points.size());
    for (const MapPoint& point : map.points)
      if (!point.bad) good.push_back(&point);
    report.bad += map.points.size() - good.size();
    const LandmarkMaker maker(atlas, map, options.pixel_sigma);
    std::vector<Landmark> landmarks(good.size());
    std::atomic<std::uint64_t> undetermined{0};
    detail::ParallelFor(good.size(), kGrain, options.threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        landmarks[i] = maker.Make(*good[i]);
        undetermined += landmarks[i].pose().covariance.isZero(0);
      }
    });
    report.landmarks += landmarks.size();
    report.undetermined += undetermined;
    const IdTable points = PointTable(map);
    for (Landmark& landmark : map.landmarks)
      if (points.Find(landmark.id.value()) == kNoRow) landmarks.push_back(std::move(landmark));
    map.landmarks = std::move(landmarks);
    steps.Next();
  }
  return report;
}

MakePointsReport MakePoints(Atlas& atlas) {
  MakePointsReport report;
  PointIds ids(atlas);
  for (Map& map : atlas.maps) {
    const IdTable rows = PointTable(map);
    std::vector<Landmark> landmarks;
    report.fused += TakeLandmarks(landmarks, map.landmarks);  // one of each id
    const detail::Turning turning = detail::TurnNormals(landmarks, [&](const Landmark& landmark) {
      const std::uint32_t row = rows.Find(landmark.id.value());
      return row == kNoRow ? nullptr : &map.points[row];
    });
    report.turned += turning.turned;
    report.unturned += turning.unturned;
    for (Landmark& landmark : landmarks) {
      const std::uint32_t row = rows.Find(landmark.id.value());
      if (row != kNoRow) {
        detail::MoveTo(landmark, map.points[row]);
        ++report.moved;
        continue;
      }
      const LandmarkId id = ids.Claim(landmark, map);
      report.renamed += landmark.is_numbered() && id != landmark.id;
      landmark.id = id;
      map.points.push_back(detail::PointOf(landmark, MapPointId(id.value())));
      ++report.added;
      report.plain += !map.points.back().has_descriptor();
    }
    map.landmarks = std::move(landmarks);
  }
  atlas.next_ids.map_point = ids.next();
  return report;
}

}  // namespace slamdb
