// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <tuple>
#include <unordered_set>

#include "slamdb/formats/rtabmap/detail/keyframes.h"

namespace slamdb::rtabmap {
namespace {

// A feature with a word.
struct Sighting {
  std::uint32_t map;
  std::int32_t word;
  std::uint32_t shot, keypoint;
  Eigen::Vector3f place;  // in the world; not finite: no depth

  bool has_place() const { return place.allFinite(); }
  std::tuple<std::uint32_t, std::int32_t, std::uint32_t, std::uint32_t> order() const {
    return {map, word, shot, keypoint};
  }
};

float MiddleOf(std::vector<float>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

class PointMaker {
 public:
  PointMaker(Shots& shots, std::int32_t highest_word, std::vector<Map>& maps)
      : shots_(shots), maps_(maps), next_id_(static_cast<std::uint64_t>(highest_word) + 1) {}

  PointCounts Run() {
    Collect();
    for (auto begin = sightings_.begin(); begin != sightings_.end();) {
      const auto end = std::find_if(begin, sightings_.end(), [&](const Sighting& sighting) {
        return sighting.map != begin->map || sighting.word != begin->word;
      });
      MakeOfWord({begin, end});
      begin = end;
    }
    return counts_;
  }

 private:
  using Group = std::span<Sighting>;

  void Collect() {
    for (std::uint32_t row = 0; row < shots_.list.size(); ++row) {
      const Shot& shot = shots_.list[row];
      const Rigid3f world_from_camera = shot.keyframe.camera_from_world.Normalized().Inverse();
      for (std::uint32_t keypoint = 0; keypoint < shot.words.size(); ++keypoint)
        if (shot.words[keypoint] > 0)
          sightings_.push_back(
              {shot.map, shot.words[keypoint], row, keypoint, world_from_camera * shot.places[keypoint]});
    }
    std::ranges::sort(sightings_, {}, &Sighting::order);
  }

  // Places that look alike share a word; a hostile file has more of them than anyone wants to look at.
  void MakeOfWord(Group group) {
    constexpr int kMostPoints = 8;
    bool some = false;
    for (int i = 0; i < kMostPoints && !group.empty(); ++i) {
      const auto candidate = CandidateOf(group);
      if (!candidate) break;
      some = true;
      const auto others = std::stable_partition(group.begin(), group.end(),
                                                [&](const Sighting& sighting) { return Agrees(sighting, *candidate); });
      const Group seen(group.begin(), others);
      if (std::ranges::none_of(seen, &Sighting::has_place)) break;
      AddPoint(seen);
      group = Group(others, group.end());
    }
    if (!some) ++counts_.words_without_place;
    counts_.loose += group.size();
  }

  // The median of the places, or the first of them when nothing is seen there.
  std::optional<Eigen::Vector3f> CandidateOf(Group group) const {
    const auto first = std::ranges::find_if(group, [](const Sighting& sighting) { return sighting.has_place(); });
    if (first == group.end()) return std::nullopt;
    const Eigen::Vector3f median = MedianOf(group);
    for (const Sighting& sighting : group)
      if (sighting.has_place() && Agrees(sighting, median)) return median;
    return first->place;
  }

  static Eigen::Vector3f MedianOf(Group group) {
    Eigen::Vector3f median;
    std::vector<float> values;
    for (int axis = 0; axis < 3; ++axis) {
      values.clear();
      for (const Sighting& sighting : group)
        if (sighting.has_place()) values.push_back(sighting.place[axis]);
      median[axis] = MiddleOf(values);
    }
    return median;
  }

  // Whether the point would be seen about there, and about that far away.
  bool Agrees(const Sighting& sighting, const Eigen::Vector3f& point) const {
    constexpr float kMostPixels = 5, kMostDepth = 0.2F;  // of an octave, and a share of the depth
    const Shot& shot = shots_.list[sighting.shot];
    const Intrinsics& lens = shot.keyframe.intrinsics;
    const Keypoint& keypoint = shot.keyframe.features.keypoints[sighting.keypoint];
    const Eigen::Vector3f in_camera = shot.keyframe.camera_from_world * point;
    if (!(in_camera.z() > 0)) return false;
    const float x = lens.fx * in_camera.x() / in_camera.z() + lens.cx - keypoint.x,
                y = lens.fy * in_camera.y() / in_camera.z() + lens.cy - keypoint.y;
    const float limit = kMostPixels * shot.keyframe.pyramid.factors[static_cast<std::size_t>(keypoint.octave)];
    if (!(std::hypot(x, y) <= limit)) return false;
    const float depth = shot.places[sighting.keypoint].z();
    return !std::isfinite(depth) || std::abs(depth - in_camera.z()) <= kMostDepth * depth;
  }

  // Of the first picture that has others than ORB's.
  static void SetDescriptor(MapPoint& point, const KeyFrame& keyframe, std::size_t keypoint) {
    if (!keyframe.carried || point.has_other_descriptor()) return;
    const Matrix& all = keyframe.carried->descriptors;
    const std::size_t bytes = all.data.size() / std::max<std::size_t>(1, static_cast<std::size_t>(all.rows));
    Matrix& one = point.carried.Make().descriptors;
    one = {.rows = 1, .columns = all.columns, .type = all.type, .continuous = true, .data = {}};
    const auto begin = all.data.begin() + static_cast<std::ptrdiff_t>(keypoint * bytes);
    one.data.assign(begin, begin + static_cast<std::ptrdiff_t>(bytes));
  }

  // Of each picture the first keypoint.
  void AddPoint(Group seen) {
    MapPoint& point = maps_[seen.front().map].points.emplace_back();
    point.descriptor_form = MatrixForm::kEmpty;
    const std::int32_t word = seen.front().word;
    point.id = MapPointId(used_.insert(word).second ? static_cast<std::uint64_t>(word) : next_id_++);
    point.position = MedianOf(seen);
    std::uint32_t last = kNoRow;
    for (const Sighting& sighting : seen) {
      if (sighting.shot == last) {
        ++counts_.loose;
        continue;
      }
      last = sighting.shot;
      KeyFrame& keyframe = shots_.list[last].keyframe;
      keyframe.features.map_points[sighting.keypoint] = point.id;
      SetDescriptor(point, keyframe, sighting.keypoint);
    }
  }

  Shots& shots_;
  std::vector<Map>& maps_;
  std::vector<Sighting> sightings_;
  std::unordered_set<std::int32_t> used_;  // words whose id is a point's
  std::uint64_t next_id_;
  PointCounts counts_;
};

}  // namespace

PointCounts MakePoints(Shots& shots, std::int32_t highest_word, std::vector<Map>& maps) {
  return PointMaker(shots, highest_word, maps).Run();
}

}  // namespace slamdb::rtabmap
