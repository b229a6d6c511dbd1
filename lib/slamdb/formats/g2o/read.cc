// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <optional>
#include <string>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/open_end.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/detail/union_find.h"
#include "slamdb/formats/detail/select.h"
#include "slamdb/formats/g2o/detail/g2o.h"
#include "slamdb/formats/g2o/detail/similarity_log.h"
#include "slamdb/formats/import/detail/loops.h"
#include "slamdb/formats/import/detail/possible.h"
#include "slamdb/model/counters.h"
#include "slamdb/model/detail/camera_in_world.h"
#include "slamdb/model/detail/rounding.h"
#include "slamdb/model/index.h"

namespace slamdb {
namespace {

using detail::Concat;
using detail::Counted;

struct Link {
  std::uint64_t first, second;
};

// What a file says, as far as it is about poses.
struct PoseGraph {
  std::vector<KeyFramePose> poses;  // in the file's order
  std::vector<Link> links;
  std::vector<std::uint64_t> fixed;
  std::uint64_t times = 0;                                     // of poses
  std::map<std::string, std::uint64_t, std::less<>> left_out;  // lines by what they begin with
};

class Parser {
 public:
  explicit Parser(const WholeFile& file) : path_(file.path()), rest_(detail::WithoutMark(file.text())) {}

  PoseGraph Parse() {
    while (!rest_.empty()) {
      line_ = detail::TakeLine(rest_);
      ++number_;
      const std::string_view tag = detail::TakeWord(line_, detail::kBlanks);
      if (tag == "#")
        TakeTime();
      else if (!tag.empty() && tag[0] != '#')
        TakeRecord(tag);
    }
    SetTimes();
    return std::move(graph_);
  }

 private:
  void TakeRecord(std::string_view tag) {
    if (tag == "VERTEX_SE3:QUAT") {
      const KeyFrameId id = TakeNewVertex();
      graph_.poses.push_back({id, 0, TakePose()});
    } else if (tag == "VERTEX_SIM3:EXPMAP") {
      const KeyFrameId id = TakeNewVertex();
      graph_.poses.push_back({id, 0, TakeSimilarity()});
    } else if (tag == "EDGE_SE3:QUAT" || tag == "EDGE_SIM3:EXPMAP") {
      const std::uint64_t first = TakeId(), second = TakeId();
      for (int i = 0; i < 7; ++i) TakeNumber();
      graph_.links.push_back({first, second});
    } else if (tag == "FIX") {
      while (!detail::Trimmed(line_).empty()) graph_.fixed.push_back(TakeId());
    } else {
      ++graph_.left_out[std::string(tag.substr(0, 40))];
    }
  }

  // `# TIME 12 1403636579.76`, which g2o passes by.
  void TakeTime() {
    if (detail::TakeWord(line_, detail::kBlanks) != "TIME") return;
    const auto id = detail::ParseNumber<std::uint64_t>(detail::TakeWord(line_, detail::kBlanks));
    const auto time = detail::ParseNumber<double>(detail::TakeWord(line_, detail::kBlanks));
    if (id && time) times_.emplace(*id, *time);
  }

  void SetTimes() {
    for (std::size_t row = 0; row < graph_.poses.size(); ++row) {
      KeyFramePose& pose = graph_.poses[row];
      const auto time = times_.find(pose.keyframe.value());
      pose.timestamp = time == times_.end() ? static_cast<double>(row) : time->second;
      pose.has_time = time != times_.end();
      graph_.times += time == times_.end() ? 0 : 1;
    }
  }

  [[noreturn]] void Fail(const std::string& problem) const {
    throw Error(ErrorKind::kDamaged, path_, Concat("line ", number_), problem);
  }
  void Require(const std::string& why_not) const {
    if (!why_not.empty()) Fail(why_not);
  }

  std::uint64_t TakeId() {
    const std::string_view word = detail::TakeWord(line_, detail::kBlanks);
    const auto id = detail::ParseNumber<std::uint64_t>(word);
    if (!id || *id == KeyFrameId::kNone) Fail(Concat("expected the id of a vertex, ", detail::Excerpt(word)));
    return *id;
  }
  KeyFrameId TakeNewVertex() {
    const std::uint64_t id = TakeId();
    const auto [vertex, is_new] = vertices_.try_emplace(id, number_);
    if (!is_new) Fail(Concat("vertex ", id, " is in line ", vertex->second, " already"));
    return KeyFrameId(id);
  }
  double TakeNumber() {
    const std::string_view word = detail::TakeWord(line_, detail::kBlanks);
    const auto number = detail::ParseNumber<double>(word);
    if (!number) Fail(Concat("expected a number, ", detail::Excerpt(word)));
    return *number;
  }

  Similarity3d TakePose() {
    Similarity3d pose;
    for (double& value : pose.translation) value = TakeNumber();
    for (double& value : pose.rotation.coeffs()) value = TakeNumber();
    Require(detail::WhyNoPose(pose.rotation, pose.translation));
    pose.rotation.normalize();
    return pose;
  }
  Similarity3d TakeSimilarity() {
    g2o::Vector7d logarithm;
    for (double& value : logarithm) value = TakeNumber();
    const Similarity3d pose = g2o::ExpOf(logarithm);
    Require(detail::WhyNoScale(pose.scale));
    Require(detail::WhyNoPose(pose.rotation, pose.translation));
    return pose;
  }

  std::string path_;
  std::string_view rest_, line_;
  std::size_t number_ = 0;
  PoseGraph graph_;
  std::map<std::uint64_t, double> times_;
  std::map<std::uint64_t, std::size_t> vertices_;  // their lines
};

PoseGraph Parse(const Source& source, Notices& notices) {
  const WholeFile file(source);
  detail::WarnOfOpenEnd(file.text(), file.path(), notices);
  PoseGraph graph = Parser(file).Parse();
  for (const auto& [tag, count] : graph.left_out)
    notices.Warn(Concat("left out: ", detail::Thousands(count), " lines ", tag, ", which are no poses"));
  return graph;
}

class AtlasMaker {
 public:
  explicit AtlasMaker(const PoseGraph& graph) : graph_(graph) {
    std::uint64_t lowest = KeyFrameId::kNone, highest = 0;
    for (const KeyFramePose& pose : graph.poses) {
      lowest = std::min(lowest, pose.keyframe.value());
      highest = std::max(highest, pose.keyframe.value());
    }
    if (graph.poses.empty()) lowest = 0;
    rows_ = IdTable(lowest, highest, graph.poses.size());
    for (std::uint32_t row = 0; row < graph.poses.size(); ++row) rows_.Insert(graph.poses[row].keyframe.value(), row);
  }

  Atlas Make(Notices& notices) {
    Atlas atlas;
    atlas.maps.resize(1);
    AddKeyFrames(AssignMaps(atlas), atlas);
    for (Map& map : atlas.maps) SetEnds(map);
    Connect(atlas);
    for (std::uint64_t id = 0; Map & map : atlas.maps) map.id = MapId(id++);
    RaiseCounters(atlas);
    if (!graph_.links.empty())
      notices.Note(
          "edges between neighbours by id are the way that was gone, all others are loops; measurements and "
          "information of edges have no place in an atlas");
    rounding_.Tell(notices);
    if (dangling_ > 0) notices.Warn(Counted(dangling_, "edge") + " left out, to a vertex that is not there");
    if (graph_.times < graph_.poses.size())
      notices.Warn(Concat("g2o has no times: ", Counted(graph_.poses.size() - graph_.times, "keyframe"),
                          " numbered in the order of the file instead"));
    return atlas;
  }

 private:
  // By row of the poses: which map.
  std::vector<std::uint32_t> AssignMaps(Atlas& atlas) {
    detail::UnionFind components(graph_.poses.size());  // that edges hold together, by row
    for (const Link& link : graph_.links) {
      const std::uint32_t first = rows_.Find(link.first), second = rows_.Find(link.second);
      if (first == kNoRow || second == kNoRow)
        ++dangling_;
      else
        components.Join(first, second);
    }
    std::vector<std::uint32_t> map_of_component(graph_.poses.size(), 0);
    std::vector<std::uint8_t> taken(graph_.poses.size(), 0);
    std::size_t maps = 0;
    for (const std::uint64_t id : graph_.fixed) {
      const std::uint32_t row = rows_.Find(id);
      if (row == kNoRow || std::exchange(taken[components.Root(row)], 1) != 0) continue;
      atlas.maps.resize(std::max(atlas.maps.size(), maps + 1));
      map_of_component[components.Root(row)] = static_cast<std::uint32_t>(maps);
      atlas.maps[maps++].initial_keyframe = KeyFrameId(id);
    }
    std::vector<std::uint32_t> map_of(graph_.poses.size());
    for (std::uint32_t row = 0; row < map_of.size(); ++row) map_of[row] = map_of_component[components.Root(row)];
    return map_of;
  }

  // Each map's by id.
  void AddKeyFrames(const std::vector<std::uint32_t>& map_of, Atlas& atlas) {
    std::vector<std::uint32_t> order(map_of.size());
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::stable_sort(order, {}, [&](std::uint32_t row) { return graph_.poses[row].keyframe; });
    places_.resize(order.size());
    std::vector<std::size_t> sizes(atlas.maps.size());
    for (const std::uint32_t map : map_of) ++sizes[map];
    for (std::size_t map = 0; map < sizes.size(); ++map) atlas.maps[map].keyframes.reserve(sizes[map]);
    for (const std::uint32_t row : order) {
      Column<KeyFrame>& keyframes = atlas.maps[map_of[row]].keyframes;
      places_[row] = {map_of[row], static_cast<std::uint32_t>(keyframes.size())};
      AddKeyFrame(graph_.poses[row], keyframes.emplace_back());
    }
  }

  void AddKeyFrame(const KeyFramePose& pose, KeyFrame& keyframe) {
    keyframe.id = pose.keyframe;
    keyframe.timestamp = pose.timestamp;
    const Eigen::Vector3d& center = pose.world_from_camera.translation;
    keyframe.camera_from_world = detail::CameraFromWorld(pose.world_from_camera.rotation, center);
    rounding_.AddPose(keyframe.camera_from_world, center);
  }

  static void SetEnds(Map& map) {
    if (map.keyframes.empty()) return;
    map.lowest_keyframe = map.keyframes.front().id;
    map.max_keyframe_id = map.keyframes.back().id.value();
    if (!map.initial_keyframe) map.initial_keyframe = map.lowest_keyframe;
    map.first_keyframe = map.lowest_keyframe;
    map.origins = {map.first_keyframe};
  }

  // Edges join what is in one map.
  void Connect(Atlas& atlas) const {
    for (const Link& link : graph_.links) {
      const std::uint32_t one = rows_.Find(std::min(link.first, link.second));
      const std::uint32_t other = rows_.Find(std::max(link.first, link.second));
      if (one == kNoRow || other == kNoRow || one == other) continue;
      Column<KeyFrame>& keyframes = atlas.maps[places_[one].map].keyframes;
      KeyFrame &first = keyframes[places_[one].row], &second = keyframes[places_[other].row];
      if (places_[other].row != places_[one].row + 1) {
        detail::AddLoop(first, second);
      } else if (!second.parent) {
        second.parent = first.id;
        first.children.push_back(second.id);
      }
    }
    for (Map& map : atlas.maps) detail::SortLoops(map.keyframes);
  }

  const PoseGraph& graph_;
  IdTable rows_;                   // of poses
  std::vector<EntityRow> places_;  // by row of the poses
  std::uint64_t dangling_ = 0;
  detail::Rounding rounding_;
};

}  // namespace

bool detail::SniffG2o(const Probe& probe) {
  std::string_view text = probe.head;
  while (!text.empty()) {
    std::string_view line = TakeLine(text);
    const std::string_view tag = TakeWord(line, kBlanks);
    if (tag.empty() || tag[0] == '#') continue;
    return tag.starts_with("VERTEX_") || tag.starts_with("EDGE_") || tag.starts_with("PARAMS_") || tag == "FIX";
  }
  return false;
}

Atlas detail::ReadG2o(const Source& source, const ReadOptions& options, Notices& notices) {
  const PoseGraph graph = Parse(source, notices);
  if (graph.poses.empty() && !graph.left_out.empty())
    throw Error(ErrorKind::kUnsupported, source.path, "",
                "has no vertices of the kinds VERTEX_SE3:QUAT and VERTEX_SIM3:EXPMAP");
  Atlas atlas = AtlasMaker(graph).Make(notices);
  detail::Select(options.selection, atlas);
  return atlas;
}

std::vector<KeyFramePose> detail::ReadG2oPoses(const Source& source, Notices& notices) {
  return Parse(source, notices).poses;
}

}  // namespace slamdb
