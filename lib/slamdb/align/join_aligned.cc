// SPDX-License-Identifier: BSD-3-Clause
// 1. All maps are aligned.
// 2. Of each group the map whose frame says most is the root: upright, metric, or else the first.
// 3. The others are joined into it in an order in which each is linked to one that is there already.
#include "slamdb/align/join_aligned.h"

#include <algorithm>

#include "slamdb/align/detail/strongest_pairs.h"
#include "slamdb/model/statistics.h"

namespace slamdb {
namespace {

// How a map that is to be joined lies to one that is there.
struct Tie {
  const MapLink* link;
  bool turned;  // the map that is there is the link's second
};

// A map that goes into the root of its group.
struct Step {
  std::size_t root, map;  // rows of the list of maps
  std::vector<Tie> ties;  // the one that joins it first, then those that close cycles
};

std::vector<KeyFramePair> MergeEdges(const Step& step) {
  std::vector<KeyFramePair> edges;
  for (const auto& [link, turned] : step.ties)
    for (const AlignedPair& pair : detail::StrongestPairs(link->alignment.pairs))
      edges.push_back(turned ? KeyFramePair{pair.second, pair.first} : KeyFramePair{pair.first, pair.second});
  return edges;
}

// The surest first; points of the map that is there already survive.
std::vector<std::pair<MapPointId, MapPointId>> SamePoints(const Step& step) {
  std::vector<MatchedPoints> matches;
  for (const auto& [link, turned] : step.ties)
    for (MatchedPoints match : link->alignment.matches) {
      if (turned) std::swap(match.first, match.second);
      matches.push_back(match);
    }
  return detail::SurestFirst(std::move(matches));
}

// Of the first map whose frame says most: which way is up, or else how long a metre is.
std::size_t RootOf(const std::vector<std::size_t>& members, const Atlas& atlas, const std::vector<MapRef>& maps) {
  return *std::ranges::max_element(members, {}, [&](std::size_t member) {
    const Map& map = atlas.maps[maps[member].map];
    return map.imu_initialized ? 2 : (IsMetric(map) ? 1 : 0);
  });
}

std::vector<Step> StepsOf(const Atlas& atlas, const AlignedMaps& aligned, const std::vector<MapRef>& maps) {
  std::vector<Step> steps;
  std::vector<bool> there(maps.size(), false);
  for (std::size_t group = 0; group < maps.size(); ++group) {
    std::vector<std::size_t> members;
    for (std::size_t map = 0; map < maps.size(); ++map)
      if (aligned.places[map].group == group) members.push_back(map);
    if (members.size() < 2) continue;
    const std::size_t root = RootOf(members, atlas, maps);
    there[root] = true;
    for (std::size_t joined = 1; joined < members.size(); ++joined) {
      const auto next = std::ranges::find_if(aligned.links, [&](const MapLink& link) {
        return link.use == LinkUse::kJoins && aligned.places[link.first].group == group &&
               there[link.first] != there[link.second];
      });
      const std::size_t map = there[next->second] ? next->first : next->second;
      Step step{.root = root, .map = map, .ties = {{&*next, there[next->second]}}};
      for (const MapLink& link : aligned.links)
        if (link.use == LinkUse::kCloses &&
            ((link.first == map && there[link.second]) || (link.second == map && there[link.first])))
          step.ties.push_back({&link, there[link.second]});
      steps.push_back(std::move(step));
      there[map] = true;
    }
  }
  return steps;
}

JoinOptions OptionsOf(const Step& step, const JoinAlignedReport& report, const JoinAlignedOptions& options) {
  const std::vector<MapPlace>& places = report.aligned.places;
  JoinOptions join{.first = report.maps[step.root],
                   .second = report.maps[step.map],
                   .first_from_second = places[step.root].group_from_map.Inverse() * places[step.map].group_from_map};
  join.merge_edges = MergeEdges(step);
  join.anchors = {join.merge_edges.front()};
  join.fuse = options.fuse;
  if (join.fuse) join.fuse->known = SamePoints(step);
  join.threads = options.threads;
  join.progress = options.progress;
  return join;
}

}  // namespace

JoinAlignedReport JoinAlignedMaps(Atlas& atlas, const AlignOptions& align, const JoinAlignedOptions& options) {
  std::vector<MapRef> maps;
  JoinAlignedReport report;
  for (std::size_t row = 0; row < atlas.maps.size(); ++row)
    if (!atlas.maps[row].keyframes.empty()) {
      maps.push_back({&atlas, row});
      report.maps.push_back(atlas.maps[row].id);
      std::vector<KeyFrameId>& keyframes = report.keyframes.emplace_back();
      for (const KeyFrame& keyframe : atlas.maps[row].keyframes) keyframes.push_back(keyframe.id);
    }
  report.aligned = AlignAllMaps(maps, align);
  const std::vector<Step> steps = StepsOf(atlas, report.aligned, maps);
  for (const Step& step : steps) report.joins.push_back(JoinMaps(atlas, OptionsOf(step, report, options)));
  for (std::size_t map = 0; map < maps.size(); ++map) {
    const std::size_t group = report.aligned.places[map].group;
    if (std::ranges::count(report.aligned.places, group, &MapPlace::group) == 1)
      report.apart.push_back(report.maps[map]);
  }
  return report;
}

}  // namespace slamdb
