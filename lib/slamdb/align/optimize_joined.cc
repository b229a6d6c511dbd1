// SPDX-License-Identifier: BSD-3-Clause
// 1. The map is bent to how the verified pairs of keyframes lie.
// 2. Pictures are searched for points of the other sessions.
// 3. The bundle is adjusted; of all, steps 2 and 3 once more.
#include "slamdb/align/optimize_joined.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "slamdb/align/detail/find_across.h"
#include "slamdb/align/detail/strongest_pairs.h"
#include "slamdb/edit/merge/observe.h"
#include "slamdb/model/index.h"
#include "slamdb/optimize/detail/require_ceres.h"

namespace slamdb {
namespace {

constexpr std::size_t kFullRounds = 2;
constexpr std::size_t kMostConstraints = 20;  // of a link

// A map that others were joined into.
class Joined {
 public:
  Joined(Atlas& atlas, const JoinAlignedReport& report, MapId map, const OptimizeJoinedOptions& options)
      : atlas_(atlas),
        report_(report),
        options_(options),
        id_(map),
        root_(static_cast<std::size_t>(std::ranges::find(report.maps, map) - report.maps.begin())) {}

  std::vector<OptimizedJoin> Run() {
    std::vector<OptimizedJoin> rounds(options_.method == OptimizeMethod::kFull ? kFullRounds : 1);
    rounds.front().optimization.pose_graph = Bend();
    for (OptimizedJoin& round : rounds) {
      round.optimization.map = id_;
      Weld(round);
      if (options_.method != OptimizeMethod::kPoseGraph) round.optimization.bundle = Adjust();
    }
    return rounds;
  }

 private:
  std::size_t Row() const {
    return static_cast<std::size_t>(std::ranges::find(atlas_.maps, id_, &Map::id) - atlas_.maps.begin());
  }

  // Links between maps that are in this one now.
  template <class Visit>
  void VisitLinks(const Visit& visit) const {
    const std::size_t group = report_.aligned.places[root_].group;
    for (const MapLink& link : report_.aligned.links)
      if (link.is_used() && report_.aligned.places[link.first].group == group) visit(link);
  }

  // Lengths of this map per length of one that went into it.
  double ScaleOf(std::size_t map) const {
    const std::vector<MapPlace>& places = report_.aligned.places;
    return places[map].group_from_map.scale / places[root_].group_from_map.scale;
  }

  std::vector<PoseConstraint> Constraints() const {
    std::vector<PoseConstraint> constraints;
    VisitLinks([&](const MapLink& link) {
      for (const AlignedPair& pair : detail::StrongestPairs(link.alignment.pairs, kMostConstraints)) {
        PoseConstraint& constraint = constraints.emplace_back();
        constraint.first = pair.first;
        constraint.second = pair.second;
        constraint.first_from_second = pair.first_from_second;
        constraint.first_from_second.translation *= ScaleOf(link.first);
        constraint.first_from_second.scale *= ScaleOf(link.first) / ScaleOf(link.second);
      }
    });
    return constraints;
  }

  std::vector<KeyFrameId> Seam() const {
    std::vector<KeyFrameId> seam;
    VisitLinks([&](const MapLink& link) {
      for (const AlignedPair& pair : link.alignment.pairs) seam.insert(seam.end(), {pair.first, pair.second});
    });
    return seam;
  }

  PoseGraphReport Bend() {
    PoseGraphOptions graph;
    graph.constraints = Constraints();
    graph.sessions = report_.keyframes;
    graph.threads = options_.threads;
    graph.progress = options_.progress;
    return OptimizePoseGraph(atlas_, id_, graph);
  }

  std::optional<BundleReport> Adjust() {
    OptimizeOptions optimize{
        .method = options_.method, .maps = {id_}, .threads = options_.threads, .progress = options_.progress};
    if (options_.method == OptimizeMethod::kSeam) optimize.seam = Seam();
    return OptimizeMaps(atlas_, optimize).maps.front().bundle;
  }

  // By row of the keyframes: which of the maps each is of.
  std::vector<std::uint32_t> Sessions(const Map& map) const {
    const IdTable rows = KeyFrameTable(map);
    std::vector<std::uint32_t> sessions(map.keyframes.size(), 0);
    for (std::uint32_t session = 0; session < report_.keyframes.size(); ++session)
      for (const KeyFrameId keyframe : report_.keyframes[session])
        if (const std::uint32_t row = rows.Find(keyframe.value()); row != kNoRow) sessions[row] = session;
    return sessions;
  }

  void Weld(OptimizedJoin& round) {
    Map& map = atlas_.maps[Row()];
    detail::Across across;
    {
      const detail::MapViews views(atlas_, Row(), options_.threads);
      across = detail::FindAcross(views, Sessions(map), options_.threads);
    }
    round.observations = AddObservations(map, across.seen);
    round.fused = FusePairs(map, std::move(across.same));
    if (options_.progress) options_.progress("welding", 1);
  }

  Atlas& atlas_;
  const JoinAlignedReport& report_;
  const OptimizeJoinedOptions& options_;
  const MapId id_;
  const std::size_t root_;  // row of the report's maps
};

}  // namespace

std::vector<OptimizedJoin> OptimizeJoined(Atlas& atlas, const JoinAlignedReport& report,
                                          const OptimizeJoinedOptions& options) {
  std::vector<OptimizedJoin> rounds;
  std::vector<MapId> maps;
  for (const JoinReport& join : report.joins)
    if (std::ranges::find(maps, join.first) == maps.end()) maps.push_back(join.first);
  if (!maps.empty()) detail::RequireCeres();
  for (const MapId map : maps) {
    std::ranges::move(Joined(atlas, report, map, options).Run(), std::back_inserter(rounds));
  }
  return rounds;
}

}  // namespace slamdb
