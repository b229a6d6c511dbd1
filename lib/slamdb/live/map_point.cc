// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/live/map_point.h"

#include <iostream>

#include "slamdb/base/column.h"
#include "slamdb/live/detail/own.h"
#include "slamdb/live/frame.h"
#include "slamdb/live/keyframe.h"
#include "slamdb/live/map.h"
#include "slamdb/model/derive.h"

namespace slamdb::live {

using Lock = std::lock_guard<std::mutex>;

namespace {

constexpr const char *kTheMap = "the map", *kTheKeyFrame = "the keyframe", *kTheFrame = "the frame";

Map& Required(Map* map) {
  if (map == nullptr) RefuseNull(kTheMap);
  return *map;
}

}  // namespace

MapPoint::MapPoint() : Listed(NoAtlas()), mnId(MapPointId::kNone) {}

MapPoint::MapPoint(Map& map) : MapPoint(map, map.runtime().point_ids.Next()) {}

MapPoint::MapPoint(Map& map, std::uint64_t id)
    : Listed(map.runtime()), mnId(id), mnOriginMapId(static_cast<unsigned int>(map.GetId())), map_(&map) {}

MapPoint::MapPoint(const Eigen::Vector3f& Pos, KeyFrame* pRefKF, Map* pMap) : MapPoint(Required(pMap)) {
  RequireOwn(pRefKF, runtime(), kTheKeyFrame);
  mnFirstKFid = static_cast<long int>(pRefKF->mnId);
  mnFirstFrame = static_cast<long int>(pRefKF->mnFrameId);
  position_ = Pos;
  reference_ = pRefKF;
}

MapPoint::MapPoint(double invDepth, cv::Point2f uv_init, KeyFrame* pRefKF, KeyFrame* pHostKF, Map* pMap)
    : MapPoint(Eigen::Vector3f::Zero(), pRefKF, pMap) {
  RequireOwn(pHostKF, runtime(), "the host keyframe");
  mInvDepth = invDepth;
  mInitU = static_cast<double>(uv_init.x);
  mInitV = static_cast<double>(uv_init.y);
  mpHostKF = pHostKF;
}

MapPoint::MapPoint(const Eigen::Vector3f& Pos, Map* pMap, Frame* pFrame, int idxF) : MapPoint(Required(pMap)) {
  RequireOwn(pFrame, runtime(), kTheFrame);
  mnFirstFrame = static_cast<long int>(pFrame->mnId);
  position_ = Pos;
  const slamdb::KeyFrame& image = pFrame->image();
  const bool is_right = image.features.is_fisheye_stereo() && idxF >= image.features.left_count;
  const Eigen::Vector3f center = is_right ? pFrame->GetRightCameraCenter() : pFrame->GetCameraCenter();
  normal_ = (Pos - center).normalized();
  if (const Keypoint* keypoint = ObservedKeypoint(image, idxF); keypoint != nullptr)
    StoreDistanceRange((Pos - center).norm(), keypoint->octave, image.pyramid);
  if (idxF >= 0 && static_cast<std::size_t>(idxF) < image.features.descriptors.size()) {
    descriptor_ = image.features.descriptors[static_cast<std::size_t>(idxF)];
    descriptor_form_ = MatrixForm::kUsual;
  }
}

// Points are many and of one size: slabs cost no page fault and no malloc each.
void* MapPoint::operator new(std::size_t bytes) { return AllocateColumn(bytes); }
void MapPoint::operator delete(void* block, std::size_t bytes) { FreeColumn(block, bytes); }

void MapPoint::MarkChanged() {
  if (is_owned()) runtime().changed_points.Add(this);
}

// ---- position

void MapPoint::SetWorldPos(const Eigen::Vector3f& Pos) {
  const Change change(runtime().gate);
  {
    const Lock global(runtime().global_mutex);
    const Lock lock(mutex_position_);
    position_ = Pos;
  }
  MarkChanged();
}

Eigen::Vector3f MapPoint::GetWorldPos() {
  const Lock lock(mutex_position_);
  return position_;
}

Eigen::Vector3f MapPoint::GetNormal() {
  const Lock lock(mutex_position_);
  return normal_;
}

void MapPoint::SetNormalVector(const Eigen::Vector3f& normal) {
  const Change change(runtime().gate);
  {
    const Lock lock(mutex_position_);
    normal_ = normal;
  }
  MarkChanged();
}

void MapPoint::StoreDistanceRange(float distance, int octave, const ScalePyramid& pyramid) {
  const DistanceRange range = DeriveDistanceRange(distance, octave, pyramid);
  min_distance_ = range.min;
  max_distance_ = range.max;
}

void MapPoint::UpdateNormalAndDepth() {
  std::vector<Observer> observers;
  KeyFrame* reference = nullptr;
  Eigen::Vector3f position;
  {
    const Lock lock(mutex_features_);
    if (bad_) return;
    observers = {observations_.begin(), observations_.end()};
    reference = reference_;
    const Lock position_lock(mutex_position_);
    position = position_;
  }
  if (observers.empty() || reference == nullptr) return;
  std::vector<Eigen::Vector3f> centers;
  const Keypoint* keypoint = nullptr;  // in the reference keyframe
  for (const Observer& observer : observers) {
    if (observer.left >= 0) centers.push_back(observer.keyframe->GetCameraCenter());
    if (observer.right >= 0) centers.push_back(observer.keyframe->GetRightCameraCenter());
    if (observer.keyframe == reference)
      keypoint = ObservedKeypoint(reference->features(), observer.left >= 0 ? observer.left : observer.right);
  }
  const float distance = (position - reference->GetCameraCenter()).norm();
  const Eigen::Vector3f normal = MeanViewingDirection(position, centers);
  const Change change(runtime().gate);
  {
    const Lock lock(mutex_position_);
    normal_ = normal;
    if (keypoint != nullptr) StoreDistanceRange(distance, keypoint->octave, reference->pyramid());
  }
  MarkChanged();
}

float MapPoint::GetMinDistanceInvariance() {
  const Lock lock(mutex_position_);
  return kNearMargin * min_distance_;
}

float MapPoint::GetMaxDistanceInvariance() {
  const Lock lock(mutex_position_);
  return kFarMargin * max_distance_;
}

int MapPoint::PredictScaleIn(float distance, const ScalePyramid& pyramid) {
  const Lock lock(mutex_position_);
  return slamdb::PredictScale(max_distance_, distance, pyramid);
}

int MapPoint::PredictScale(const float& currentDist, KeyFrame* pKF) {
  RequireOwn(pKF, runtime(), kTheKeyFrame);
  return PredictScaleIn(currentDist, pKF->pyramid());
}

int MapPoint::PredictScale(const float& currentDist, Frame* pF) {
  RequireOwn(pF, runtime(), kTheFrame);
  return PredictScaleIn(currentDist, pF->image().pyramid);
}

// ---- counters, map, state

KeyFrame* MapPoint::GetReferenceKeyFrame() {
  const Lock lock(mutex_features_);
  return reference_;
}

void MapPoint::IncreaseVisible(int n) {
  visible_.fetch_add(n, std::memory_order_relaxed);
  MarkChanged();
}

void MapPoint::IncreaseFound(int n) {
  found_.fetch_add(n, std::memory_order_relaxed);
  MarkChanged();
}

float MapPoint::GetFoundRatio() { return static_cast<float>(found_) / static_cast<float>(visible_); }

int MapPoint::GetFound() { return found_; }

bool MapPoint::isBad() { return bad_; }

MapPoint* MapPoint::GetReplaced() {
  const Lock lock(mutex_features_);
  return replaced_;
}

Map* MapPoint::GetMap() { return map_; }

void MapPoint::UpdateMap(Map* pMap) {
  if (pMap != nullptr && IsOf(NoAtlas())) {
    Join(pMap->runtime());
    if (mnId == MapPointId::kNone) mnId = runtime().point_ids.Next();
    if (mnOriginMapId == assumed_origin_) mnOriginMapId = assumed_origin_ = static_cast<unsigned int>(pMap->GetId());
    runtime().point_ids.Pass(mnId);
  }
  if (pMap != nullptr) RequireOwn(pMap, runtime(), kTheMap);
  const Change change(runtime().gate);
  map_ = pMap;
  MarkChanged();
}

cv::Mat MapPoint::GetDescriptor() {
  const Lock lock(mutex_features_);
  if (descriptor_form_ != MatrixForm::kUsual && descriptor_form_ != MatrixForm::kUsualNotContinuous) return {};
  return cv::Mat(1, static_cast<int>(descriptor_.size()), CV_8U, descriptor_.data()).clone();
}

void MapPoint::PrintObservations() { PrintObservations(std::cout); }

void MapPoint::PrintObservations(std::ostream& out) {
  const std::vector<Observer> observers = CopyObservers();
  out << "MP_OBS: MP " << mnId << '\n';
  for (const Observer& observer : observers) {
    out << "--OBS in KF " << observer.keyframe->mnId;
    if (Map* map = observer.keyframe->GetMap(); map != nullptr) out << " in map " << map->GetId();
    out << '\n';
  }
}

}  // namespace slamdb::live
