// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/merge_aligned.h"

#include <algorithm>

#include "slamdb/align/detail/follow_tightening.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/merge/warnings.h"
#include "slamdb/model/statistics.h"
#include "slamdb/optimize/warnings.h"

namespace slamdb {
namespace {

// What to call the maps with keyframes of the result: by the input that they come from.
std::vector<MapName> NamesOf(const std::vector<std::string>& inputs, const MergeResult& result,
                             const std::vector<std::vector<MapId>>& maps) {
  std::vector<MapName> names;
  std::size_t row = 0;
  for (std::size_t input = 0; input < maps.size(); ++input)
    for (const MapId map : maps[input]) {
      const bool left_out = std::ranges::any_of(result.report.same_maps, [&](const MapTwice& twice) {
        return twice.left_out && twice.input == input && twice.map == map;
      });
      if (left_out) continue;
      if (!result.atlas.maps[row++].keyframes.empty()) names.push_back({inputs[input], map});
    }
  return names;
}

// Aligns the maps of the result and joins those that lie in one frame.
JoinAlignedReport Align(MergeResult& result, const MergeAlignedOptions& options, const std::vector<MapName>& names,
                        Notices& notices) {
  const MergeOptions& merge = options.merge;
  JoinAlignedReport report =
      JoinAlignedMaps(result.atlas,
                      {.own_vocabulary = !result.report.other_vocabularies.empty(),
                       .threads = merge.threads,
                       .progress = merge.progress},
                      {.fuse = options.fuse, .threads = merge.threads, .progress = merge.progress});
  for (const MapId apart : report.apart) {
    const auto row = std::ranges::find(report.maps, apart) - report.maps.begin();
    notices.Warn(NameText(names[static_cast<std::size_t>(row)]) +
                 " stays a map of its own: it is aligned with no other");
  }
  for (const JoinReport& each : report.joins)
    for (const std::string& warning : each.warnings) notices.Warn(warning);
  return report;
}

// None: the joined maps stay as they lie.
std::optional<OptimizeMethod> MethodOf(Tightening tightening) {
  switch (tightening) {
    case Tightening::kUsual:
      return CanOptimize() ? std::optional(OptimizeMethod::kSeam) : std::nullopt;
    case Tightening::kNone:
      return std::nullopt;
    case Tightening::kPoseGraph:
      return OptimizeMethod::kPoseGraph;
    case Tightening::kSeam:
      return OptimizeMethod::kSeam;
    case Tightening::kFull:
      return OptimizeMethod::kFull;
  }
  return std::nullopt;
}

std::vector<OptimizedJoin> Tighten(Atlas& atlas, const JoinAlignedReport& joined, const MergeAlignedOptions& options,
                                   Notices& notices) {
  if (joined.joins.empty()) return {};
  const std::optional<OptimizeMethod> method = MethodOf(options.tightening);
  if (!method && options.tightening == Tightening::kUsual)
    notices.Note("the joined map is not optimised: this slamdb was built without Ceres (libceres-dev)");
  if (!method) return {};
  std::vector<OptimizedJoin> rounds = OptimizeJoined(
      atlas, joined, {.method = *method, .threads = options.merge.threads, .progress = options.merge.progress});
  for (const OptimizedJoin& round : rounds) TellWarnings(round.optimization, "`OptimizeMaps` goes on", notices);
  return rounds;
}

}  // namespace

MergeAlignedResult MergeAligned(std::vector<Atlas> inputs, const MergeAlignedOptions& options, Notices& notices) {
  std::vector<std::vector<MapId>> maps;
  for (const Atlas& atlas : inputs) {
    maps.emplace_back();
    for (const Map& map : atlas.maps) maps.back().push_back(map.id);
  }
  MergeAlignedResult result{.merged = MergeAtlases(std::move(inputs), options.merge)};
  Atlas& atlas = result.merged.atlas;
  MergeReport& report = result.merged.report;
  std::vector<std::string> called = options.merge.names;
  called.resize(maps.size());
  result.names = NamesOf(called, result.merged, maps);
  for (const Map& map : atlas.maps)
    if (!map.keyframes.empty()) result.metric.push_back(IsMetric(map));
  if (result.metric.size() < 2)
    throw Error(ErrorKind::kNotPossible, called.front(), "",
                "there is only one map with keyframes; name another atlas to align it with");
  const bool follow = !report.id_maps.empty();
  const std::vector<MapPointId> points = follow ? detail::SortedPoints(atlas) : std::vector<MapPointId>();
  result.joined = Align(result.merged, options, result.names, notices);
  result.tightened = Tighten(atlas, result.joined, options, notices);
  for (IdMap& ids : report.id_maps)
    for (const JoinReport& join : result.joined.joins) FollowJoin(join, ids);
  if (follow) detail::FollowTightening(result.tightened, points, atlas, report.id_maps);
  if (result.any()) TellWarnings(report, notices);
  return result;
}

std::string ToJson(const MergeAlignedResult& result, const std::string& output) {
  return ToJson(result.merged.report, result.joined, result.tightened, result.names, output);
}

}  // namespace slamdb
