// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/rtabmap/detail/assemble.h"

#include <algorithm>
#include <map>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/detail/select.h"
#include "slamdb/formats/import/detail/complete.h"
#include "slamdb/formats/import/detail/loops.h"
#include "slamdb/formats/import/detail/pinhole_cameras.h"
#include "slamdb/formats/import/detail/possible.h"

namespace slamdb::rtabmap {
namespace {

using detail::Concat;
using detail::Counted;

// In the frame of the graph where RTAB-Map optimised it; else in that of odometry.
struct PlacedNode {
  const Node* node;
  Pose world_from_base;
  std::uint32_t map;
};

struct Placement {
  std::vector<PlacedNode> nodes;
  std::vector<std::uint32_t> map_ids;
  std::uint64_t optimized = 0, corrected = 0, by_odometry = 0, without_pose = 0;
};

// Odometry drifts, and an optimised neighbour tells by how much: the one before it, else the one behind.
std::vector<std::optional<Pose>> Corrections(const std::vector<Node>& nodes) {
  std::vector<std::optional<Pose>> corrections(nodes.size());
  std::map<std::uint32_t, Pose> last;
  const auto visit = [&](std::size_t row) {
    const Node& node = nodes[row];
    if (node.optimized && node.odometry) last[node.session] = *node.optimized * node.odometry->inverse();
    const auto found = last.find(node.session);
    if (!corrections[row] && found != last.end()) corrections[row] = found->second;
  };
  for (std::size_t row = 0; row < nodes.size(); ++row) visit(row);
  last.clear();
  for (std::size_t row = nodes.size(); row-- > 0;) visit(row);
  return corrections;
}

Placement PlaceNodes(const Graph& graph) {
  Placement placement;
  std::map<std::uint32_t, std::uint32_t> map_of_session;  // of those that are not optimised
  std::optional<std::uint32_t> map_of_graph;
  const std::vector<std::optional<Pose>> corrections = Corrections(graph.nodes);
  for (std::size_t row = 0; row < graph.nodes.size(); ++row) {
    const Node& node = graph.nodes[row];
    if (!node.optimized && !node.odometry) {
      ++placement.without_pose;
      continue;
    }
    const bool in_graph = node.optimized || corrections[row];
    std::uint32_t map = 0;
    if (const auto found = map_of_session.find(node.session); !in_graph && found != map_of_session.end()) {
      map = found->second;
    } else if (in_graph && map_of_graph) {
      map = *map_of_graph;
    } else {
      map = static_cast<std::uint32_t>(placement.map_ids.size());
      placement.map_ids.push_back(node.session);
      if (in_graph)
        map_of_graph = map;
      else
        map_of_session[node.session] = map;
    }
    ++(node.optimized ? placement.optimized : in_graph ? placement.corrected : placement.by_odometry);
    const Pose pose = node.optimized ? *node.optimized : in_graph ? *corrections[row] * *node.odometry : *node.odometry;
    placement.nodes.push_back({&node, pose, map});
  }
  return placement;
}

class Assembler {
 public:
  explicit Assembler(Placement placement) : placement_(std::move(placement)) {}

  // Where some nodes have pictures, those without are no keyframes.
  Shots MakeShots(Atlas& atlas) {
    const bool some = std::ranges::any_of(placement_.nodes, [](const auto& placed) { return HasPicture(placed); });
    std::size_t most = 1;
    for (const PlacedNode& placed : placement_.nodes) most = std::max(most, placed.node->cameras.size());
    Shots shots;
    std::uint64_t highest = 0;
    for (const PlacedNode& placed : placement_.nodes) {
      highest = std::max(highest, placed.node->id);
      if (some && !HasPicture(placed)) {
        ++without_picture_;
        continue;
      }
      for (std::uint32_t camera = 0; camera < std::max<std::size_t>(placed.node->cameras.size(), 1); ++camera)
        shots.list.push_back(MakeShot(placed, camera, most, atlas));
    }
    shots.first_of_node = IdTable(0, highest, shots.list.size());
    for (std::uint32_t row = 0; row < shots.list.size(); ++row)
      if (HasPicture({shots.list[row].node, {}, 0})) shots.first_of_node.Insert(shots.list[row].node->id, row);
    return shots;
  }

  std::uint64_t without_picture() const { return without_picture_; }
  std::uint64_t virtual_baselines() const { return virtual_baselines_; }

 private:
  static bool HasPicture(const PlacedNode& placed) { return !placed.node->cameras.empty(); }

  Shot MakeShot(const PlacedNode& placed, std::uint32_t camera, std::size_t most, Atlas& atlas) {
    const Node& node = *placed.node;
    Shot shot{.node = &node, .camera = camera, .map = placed.map};
    KeyFrame& keyframe = shot.keyframe;
    keyframe.id = KeyFrameId(node.id * most + (most == 1 ? 0 : camera));
    keyframe.frame_id = keyframe.id.value();
    keyframe.timestamp = node.stamp;
    keyframe.origin_map = node.session;
    Pose world_from_camera = placed.world_from_base;
    if (HasPicture(placed)) {
      world_from_camera = world_from_camera * node.cameras[camera].base_from_camera;
      SetCamera(keyframe, node.cameras[camera], atlas);
    }
    const Pose camera_from_world = world_from_camera.inverse();
    keyframe.camera_from_world =
        detail::PoseOf(Eigen::Matrix3d(camera_from_world.linear()), camera_from_world.translation());
    return shot;
  }

  // RTAB-Map takes pictures to be rectified. Depth of a depth camera is that of a stereo camera of 8 cm, since
  // ORB-SLAM3 needs one.
  void SetCamera(KeyFrame& keyframe, const NodeCamera& from, Atlas& atlas) {
    constexpr float kVirtualBaseline = 0.08F;
    detail::SetPinhole(keyframe, from.fx, from.fy, from.cx, from.cy);
    if (from.width > 0 && from.height > 0) keyframe.bounds = detail::BoundsOfImage(from.width, from.height);
    if (from.baseline <= 0) ++virtual_baselines_;
    SetBaseline(keyframe, from.baseline > 0 ? from.baseline : kVirtualBaseline);
    keyframe.camera = cameras_.IdOf({from.fx, from.fy, from.cx, from.cy}, atlas);
  }

  detail::PinholeCameras cameras_;
  Placement placement_;
  std::uint64_t without_picture_ = 0, virtual_baselines_ = 0;
};

struct LinkCounts {
  std::uint64_t closures = 0, between_maps = 0;
};

// Neighbours follow each other in time, loop closures are loop edges: between the same cameras of both nodes.
LinkCounts SetLinks(const Graph& graph, Shots& shots) {
  LinkCounts counts;
  for (const Link& link : graph.links) {
    const std::uint32_t from = shots.first_of_node.Find(link.from), to = shots.first_of_node.Find(link.to);
    if (from == kNoRow || to == kNoRow) continue;
    if (shots.list[from].map != shots.list[to].map) {
      ++counts.between_maps;
      continue;
    }
    counts.closures += link.is_closure() ? 1 : 0;
    const std::size_t cameras = std::min(shots.list[from].node->cameras.size(), shots.list[to].node->cameras.size());
    for (std::size_t camera = 0; camera < cameras; ++camera) {
      KeyFrame& before = shots.list[from + camera].keyframe;
      KeyFrame& behind = shots.list[to + camera].keyframe;
      if (link.is_closure()) {
        detail::AddLoop(before, behind);
      } else if (!before.next && !behind.previous) {
        before.next = behind.id;
        behind.previous = before.id;
      }
    }
  }
  return counts;
}

void TellPoses(const Placement& placement, Notices& notices) {
  if (placement.by_odometry > 0)
    notices.Warn(
        Concat("poses are those of odometry, in which loops are not closed, since the file has no optimised ones "
               "(RTAB-Map saves them when it is closed): ",
               Counted(placement.by_odometry, "node")));
  if (placement.optimized > 0)
    notices.Note(Concat("poses are the optimised ones of RTAB-Map: ", Counted(placement.optimized, "node")));
  if (placement.corrected > 0)
    notices.Note(Concat("poses are those of odometry, moved as RTAB-Map moved their neighbours: ",
                        Counted(placement.corrected, "node")));
}

void TellLosses(const Graph& graph, const FeatureCounts& features, const PointCounts& points, const LinkCounts& links,
                Notices& notices) {
  const auto lose = [&](std::uint64_t count, std::string_view noun, std::string_view what) {
    if (count > 0) notices.Lose(Concat(Counted(count, noun), what));
  };
  lose(graph.lost_nodes, "node", " whose id no node can have, or another one has too: left out");
  lose(graph.links.size(), "link", ": an atlas holds which nodes they join, and not what they measured");
  lose(links.between_maps, "link", " between nodes whose poses are in different frames: left out");
  lose(graph.other_links, "link",
       " that join no two nodes, or none that see the same (priors, landmarks, gravity): left out");
  lose(features.without_node, "feature", " of nodes that are no keyframes, or beyond every picture: left out");
  lose(features.other_descriptors, "descriptor", " of another kind than others of their picture: left out");
  lose(points.words_without_place, "word", " that no feature has depth of: no points");
  lose(points.loose, "feature", " that do not fit to the point of their word: they see none");
  const auto gps = std::ranges::count_if(graph.nodes, [](const Node& node) { return node.gps.has_value(); });
  if (gps > 0)
    notices.Note(
        Concat("the file has GPS fixes, by which `slamdb transform --georeference` lays the atlas onto the "
               "earth: ",
               Counted(static_cast<std::uint64_t>(gps), "node")));
  const auto truth = std::ranges::count_if(graph.nodes, [](const Node& node) { return node.truth.has_value(); });
  if (truth > 0)
    notices.Note(Concat("the file has ground truth, which format `rtabmap-truth` reads: ",
                        Counted(static_cast<std::uint64_t>(truth), "node")));
  if (!graph.nodes.empty())
    notices.Lose("pictures, scans, grids, user data and statistics of the database are left out");
}

}  // namespace

void SetBaseline(KeyFrame& keyframe, float baseline) {
  constexpr float kBaselines = 40;  // beyond them a point is far, as ORB-SLAM3's settings usually say
  keyframe.intrinsics.baseline = baseline;
  keyframe.intrinsics.baseline_fx = baseline * keyframe.intrinsics.fx;
  keyframe.intrinsics.depth_threshold = kBaselines * baseline;
  keyframe.half_baseline = baseline / 2;
}

Atlas ReadAtlas(sqlite::Database& database, const ReadOptions& options, Notices& notices) {
  const Graph graph = ReadGraph(database, options);
  Placement placement = PlaceNodes(graph);
  TellPoses(placement, notices);
  if (placement.without_pose > 0)
    notices.Lose(Concat(Counted(placement.without_pose, "node"), " without a pose: left out"));
  Atlas atlas;
  for (const std::uint32_t id : placement.map_ids) atlas.maps.emplace_back().id = MapId(id);
  Assembler assembler(std::move(placement));
  Shots shots = assembler.MakeShots(atlas);
  if (assembler.without_picture() > 0)
    notices.Lose(
        Concat(Counted(assembler.without_picture(), "node"), " without a picture of a calibrated camera: left out"));
  if (assembler.virtual_baselines() > 0)
    notices.Warn(Concat("the file knows no second camera; what has depth is as a stereo camera of 8 cm would see it: ",
                        Counted(assembler.virtual_baselines(), "keyframe")));
  const FeatureCounts features = ReadFeatures(database, shots, graph.scale_factor, options);
  if (features.by_word > 0)
    notices.Warn(Concat("descriptors are those of words, since the file has none of its features: ",
                        Counted(features.by_word, "feature")));
  const PointCounts points = MakePoints(shots, features.highest_word, atlas.maps);
  const LinkCounts links = SetLinks(graph, shots);
  TellLosses(graph, features, points, links, notices);
  for (Shot& shot : shots.list) atlas.maps[shot.map].keyframes.push_back(std::move(shot.keyframe));
  for (Map& map : atlas.maps) detail::SortLoops(map.keyframes);
  detail::CompleteAtlas(atlas, "RTAB-Map", options.threads, notices);
  detail::Select(options.selection, atlas);
  return atlas;
}

Atlas ReadTruth(sqlite::Database& database, const ReadOptions& options, Notices& notices) {
  const Graph graph = ReadGraph(database, options);
  detail::PoseAtlas atlas;
  std::uint64_t without = 0;
  for (const Node& node : graph.nodes) {
    if (!node.truth) {
      ++without;
      continue;
    }
    Pose pose = *node.truth;
    if (!node.cameras.empty()) pose = pose * node.cameras[0].base_from_camera;
    atlas.Add(node.stamp, Eigen::Quaterniond(pose.linear()), pose.translation());
  }
  if (without > 0) notices.Warn(Concat("no ground truth: ", Counted(without, "node")));
  return atlas.Finish(options);
}

}  // namespace slamdb::rtabmap
