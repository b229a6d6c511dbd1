// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/frame/transform_atlas.h"

#include <algorithm>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/median.h"
#include "slamdb/base/detail/steps.h"
#include "slamdb/base/error.h"
#include "slamdb/model/detail/json.h"
#include "slamdb/model/statistics.h"

namespace slamdb {
namespace {

using detail::Concat;
using detail::Json;

constexpr double kTrajectoryTimeDifference = 0.02, kGpsTimeDifference = 1;  // seconds

MovedMap LaidOnto(const Map& map, const std::vector<TimedPosition>& reference, const FitOptions& fit,
                  double default_time_difference) {
  TrajectoryAlignmentOptions options{.max_time_difference = fit.max_time_difference.value_or(default_time_difference),
                                     .body = fit.body};
  options.fit.with_scale = fit.with_scale.value_or(!IsMetric(map));
  options.fit.outlier_distance = fit.outlier_distance.value_or(0);
  options.fit.leave_out_gross = !fit.outlier_distance;
  options.time_offset = fit.time_offset;
  options.estimate_time_offset = fit.estimate_time_offset;
  const TrajectoryAlignment alignment = AlignToTrajectory(map, reference, options);
  MovedMap moved{.map = map.id, .target_from_source = alignment.reference_from_map, .alignment = alignment};
  const std::vector<OutlierPair>& outliers = alignment.outliers;
  if (!fit.outlier_distance && !outliers.empty())
    moved.warnings.push_back(Concat(detail::Counted(outliers.size(), "pair"), " of ", alignment.pairs,
                                    " left out as gross outliers: up to ", detail::Digits(outliers.front().residual),
                                    " off, at ", detail::Fixed(outliers.front().timestamp, 3),
                                    " s, where the others are ", detail::Digits(alignment.residuals.rmse, 3),
                                    " off (RMS); FitOptions::outlier_distance sets another limit"));
  if (alignment.rival_time_offset != alignment.time_offset)
    moved.warnings.push_back(Concat("the time offset is not certain: ", detail::Fixed(alignment.rival_time_offset, 3),
                                    " s fits nearly as well as ", detail::Fixed(alignment.time_offset, 3), " s"));
  if (auto poor = PoorFitWarning(alignment.residuals.rmse, alignment.spread))
    moved.warnings.push_back(*std::move(poor));
  return moved;
}

// The first fix, unless it is far from where most are.
Geodetic FirstAmongOthers(std::vector<GpsFix> fixes) {
  constexpr double kTimesFarther = 20, kNearby = 1000;  // metres
  std::erase_if(fixes, [](const GpsFix& fix) { return !fix.has_place(); });
  std::vector<Eigen::Vector3d> places;
  for (const GpsFix& fix : fixes) places.push_back(EcefFromGeodetic(fix.place));
  Eigen::Vector3d middle;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const Eigen::Vector3d& place : places) values.push_back(place[axis]);
    middle[axis] = detail::MedianOf(std::move(values));
  }
  std::vector<double> distances;
  for (const Eigen::Vector3d& place : places) distances.push_back((place - middle).norm());
  const double limit = std::max(kNearby, kTimesFarther * detail::MedianOf(distances));
  const auto first = std::ranges::find_if(distances, [limit](double distance) { return distance <= limit; });
  return fixes[static_cast<std::size_t>(first - distances.begin())].place;
}

// Finds the transform of one map after the other.
class Finder {
 public:
  explicit Finder(const Destination& motion) : destination_(motion) {
    if (const auto* everywhere = std::get_if<Similarity3d>(&motion)) RequireTransform(*everywhere);
    if (const auto* earth = std::get_if<OntoEarth>(&motion)) {
      if (std::ranges::none_of(earth->fixes, &GpsFix::has_place))
        throw Error(ErrorKind::kUsage, "there is no fix to lay the maps onto");
      frame_.emplace(earth->origin ? *earth->origin : FirstAmongOthers(earth->fixes));
      fixes_ = PositionsIn(*frame_, earth->fixes);
    }
  }

  bool needs_keyframes() const { return !std::holds_alternative<Similarity3d>(destination_); }
  std::optional<Geodetic> origin() const { return frame_ ? std::optional(frame_->origin()) : std::nullopt; }

  MovedMap Find(const Map& map) const {
    MovedMap moved = std::visit([&](const auto& motion) { return Follow(map, motion); }, destination_);
    RequireTransform(moved.target_from_source);
    std::vector<std::string> warnings = TransformWarnings(map, moved.target_from_source);
    moved.warnings.insert(moved.warnings.begin(), warnings.begin(), warnings.end());
    if (auto loss = CoarseningLoss(map, moved.target_from_source)) moved.losses.push_back(*std::move(loss));
    return moved;
  }

 private:
  static MovedMap Follow(const Map& map, const Similarity3d& everywhere) {
    return {.map = map.id, .target_from_source = everywhere};
  }
  static MovedMap Follow(const Map& map, const TurnUpright& turn) {
    const Up up = FindUp(map, turn.method);
    return {.map = map.id, .target_from_source = {1, UprightFromMap(up.direction)}, .up = up};
  }
  static MovedMap Follow(const Map& map, const OntoTrajectory& onto) {
    return LaidOnto(map, onto.reference, onto.fit, kTrajectoryTimeDifference);
  }
  MovedMap Follow(const Map& map, const OntoEarth& earth) const {
    return LaidOnto(map, fixes_, earth.fit, kGpsTimeDifference);
  }

  const Destination& destination_;
  std::optional<LocalFrame> frame_;
  std::vector<TimedPosition> fixes_;
};

std::vector<Map*> MapsToMove(Atlas& atlas, const TransformOptions& options, bool needs_keyframes) {
  std::vector<Map*> maps;
  for (Map& map : atlas.maps) {
    const bool asked = std::ranges::find(options.maps, map.id) != options.maps.end();
    if (options.maps.empty() ? !needs_keyframes || !map.keyframes.empty() : asked) maps.push_back(&map);
  }
  for (const MapId id : options.maps)
    if (std::ranges::find(atlas.maps, id, &Map::id) == atlas.maps.end())
      throw Error(ErrorKind::kNotPossible, Concat("has no ", id));
  if (maps.empty()) throw Error(ErrorKind::kNotPossible, "has no map to move");
  return maps;
}

// ---- JSON

Json JsonOf(const TrajectoryAlignment& alignment) {
  const ResidualStatistics& residuals = alignment.residuals;
  return {{"keyframes", alignment.keyframes},
          {"pairs", alignment.pairs},
          {"inliers", alignment.inliers},
          {"residuals",
           {{"rmse", residuals.rmse}, {"mean", residuals.mean}, {"median", residuals.median}, {"max", residuals.max}}},
          {"largest_residual", alignment.largest_residual},
          {"time_offset", alignment.time_offset}};
}

Json JsonOf(const Up& up) {
  Json json = {{"method", NameOf(up.method)}, {"up", detail::JsonOf(up.direction)}};
  if (up.method == UpMethod::kInertia) json["gravity"] = up.gravity;
  if (up.method == UpMethod::kCameras) json["roll_degrees_rms"] = up.spread;
  if (up.method == UpMethod::kPath) json["distance_to_plane_rms"] = up.off_path;
  return json;
}

Json JsonOf(const MovedMap& moved) {
  Json json = {{"id", detail::JsonId(moved.map)}, {"target_from_source", detail::JsonOf(moved.target_from_source)}};
  if (moved.alignment) json["alignment"] = JsonOf(*moved.alignment);
  if (moved.up) json["upright"] = JsonOf(*moved.up);
  json["warnings"] = moved.warnings;
  json["losses"] = moved.losses;
  return json;
}

}  // namespace

TransformReport TransformAtlas(Atlas& atlas, const TransformOptions& options) {
  const Finder finder(options.to);
  const std::vector<Map*> maps = MapsToMove(atlas, options, finder.needs_keyframes());
  TransformReport report{.origin = finder.origin()};
  for (const Map* map : maps) report.maps.push_back(finder.Find(*map));
  detail::Steps steps(options.progress, "moving maps", maps.size());
  for (std::size_t i = 0; i < maps.size(); ++i) {
    TransformMap(*maps[i], report.maps[i].target_from_source, options.threads);
    steps.Next();
  }
  return report;
}

std::string ToJson(const TransformReport& report, const ReportFiles& files) {
  Json json = detail::ReportHead("transform", files);
  json["maps"] = Json::array();
  for (const MovedMap& moved : report.maps) json["maps"].push_back(JsonOf(moved));
  if (report.origin)
    json["georeference"] = {{"ellipsoid", "WGS84"},
                            {"axes", "east, north, up"},
                            {"latitude", report.origin->latitude},
                            {"longitude", report.origin->longitude},
                            {"altitude", report.origin->altitude}};
  return detail::JsonText(json);
}

void TellWarnings(const TransformReport& report, Notices& notices) {
  for (const MovedMap& moved : report.maps) {
    for (const std::string& warning : moved.warnings) notices.Warn(ToString(moved.map) + ": " + warning);
    for (const std::string& loss : moved.losses) notices.Lose(ToString(moved.map) + ": " + loss);
  }
}

}  // namespace slamdb
