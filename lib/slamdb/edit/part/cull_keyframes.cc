// SPDX-License-Identifier: BSD-3-Clause
// After ORB-SLAM3's LocalMapping::KeyFrameCulling, which looks at the neighbours of each new keyframe; at rest, every
// keyframe is looked at once.
#include "slamdb/edit/part/detail/cull_keyframes.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "slamdb/model/derive.h"

namespace slamdb::detail {
namespace {

// When maps with IMU may lose a keyframe.
constexpr std::size_t kKeyFramesOfWindow = 21;             // the newest ones, which inertial optimisation works on
constexpr double kLongestGap = 3, kLongestGapOfNew = 0.5;  // seconds
constexpr float kStandingStill = 0.02F;                    // metres

constexpr std::size_t kFetchedAhead = 8;  // points

class KeyFrameCulling {
 public:
  KeyFrameCulling(const AtlasIndex& index, std::size_t map_row, const RedundancyRule& rule, Subset::MapRows& rows)
      : index_(index), map_row_(map_row), map_(index.atlas().maps[map_row]), rule_(rule), rows_(rows) {}

  std::uint64_t Run() {
    CountObservations();
    if (map_.inertial) LinkInTime();
    std::vector<std::uint32_t> by_id(map_.keyframes.size());
    std::iota(by_id.begin(), by_id.end(), 0U);
    std::ranges::stable_sort(by_id, {}, [&](std::uint32_t row) { return map_.keyframes[row].id; });
    if (!by_id.empty()) FindWindow(by_id.back());
    std::uint64_t culled = 0;
    for (const std::uint32_t row : by_id) {
      if (!rows_.keyframes[row] || !MayGo(row) || !IsRedundant(row)) continue;
      Remove(row);
      ++culled;
    }
    return culled;
  }

 private:
  // What an observation names lies all over memory: it is fetched while points before it are counted.
  void CountObservations() {
    weights_.assign(map_.points.size(), 0);
    begins_.push_back(0);
    for (std::size_t row = 0; row < map_.points.size(); ++row) {
      if (row + kFetchedAhead < map_.points.size()) Fetch(map_.points[row + kFetchedAhead]);
      for (const Observation& observation : map_.points[row].observations) {
        const std::uint32_t observer = index_.KeyFrameRow(map_row_, observation.keyframe);
        if (observer == kNoRow) continue;
        const KeyFrame& keyframe = map_.keyframes[observer];
        weights_[row] += ObservationWeight(keyframe, observation);
        seers_.push_back({observer, FinestOctave(keyframe, observation)});
      }
      begins_.push_back(seers_.size());
    }
  }

  void Fetch(const MapPoint& point) const {
    for (const Observation& observation : point.observations)
      if (const KeyFrame* keyframe = index_.FindKeyFrame(map_row_, observation.keyframe); keyframe != nullptr)
        for (const std::int32_t row : {observation.left, observation.right})
          if (const Keypoint* keypoint = ObservedKeypoint(*keyframe, row); keypoint != nullptr)
            __builtin_prefetch(&keypoint->octave);
  }

  void LinkInTime() {
    for (const KeyFrame& keyframe : map_.keyframes) {
      previous_.push_back(index_.KeyFrameRow(map_row_, keyframe.previous));
      next_.push_back(index_.KeyFrameRow(map_row_, keyframe.next));
    }
  }

  void FindWindow(std::uint32_t newest) {
    newest_ = map_.keyframes[newest].id;
    std::uint32_t row = newest;
    for (std::size_t step = 0; map_.inertial && step < kKeyFramesOfWindow && previous_[row] != kNoRow; ++step)
      row = previous_[row];
    window_begin_ = map_.keyframes[row].id;
  }

  bool MayGo(std::uint32_t row) const {
    const KeyFrame& keyframe = map_.keyframes[row];
    if (keyframe.id == map_.first_keyframe || keyframe.id == map_.initial_keyframe) return false;
    if (keyframe.bad || keyframe.not_erase) return false;
    return !map_.inertial || MayGapGrow(row);
  }

  bool MayGapGrow(std::uint32_t row) const {
    const KeyFrame& keyframe = map_.keyframes[row];
    if (map_.keyframes.size() <= kKeyFramesOfWindow || keyframe.id.value() + 2 > newest_.value()) return false;
    if (previous_[row] == kNoRow || next_[row] == kNoRow) return false;
    const KeyFrame &before = map_.keyframes[previous_[row]], &after = map_.keyframes[next_[row]];
    const double gap = after.timestamp - before.timestamp;
    if (gap < kLongestGapOfNew) return true;
    if (!(gap < kLongestGap)) return false;
    if (map_.imu_initialized && keyframe.id < window_begin_) return true;
    return !map_.imu_ba2 && (keyframe.body_position - before.body_position).norm() < kStandingStill;
  }

  bool IsRedundant(std::uint32_t row) const {
    const KeyFrame& keyframe = map_.keyframes[row];
    std::size_t points = 0, redundant = 0;
    const Features& features = keyframe.features;
    for (std::size_t slot = 0; slot < features.map_points.size(); ++slot) {
      const std::uint32_t point = index_.PointRow(map_row_, features.map_points[slot]);
      if (point == kNoRow || !rows_.points[point] || !IsClose(keyframe, slot)) continue;
      ++points;
      if (IsSeenByOthers(point, row, static_cast<std::int32_t>(slot))) ++redundant;
    }
    return points > 0 && static_cast<double>(redundant) > rule_.share * static_cast<double>(points);
  }

  // ORB-SLAM3 looks the depth of right fisheye features up beyond the end of the column; they count here.
  bool IsClose(const KeyFrame& keyframe, std::size_t slot) const {
    const Column<float>& depth = keyframe.features.depth;
    if (!rule_.depth_counts || keyframe.features.is_fisheye_stereo() || slot >= depth.size()) return true;
    return depth[slot] >= 0 && depth[slot] <= keyframe.intrinsics.depth_threshold;
  }

  bool IsSeenByOthers(std::uint32_t point, std::uint32_t row, std::int32_t slot) const {
    const std::int32_t coarsest = OctaveOf(map_.keyframes[row], slot) + 1;
    int others = 0;
    for (std::size_t i = begins_[point]; i < begins_[point + 1]; ++i) {
      const Seer& other = seers_[i];
      if (!rows_.keyframes[other.keyframe] || other.keyframe == row || other.octave > coarsest) continue;
      if (++others >= rule_.observers) return true;
    }
    return false;
  }

  static std::int32_t OctaveOf(const KeyFrame& keyframe, std::int32_t row) {
    const Keypoint* keypoint = ObservedKeypoint(keyframe, row);
    return keypoint == nullptr ? std::numeric_limits<std::int32_t>::max() - 1 : keypoint->octave;
  }
  static std::int32_t FinestOctave(const KeyFrame& keyframe, const Observation& observation) {
    return std::min(OctaveOf(keyframe, observation.left), OctaveOf(keyframe, observation.right));
  }

  void Remove(std::uint32_t row) {
    const KeyFrame& keyframe = map_.keyframes[row];
    rows_.keyframes[row] = 0;
    const Column<MapPointId>& slots = keyframe.features.map_points;
    for (std::size_t slot = 0; slot < slots.size(); ++slot) {
      const std::uint32_t point = index_.PointRow(map_row_, slots[slot]);
      if (point == kNoRow || !rows_.points[point]) continue;
      const auto& observations = map_.points[point].observations;
      const auto own = std::ranges::find(observations, keyframe.id, &Observation::keyframe);
      // Once for each observation: its point may be in two slots.
      if (own == observations.end() || (own->left >= 0 ? own->left : own->right) != static_cast<std::int32_t>(slot))
        continue;
      weights_[point] -= ObservationWeight(keyframe, *own);
      if (weights_[point] <= kCulledAt) rows_.points[point] = 0;
    }
    if (!map_.inertial) return;
    if (previous_[row] != kNoRow) next_[previous_[row]] = next_[row];
    if (next_[row] != kNoRow) previous_[next_[row]] = previous_[row];
  }

  // Of a point: row of a keyframe, and the finest octave at which it sees the point.
  struct Seer {
    std::uint32_t keyframe;
    std::int32_t octave;
  };

  const AtlasIndex& index_;
  const std::size_t map_row_;
  const Map& map_;
  const RedundancyRule& rule_;
  Subset::MapRows& rows_;
  std::vector<std::int32_t> weights_;  // observations of each point by keyframes that stay
  std::vector<std::size_t> begins_;    // by point: of its seers
  std::vector<Seer> seers_;
  std::vector<std::uint32_t> previous_, next_;  // rows in time, in maps with IMU
  KeyFrameId newest_, window_begin_;
};

}  // namespace

std::uint64_t CullKeyFrames(const AtlasIndex& index, std::size_t map_row, const RedundancyRule& rule,
                            Subset::MapRows& rows) {
  return KeyFrameCulling(index, map_row, rule, rows).Run();
}

}  // namespace slamdb::detail
