// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/live/culling.h"

#include <algorithm>
#include <limits>

#include "slamdb/live/keyframe.h"
#include "slamdb/live/map.h"
#include "slamdb/live/map_point.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/preintegration.h"

namespace slamdb::live {
namespace {

constexpr float kLeastFoundRatio = 0.25F;
constexpr int kEnoughObservers = 3;  // more than these make a point redundant

int OctaveOf(const KeyFrame& keyframe, int left, int right) {
  int octave = std::numeric_limits<int>::max();
  for (const int row : {left, right})
    if (const Keypoint* keypoint = row < 0 ? nullptr : ObservedKeypoint(keyframe.features(), row); keypoint != nullptr)
      octave = std::min(octave, keypoint->octave);
  return octave;
}

// Whether enough others see the point at most one octave above `octave`.
bool IsSeenElsewhere(MapPoint& point, const KeyFrame& keyframe, int octave) {
  int others = 0;
  for (const auto& [observer, rows] : point.GetObservations()) {
    if (observer == &keyframe) continue;
    if (OctaveOf(*observer, std::get<0>(rows), std::get<1>(rows)) <= octave + 1) ++others;
    if (others > kEnoughObservers) return true;
  }
  return false;
}

bool IsNear(const KeyFrame& keyframe, std::size_t row) {
  const Column<float>& depth = keyframe.features().depth;
  return row >= depth.size() || (depth[row] >= 0 && depth[row] <= keyframe.intrinsics().depth_threshold);
}

// Whether the chain of IMU data may lose the keyframe.
bool MayLeaveChain(KeyFrame& keyframe, const KeyFrame& current, Map& map) {
  constexpr std::size_t kFewest = 21;
  constexpr double kLongGap = 3, kShortGap = 0.5;  // seconds
  constexpr float kStandstill = 0.02F;             // metres
  if (map.KeyFramesInMap() <= kFewest || keyframe.mnId + 2 > current.mnId) return false;
  if (keyframe.mPrevKF == nullptr || keyframe.mNextKF == nullptr) return false;
  const KeyFrame* last = &current;
  for (std::size_t i = 0; i < kFewest && last->mPrevKF != nullptr; ++i) last = last->mPrevKF;
  const double gap = keyframe.mNextKF->mTimeStamp - keyframe.mPrevKF->mTimeStamp;
  if ((map.isImuInitialized() && keyframe.mnId < last->mnId && gap < kLongGap) || gap < kShortGap) return true;
  return !map.GetIniertialBA2() &&
         (keyframe.GetImuPosition() - keyframe.mPrevKF->GetImuPosition()).norm() < kStandstill && gap < kLongGap;
}

void LeaveChain(KeyFrame& keyframe) {
  KeyFrame *previous = keyframe.mPrevKF, *next = keyframe.mNextKF;
  const ImuPreintegration earlier = keyframe.GetImuPreintegrated();
  ImuPreintegration joined = next->GetImuPreintegrated();
  const ImuPreintegration* const before[] = {&earlier};
  if (JoinPreintegrations(before, joined)) next->SetImuPreintegrated(joined);
  next->mPrevKF = previous;
  previous->mNextKF = next;
  keyframe.mPrevKF = keyframe.mNextKF = nullptr;
}

}  // namespace

RecentPoint JudgeRecentPoint(MapPoint& point, std::uint64_t current, bool monocular) {
  const long int age = static_cast<long int>(current) - point.mnFirstKFid;
  if (point.isBad()) return RecentPoint::kBad;
  if (point.GetFoundRatio() < kLeastFoundRatio) return RecentPoint::kRarelyFound;
  if (age >= 2 && point.Observations() <= (monocular ? 2 : 3)) return RecentPoint::kFewObservers;
  return age >= 3 ? RecentPoint::kKeep : RecentPoint::kWatch;
}

int CullMapPoints(std::list<MapPoint*>& recent, std::uint64_t current, bool monocular) {
  int culled = 0;
  recent.remove_if([&](MapPoint* point) {
    if (point == nullptr) return true;
    const RecentPoint judgement = JudgeRecentPoint(*point, current, monocular);
    if (judgement == RecentPoint::kRarelyFound || judgement == RecentPoint::kFewObservers) {
      point->SetBadFlag();
      ++culled;
    }
    return judgement != RecentPoint::kWatch;
  });
  return culled;
}

bool IsRedundant(KeyFrame& keyframe, bool monocular, double share) {
  int points = 0, redundant = 0;
  const std::vector<MapPoint*> slots = keyframe.GetMapPointMatches();
  for (std::size_t row = 0; row < slots.size(); ++row) {
    MapPoint* point = slots[row];
    if (point == nullptr || point->isBad() || (!monocular && !IsNear(keyframe, row))) continue;
    ++points;
    if (point->Observations() <= kEnoughObservers) continue;
    const int octave = OctaveOf(keyframe, static_cast<int>(row), -1);
    if (IsSeenElsewhere(*point, keyframe, octave)) ++redundant;
  }
  return redundant > share * points;
}

int CullKeyFrames(KeyFrame& current, const KeyFrameCulling& options) {
  constexpr int kMost = 100, kMostWhenAborting = 20;
  constexpr double kShare = 0.9, kShareWithDepthAndImu = 0.5;
  Map* const map = current.GetMap();
  if (map == nullptr) return 0;
  const double share = options.inertial && !options.monocular ? kShareWithDepthAndImu : kShare;
  int culled = 0, looked_at = 0;
  current.UpdateBestCovisibles();
  for (KeyFrame* keyframe : current.GetVectorCovisibleKeyFrames()) {
    if (++looked_at > (options.abort_requested ? kMostWhenAborting : kMost)) break;
    if (keyframe->mnId == map->GetInitKFid() || keyframe->isBad()) continue;
    if (!IsRedundant(*keyframe, options.monocular, share)) continue;
    if (options.inertial && !MayLeaveChain(*keyframe, current, *map)) continue;
    const Change change(map->runtime().gate);
    if (options.inertial) LeaveChain(*keyframe);
    keyframe->SetBadFlag();
    if (keyframe->isBad()) ++culled;  // what must not be erased now goes later
  }
  return culled;
}

}  // namespace slamdb::live
