// SPDX-License-Identifier: BSD-3-Clause
// Landmarks of a file onto the atlas that they were made of.
#include <algorithm>
#include <optional>
#include <unordered_map>
#include <unordered_set>

#include "slamdb/edit/landmarks/detail/points.h"
#include "slamdb/edit/landmarks/landmarks.h"
#include "slamdb/model/counters.h"
#include "slamdb/model/index.h"

namespace slamdb {
namespace {

// Where an id stands in an atlas: the point, the landmark, or both, of one map.
struct Spot {
  std::size_t map = 0;
  std::optional<std::size_t> point, landmark;  // rows
  bool several = false;                        // another map has the id, too
};

class Layer {
 public:
  Layer(Atlas& atlas, const Atlas& landmarks, const LayLandmarksOptions& options)
      : atlas_(atlas), landmarks_(landmarks), options_(options) {}

  LayLandmarksReport Run() {
    FindSpots();
    const std::unordered_set<std::uint64_t> repeated = IdsOfSeveralMaps();
    for (const Map& map : landmarks_.maps) {
      std::vector<Landmark> one_of_each;
      TakeLandmarks(one_of_each, map.landmarks);
      LayMap(std::move(one_of_each), repeated);
    }
    for (const auto& [id, spot] : spots_) report_.without += spot.point && !laid_.contains(id);
    RaiseCounters(atlas_);
    return std::move(report_);
  }

 private:
  Spot& SpotOf(std::uint64_t id, std::size_t map) {
    Spot& spot = spots_.try_emplace(id, Spot{.map = map}).first->second;
    spot.several |= spot.map != map;
    return spot;
  }

  void FindSpots() {
    for (std::size_t m = 0; m < atlas_.maps.size(); ++m) {
      const Map& map = atlas_.maps[m];
      for (std::size_t row = 0; row < map.points.size(); ++row) SpotOf(map.points[row].id.value(), m).point = row;
      for (std::size_t row = 0; row < map.landmarks.size(); ++row)
        if (map.landmarks[row].is_numbered()) SpotOf(map.landmarks[row].id.value(), m).landmark = row;
      for (const KeyFrame& keyframe : map.keyframes) times_.emplace(keyframe.id, keyframe.timestamp);
    }
  }

  // Each map of an MRPT stream may count its landmarks from 0.
  std::unordered_set<std::uint64_t> IdsOfSeveralMaps() const {
    std::unordered_map<std::uint64_t, const Map*> owners;
    std::unordered_set<std::uint64_t> repeated;
    for (const Map& map : landmarks_.maps)
      for (const Landmark& landmark : map.landmarks)
        if (landmark.is_numbered() && owners.emplace(landmark.id.value(), &map).first->second != &map)
          repeated.insert(landmark.id.value());
    return repeated;
  }

  Spot* Find(const Landmark& landmark) {
    const auto found = landmark.is_numbered() ? spots_.find(landmark.id.value()) : spots_.end();
    return found == spots_.end() ? nullptr : &found->second;
  }

  void LayMap(std::vector<Landmark> landmarks, const std::unordered_set<std::uint64_t>& repeated) {
    const detail::Turning turning = detail::TurnNormals(landmarks, [&](const Landmark& landmark) {
      const Spot* spot = Find(landmark);
      return spot == nullptr || !spot->point ? nullptr : &atlas_.maps[spot->map].points[*spot->point];
    });
    report_.turned += turning.turned;
    report_.unturned += turning.unturned;
    std::size_t home = 0;  // the map of the one before: new ones go there
    for (const Landmark& landmark : landmarks) {
      Spot* spot = Find(landmark);
      if (!landmark.mean.allFinite() || !landmark.normal.allFinite()) {
        report_.infinite.push_back(landmark.id);
      } else if ((spot != nullptr && spot->several) || repeated.contains(landmark.id.value())) {
        report_.ambiguous.push_back(landmark.id);
      } else if (spot == nullptr) {
        AddNew(landmark, home);
      } else {
        home = spot->map;
        Lay(landmark, *spot);
      }
    }
  }

  void Lay(const Landmark& landmark, Spot& spot) {
    Map& map = atlas_.maps[spot.map];
    laid_.insert(landmark.id.value());
    if (spot.point) {
      MapPoint& point = map.points[*spot.point];
      const Eigen::Vector3f position = point.position, normal = point.normal;
      detail::MoveTo(landmark, point);
      ++report_.moved;
      report_.same += point.position == position && point.normal == normal;
      report_.counts += !SaysWhatObservationsSay(landmark, point);
    }
    if (!spot.landmark) {
      spot.landmark = map.landmarks.size();
      map.landmarks.emplace_back();
    }
    map.landmarks[*spot.landmark] = landmark;
    ++report_.taken;
  }

  bool SaysWhatObservationsSay(const Landmark& landmark, const MapPoint& point) const {
    std::uint64_t newest = 0;
    for (const Observation& observation : point.observations)
      if (const auto found = times_.find(observation.keyframe); found != times_.end())
        newest = std::max(newest, TicksOfSeconds(found->second));
    return landmark.seen_count == point.observations.size() && landmark.last_seen == newest;
  }

  void AddNew(Landmark landmark, std::size_t home) {
    if (!options_.add || !landmark.is_numbered() || home >= atlas_.maps.size()) {
      report_.not_there.push_back(landmark.id);
      return;
    }
    Map& map = atlas_.maps[home];
    map.points.push_back(detail::PointOf(landmark, MapPointId(landmark.id.value())));
    map.landmarks.push_back(std::move(landmark));
    ++report_.added;
    ++report_.taken;
  }

  Atlas& atlas_;
  const Atlas& landmarks_;
  const LayLandmarksOptions& options_;
  std::unordered_map<std::uint64_t, Spot> spots_;
  std::unordered_map<KeyFrameId, double> times_;
  std::unordered_set<std::uint64_t> laid_;
  LayLandmarksReport report_;
};

}  // namespace

LayLandmarksReport LayLandmarks(Atlas& atlas, const Atlas& landmarks, const LayLandmarksOptions& options) {
  return Layer(atlas, landmarks, options).Run();
}

}  // namespace slamdb
