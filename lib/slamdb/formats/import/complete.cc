// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/import/detail/complete.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <vector>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/formats/import/detail/completed.h"
#include "slamdb/model/counters.h"
#include "slamdb/model/detail/covisibility.h"
#include "slamdb/model/detail/spanning_tree.h"

namespace slamdb::detail {
namespace {

constexpr std::size_t kKeyFrameGrain = 16;

void CompleteGraph(Map& map, Completed& completed) {
  const auto connected = [](const KeyFrame& keyframe) { return !keyframe.connections.empty(); };
  if (!std::ranges::any_of(map.keyframes, connected)) {
    std::vector<std::uint32_t> rows(map.keyframes.size());
    std::iota(rows.begin(), rows.end(), 0U);
    UpdateCovisibility(map, rows);
    for (const KeyFrame& keyframe : map.keyframes) completed.connections += keyframe.connections.size();
  }
  map.first_keyframe = RootOf(map);
  completed.parents += AdoptOrphans(map);
  for (KeyFrame& keyframe : map.keyframes) {
    keyframe.first_connection = keyframe.id == map.first_keyframe;
    if (!keyframe.loop_edges.empty() || !keyframe.merge_edges.empty()) keyframe.not_erase = true;
  }
}

void CompleteMap(Map& map, int threads, Completed& completed) {
  ParallelFor(map.keyframes.size(), kKeyFrameGrain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) CompleteFeatures(map.keyframes[row], completed);
  });
  CompletePoints(map, threads, completed);
  CompleteGraph(map, completed);
  CompleteIds(map);
}

// `derived, since RTAB-Map keeps none: 1,204 observations, covisibility; bags of words stay empty`
std::string Sentence(const Completed& completed, std::string_view program, bool lacks_words) {
  std::string derived;
  const auto add = [&](std::uint64_t count, std::string_view what) {
    if (count > 0) derived.append(derived.empty() ? "" : ", ").append(what);
  };
  add(completed.observations, "observations of points");
  add(completed.slots, "points of keypoints");
  add(completed.descriptors, "descriptors of points");
  add(completed.normals, "normals");
  add(completed.ranges, "distance ranges");
  add(completed.references, "reference keyframes");
  add(completed.connections, "covisibility");
  add(completed.parents, "parents in the spanning tree");
  add(completed.grids, "grids");
  if (derived.empty()) return {};
  std::string sentence = Concat("derived, since ", program, " keeps none: ", derived);
  if (lacks_words) sentence += "; bags of words stay empty until `RecomputeWords` makes them";
  return sentence;
}

bool LacksWords(const Atlas& atlas) {
  return std::ranges::any_of(atlas.maps, [](const Map& map) {
    return std::ranges::any_of(map.keyframes, [](const KeyFrame& keyframe) {
      return !keyframe.features.descriptors.empty() && keyframe.features.bag_of_words.words.empty();
    });
  });
}

}  // namespace

KeyFrameId RootOf(const Map& map) {
  if (map.first_keyframe) return map.first_keyframe;
  KeyFrameId lowest, root;
  for (const KeyFrame& keyframe : map.keyframes) {
    if (keyframe.bad) continue;
    lowest = std::min(lowest, keyframe.id);
    if (!keyframe.parent) root = std::min(root, keyframe.id);
  }
  return root ? root : lowest;
}

void CompleteIds(Map& map) {
  if (!map.initial_keyframe) map.initial_keyframe = map.first_keyframe;
  if (map.origins.empty() && map.first_keyframe) map.origins.push_back(map.first_keyframe);
  for (const KeyFrame& keyframe : map.keyframes) {
    if (!keyframe.bad) map.lowest_keyframe = std::min(map.lowest_keyframe, keyframe.id);
    if (keyframe.id) map.max_keyframe_id = std::max(map.max_keyframe_id, keyframe.id.value());
  }
}

void CompleteAtlas(Atlas& atlas, std::string_view program, int threads, Notices& notices) {
  Completed completed;
  for (Map& map : atlas.maps) CompleteMap(map, threads, completed);
  RaiseCounters(atlas);
  if (completed.freed > 0)
    notices.Warn("further keypoints of a picture that are the same point see none now: " +
                 Counted(completed.freed, "keypoint"));
  const std::string sentence = Sentence(completed, program, LacksWords(atlas));
  if (!sentence.empty()) notices.Note(sentence);
}

}  // namespace slamdb::detail
