// SPDX-License-Identifier: BSD-3-Clause
// For each map: points that a rule takes, then keyframes one after the other; then the rest is closed over what stays.
#include "slamdb/edit/part/cull.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "slamdb/base/detail/parallel.h"
#include "slamdb/base/detail/steps.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/part/detail/cull_keyframes.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/reprojection.h"
#include "slamdb/model/sensor.h"

namespace slamdb {
namespace {

constexpr std::size_t kGrain = 1024;
constexpr double kRedundancy = 0.9, kRedundancyWithImuAndDepth = 0.5;
constexpr int kFewForMonocular = 3, kFewForDepth = 4;
constexpr std::int64_t kKeyFramesToProve = 2;  // a point may be young until so many keyframes after its first

enum class Verdict : std::uint8_t { kStays, kBad, kFew, kError, kParallax, kUnseen };

void RequireSense(const CullOptions& options) {
  const auto require = [](bool holds, const char* what) {
    if (!holds) throw Error(ErrorKind::kUsage, what);
  };
  const double* share = options.redundancy ? std::get_if<double>(&*options.redundancy) : nullptr;
  require(share == nullptr || (*share >= 0 && *share <= 1), "the share of redundant points must be between 0 and 1");
  require(options.redundant_observers > 0, "the number of other keyframes must be 1 or more");
  const int* observations = options.min_observations ? std::get_if<int>(&*options.min_observations) : nullptr;
  require(observations == nullptr || *observations >= 0, "the number of observations must not be negative");
  require(!options.max_error || *options.max_error > 0, "the largest reprojection error must be above 0");
  require(!options.min_parallax || (*options.min_parallax > 0 && *options.min_parallax < 180),
          "the least parallax must be between 0 and 180 degrees");
  require(!options.unseen_since || std::isfinite(*options.unseen_since), "the time since when must be finite");
}

// What rules ask of a map as a whole.
struct MapTraits {
  MapSensor sensor;
  bool has_imu;
  std::uint64_t largest_keyframe_id = 0;

  explicit MapTraits(const Map& map) : sensor(SensorOf(map)), has_imu(HasImu(map)) {
    for (const KeyFrame& keyframe : map.keyframes)
      largest_keyframe_id = std::max(largest_keyframe_id, keyframe.id.value());
  }
};

// The smallest int: every number is enough, also a damaged one below 0.
int FewestObservations(const MapTraits& traits, const CullOptions& options) {
  if (!options.min_observations) return std::numeric_limits<int>::min();
  if (const int* asked = std::get_if<int>(&*options.min_observations)) return *asked;
  return traits.sensor == MapSensor::kMonocular ? kFewForMonocular : kFewForDepth;
}

// The last keyframe whose points are no longer young. Ids may be anything.
std::int64_t LastProven(std::uint64_t newest) {
  const auto id = static_cast<std::int64_t>(newest);
  return std::max(id, std::numeric_limits<std::int64_t>::min() + kKeyFramesToProve) - kKeyFramesToProve;
}

// Judges the points of one map. Const, for many threads.
class PointRules {
 public:
  PointRules(const AtlasIndex& index, std::size_t map_row, const MapTraits& traits, const CullOptions& options)
      : index_(index),
        row_(map_row),
        map_(index.atlas().maps[map_row]),
        options_(options),
        reprojection_(index.atlas(), map_),
        last_proven_(LastProven(traits.largest_keyframe_id)),
        min_observations_(FewestObservations(traits, options)) {}

  Verdict Judge(const MapPoint& point) const {
    if (point.bad) return Verdict::kBad;
    if (point.observation_count < min_observations_ && point.first_keyframe <= last_proven_) return Verdict::kFew;
    if (options_.max_error && !(Error(point) <= *options_.max_error)) return Verdict::kError;
    if (options_.min_parallax && !HasDepth(point) && !HasParallax(point)) return Verdict::kParallax;
    if (options_.unseen_since && !IsSeenSince(point)) return Verdict::kUnseen;
    return Verdict::kStays;
  }

 private:
  // Root mean square over the observations that can be projected; infinite when none can.
  double Error(const MapPoint& point) const {
    double sum = 0;
    int count = 0;
    for (const Observation& observation : point.observations) {
      const KeyFrame* keyframe = reprojection_.Find(observation.keyframe);
      if (keyframe == nullptr) continue;
      const Reprojection::Errors errors = reprojection_.Of(point, observation);
      const auto add = [&](std::int32_t row, float error) {
        if (!std::isfinite(error)) return;
        const double scaled = error / ScaleOf(*keyframe, row);
        sum += scaled * scaled;
        ++count;
      };
      add(observation.left, errors.left);
      add(observation.right, errors.right);
    }
    return count == 0 ? std::numeric_limits<double>::infinity() : std::sqrt(sum / count);
  }

  static float ScaleOf(const KeyFrame& keyframe, std::int32_t row) {
    const std::vector<float>& factors = keyframe.pyramid.factors;
    const auto octave = static_cast<std::size_t>(std::max(ObservedKeypoint(keyframe, row)->octave, 0));
    return octave < factors.size() ? factors[octave] : 1.0F;
  }

  bool HasDepth(const MapPoint& point) const {
    return std::ranges::any_of(point.observations, [&](const Observation& observation) {
      const KeyFrame* keyframe = index_.FindKeyFrame(row_, observation.keyframe);
      return keyframe != nullptr && ObservationWeight(*keyframe, observation) >= 2;
    });
  }

  bool HasParallax(const MapPoint& point) const {
    const auto enough = static_cast<float>(std::cos(*options_.min_parallax * std::numbers::pi / 180));
    std::vector<Eigen::Vector3f> rays;
    for (const Observation& observation : point.observations) {
      const KeyFrame* keyframe = index_.FindKeyFrame(row_, observation.keyframe);
      if (keyframe == nullptr) continue;
      const Eigen::Vector3f ray = (point.position - CameraCenter(*keyframe)).normalized();
      if (std::ranges::any_of(rays, [&](const Eigen::Vector3f& other) { return other.dot(ray) <= enough; }))
        return true;
      rays.push_back(ray);
    }
    return false;
  }

  bool IsSeenSince(const MapPoint& point) const {
    return std::ranges::any_of(point.observations, [&](const Observation& observation) {
      const KeyFrame* keyframe = index_.FindKeyFrame(row_, observation.keyframe);
      return keyframe != nullptr && keyframe->timestamp >= *options_.unseen_since;
    });
  }

  const AtlasIndex& index_;
  const std::size_t row_;
  const Map& map_;
  const CullOptions& options_;
  const Reprojection reprojection_;
  const std::int64_t last_proven_;
  const int min_observations_;
};

void CullPoints(const AtlasIndex& index, std::size_t map_row, const MapTraits& traits, const CullOptions& options,
                Subset::MapRows& rows, CullReport& report) {
  const Map& map = index.atlas().maps[map_row];
  const PointRules rules(index, map_row, traits, options);
  std::vector<Verdict> verdicts(map.points.size(), Verdict::kStays);
  detail::ParallelFor(map.points.size(), kGrain, options.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row)
      if (rows.points[row]) verdicts[row] = rules.Judge(map.points[row]);
  });
  std::uint64_t ignored = 0;
  std::uint64_t* counts[] = {
      &ignored,      &report.bad_points, &report.few_observations, &report.large_errors, &report.small_parallax,
      &report.unseen};
  for (std::size_t row = 0; row < verdicts.size(); ++row) {
    ++*counts[static_cast<std::size_t>(verdicts[row])];
    if (verdicts[row] != Verdict::kStays) rows.points[row] = 0;
  }
}

double RedundancyOf(const MapTraits& traits, const OrOfSensor<double>& asked) {
  if (const double* share = std::get_if<double>(&asked)) return *share;
  const bool has_depth = traits.sensor != MapSensor::kMonocular;
  return traits.has_imu && has_depth ? kRedundancyWithImuAndDepth : kRedundancy;
}

std::uint64_t CountPoints(const Subset& subset) {
  std::uint64_t count = 0;
  for (const Subset::MapRows& rows : subset.maps)
    count += static_cast<std::uint64_t>(std::ranges::count(rows.points, 1));
  return count;
}

}  // namespace

CullReport Cull(Atlas& atlas, const CullOptions& options) {
  RequireSense(options);
  CullReport report;
  const AtlasIndex index(atlas);
  Subset kept = Subset::Everything(atlas);
  detail::Steps steps(options.progress, "culling", atlas.maps.size());
  for (std::size_t row = 0; row < atlas.maps.size(); ++row) {
    const MapTraits traits(atlas.maps[row]);
    CullPoints(index, row, traits, options, kept.maps[row], report);
    if (options.redundancy)
      report.redundant_keyframes += detail::CullKeyFrames(index, row,
                                                          {.share = RedundancyOf(traits, *options.redundancy),
                                                           .observers = options.redundant_observers,
                                                           .depth_counts = traits.sensor != MapSensor::kMonocular},
                                                          kept.maps[row]);
    steps.Next();
  }
  SettleBorder(index, Border::kSmart, kept, options.threads);
  const std::uint64_t by_rules =
      report.bad_points + report.few_observations + report.large_errors + report.small_parallax + report.unseen;
  report.unheld = CountEntities(atlas).points - by_rules - CountPoints(kept);
  report.coverage = MeasureCoverage(index, kept);
  report.removed = KeepSubset(atlas, kept, options.threads);
  return report;
}

}  // namespace slamdb
