// SPDX-License-Identifier: BSD-3-Clause
// Rules about observations go through them keyframe by keyframe. They find what a look at one after the other finds, in
// atlases with all that may be wrong with them.
#include <gmock/gmock.h>

#include <algorithm>
#include <map>
#include <random>

#include "slamdb/checks/check.h"
#include "slamdb/model/derive.h"
#include "tests/support/corrupt.h"

namespace slamdb {
namespace {

using Counts = std::map<std::string, std::uint64_t>;

template <class List, class EntityId>
const auto* FirstOf(const List& list, EntityId id) {
  const auto found = std::ranges::find(list, id, [](const auto& entity) { return entity.id; });
  return id && found != list.end() ? &*found : nullptr;
}

MapPointId Held(const Features& features, std::int32_t slot) {
  return static_cast<std::size_t>(slot) < features.map_points.size() ? features.map_points[slot] : MapPointId();
}

void LookAtPoints(const Map& map, Counts& counts) {
  for (const MapPoint& point : map.points) {
    if (point.bad) continue;
    std::int64_t weight = 0;
    for (const Observation& observation : point.observations) {
      const KeyFrame* keyframe = FirstOf(map.keyframes, observation.keyframe);
      if (keyframe == nullptr) continue;
      weight += ObservationWeight(*keyframe, observation);
      const Features& features = keyframe->features;
      const std::int32_t left_end = features.is_fisheye_stereo() ? features.left_count : features.count;
      const bool left = observation.left >= 0 && observation.left < left_end;
      const bool right =
          features.is_fisheye_stereo() && observation.right >= left_end && observation.right < features.count;
      counts["observation-slot"] += left && Held(features, observation.left) != point.id;
      counts["observation-slot"] += right && Held(features, observation.right) != point.id;
    }
    counts["observation-count"] += point.observation_count < weight;
    counts["observation-count-excess"] += point.observation_count > weight;
  }
}

void LookAtSlots(const Map& map, Counts& counts) {
  for (const KeyFrame& keyframe : map.keyframes) {
    if (keyframe.bad) continue;
    for (std::size_t slot = 0; slot < keyframe.features.map_points.size(); ++slot) {
      const MapPoint* point = FirstOf(map.points, keyframe.features.map_points[slot]);
      if (point == nullptr || point->bad) continue;
      const auto seen = std::ranges::find(point->observations, keyframe.id, &Observation::keyframe);
      const auto row = static_cast<std::int64_t>(slot);
      counts["slot-observed"] += seen == point->observations.end() || (seen->left != row && seen->right != row);
    }
  }
}

Counts LookAtEach(const Atlas& atlas) {
  Counts counts;
  for (const Map& map : atlas.maps) {
    LookAtPoints(map, counts);
    LookAtSlots(map, counts);
  }
  std::erase_if(counts, [](const auto& count) { return count.second == 0; });
  return counts;
}

Counts FoundBy(const CheckReport& report) {
  Counts counts;
  for (const RuleResult& result : report.results)
    for (const char* rule : {"observation-slot", "observation-count", "observation-count-excess", "slot-observed"})
      if (result.id == rule) counts[rule] = result.count;
  return counts;
}

class Breaker {
 public:
  explicit Breaker(std::uint32_t seed) : random_(seed) {}

  void Break(Atlas& atlas) {
    Map& map = Any(atlas.maps);
    MapPoint& point = Any(map.points);
    KeyFrame& keyframe = Any(map.keyframes);
    switch (Below(9)) {
      case 0:
        Any(keyframe.features.map_points) = Any(map.points).id;
        break;
      case 1:
        Any(keyframe.features.map_points) = MapPointId();
        break;
      case 2:
        if (!point.observations.empty()) Any(point.observations).left = static_cast<std::int32_t>(Below(100)) - 2;
        break;
      case 3:
        if (!point.observations.empty()) Any(point.observations).right = static_cast<std::int32_t>(Below(200)) - 2;
        break;
      case 4:
        point.observations.push_back({keyframe.id, static_cast<std::int32_t>(Below(80)), -1});
        break;
      case 5:
        point.observation_count += static_cast<std::int32_t>(Below(5)) - 2;
        break;
      case 6:
        point.bad = true;
        break;
      case 7:
        if (Below(20) == 0) point.id = Any(map.points).id;
        break;
      default:
        if (Below(20) == 0) keyframe.id = Any(map.keyframes).id;
    }
  }

 private:
  std::size_t Below(std::size_t end) { return random_() % end; }
  template <class List>
  typename List::value_type& Any(List& list) {
    return list[Below(list.size())];
  }

  std::mt19937 random_;
};

TEST(RulesOfObservations, FindWhatALookAtEachFinds) {
  for (const Base base : {Base::kMonocular, Base::kRgbd, Base::kFisheyeStereo, Base::kTwoMaps})
    for (std::uint32_t seed = 0; seed < 40; ++seed) {
      Atlas atlas = SoundAtlas(base);
      Breaker breaker(seed);
      for (std::uint32_t change = 0; change < 3 * seed; ++change) breaker.Break(atlas);
      ASSERT_EQ(FoundBy(CheckAtlas(atlas, {})), LookAtEach(atlas)) << static_cast<int>(base) << " " << seed;
    }
}

}  // namespace
}  // namespace slamdb
