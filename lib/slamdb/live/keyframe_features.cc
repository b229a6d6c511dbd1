// SPDX-License-Identifier: BSD-3-Clause
// What a keyframe sees: its keypoints, and the points in their slots.
#include <algorithm>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/median.h"
#include "slamdb/base/error.h"
#include "slamdb/live/detail/own.h"
#include "slamdb/live/keyframe.h"
#include "slamdb/live/map_point.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/vocabulary_tree.h"

namespace slamdb::live {

using Lock = std::lock_guard<std::mutex>;
using slamdb::detail::Concat;

namespace {

// Where a place of the undistorted image, in units of the focal length, is in the image that the lens makes (Brown,
// 1971): k1 k2 p1 p2 [k3].
Eigen::Vector2f Distort(const Eigen::Vector2f& place, const cv::Mat& coefficients) {
  if (coefficients.type() != CV_32F || coefficients.total() < 4) return place;
  const auto k = [&](int i) { return coefficients.at<float>(i); };
  const float k3 = coefficients.total() > 4 ? k(4) : 0;
  const float x = place.x(), y = place.y(), r2 = place.squaredNorm();
  const float radial = 1 + r2 * (k(0) + r2 * (k(1) + r2 * k3));
  return {x * radial + 2 * k(2) * x * y + k(3) * (r2 + 2 * x * x),
          y * radial + k(2) * (r2 + 2 * y * y) + 2 * k(3) * x * y};
}

}  // namespace

void KeyFrame::ComputeBoW(const VocabularyTree& vocabulary) {
  if (!features_.bag_of_words.words.empty() && !features_.feature_vector.nodes.empty()) return;
  Words words = ComputeWords(vocabulary, features_.descriptors);
  features_.bag_of_words = std::move(words.bag_of_words);
  features_.feature_vector = std::move(words.feature_vector);
}

void KeyFrame::ComputeBoW() {
  if (vocabulary_ == nullptr)
    throw Error(ErrorKind::kUsage, Concat("kf ", mnId, " has no vocabulary: SetORBVocabulary gives it one"));
  ComputeBoW(*vocabulary_);
}

std::vector<std::size_t> KeyFrame::GetFeaturesInArea(float x, float y, float r, bool bRight) const {
  const Column<Keypoint>& keypoints = bRight        ? features_.right_keypoints
                                      : NLeft == -1 ? features_.undistorted
                                                    : features_.keypoints;
  return KeypointsInArea(keypoints, bRight ? features_.right_grid : features_.grid, bounds(), x, y, r);
}

bool KeyFrame::IsInImage(float x, float y) const { return IsInsideImage(bounds(), x, y); }

bool KeyFrame::UnprojectStereo(int i, Eigen::Vector3f& x3D) {
  const std::optional<Eigen::Vector3f> position = UnprojectDepth(features_, intrinsics(), i);
  if (!position) return false;
  x3D = GetPoseInverse() * *position;
  return true;
}

std::optional<Eigen::Vector2f> KeyFrame::ProjectUndistorted(MapPoint* point) {
  RequireOwn(point, runtime(), "the point");
  const Eigen::Vector3f in_camera = GetPose() * point->GetWorldPos();
  if (!(in_camera.z() > 0)) return std::nullopt;
  const Eigen::Vector2f place(fx * in_camera.x() / in_camera.z() + cx, fy * in_camera.y() / in_camera.z() + cy);
  if (!IsInImage(place.x(), place.y())) return std::nullopt;
  return place;
}

bool KeyFrame::ProjectPointUnDistort(MapPoint* pMP, cv::Point2f& kp, float& u, float& v) {
  const std::optional<Eigen::Vector2f> place = ProjectUndistorted(pMP);
  if (!place) return false;
  u = kp.x = place->x();
  v = kp.y = place->y();
  return true;
}

bool KeyFrame::ProjectPointDistort(MapPoint* pMP, cv::Point2f& kp, float& u, float& v) {
  const std::optional<Eigen::Vector2f> place = ProjectUndistorted(pMP);
  if (!place) return false;
  const Eigen::Vector2f distorted = Distort({(place->x() - cx) * invfx, (place->y() - cy) * invfy}, mDistCoef);
  u = kp.x = fx * distorted.x() + cx;
  v = kp.y = fy * distorted.y() + cy;
  return true;
}

int KeyFrame::WeightOfObservation(int left, int right) const {
  return ObservationWeight(features_, mpCamera2 != nullptr, {{}, left, right});
}

bool KeyFrame::HasRows(const Observation& observation) const {
  const bool is_pair = features_.is_fisheye_stereo();
  const std::int32_t left_rows = is_pair ? features_.left_count : features_.count;
  const bool left = observation.left == -1 || (observation.left >= 0 && observation.left < left_rows);
  const bool right = observation.right == -1 ||
                     (is_pair && observation.right >= features_.left_count && observation.right < features_.count);
  return left && right;
}

// ---- point slots

void KeyFrame::RequireRow(std::size_t row) const {
  if (row >= slots_.size())
    throw Error(ErrorKind::kUsage, Concat("kf ", mnId, " has ", slots_.size(), " keypoints: none has row ",
                                          static_cast<std::int64_t>(row)));
}

void KeyFrame::SetSlot(std::size_t row, MapPoint* point) {
  RequireRow(row);
  if (point != nullptr) RequireOwn(point, runtime(), "the point");
  const Change change(runtime().gate);
  {
    const Lock lock(mutex_features_);
    slots_[row] = point;
    std::erase_if(unresolved_slots_, [&](const auto& slot) { return slot.first == row; });
  }
  MarkChanged();
}

void KeyFrame::AddMapPoint(MapPoint* pMP, std::size_t idx) { SetSlot(idx, pMP); }
void KeyFrame::ReplaceMapPointMatch(int idx, MapPoint* pMP) { SetSlot(static_cast<std::size_t>(idx), pMP); }
void KeyFrame::EraseMapPointMatch(int idx) { SetSlot(static_cast<std::size_t>(idx), nullptr); }

void KeyFrame::EraseMapPointMatch(MapPoint* pMP) {
  if (pMP == nullptr) return;
  const auto [left, right] = pMP->GetIndexInKeyFrame(this);
  if (left >= 0) EraseMapPointMatch(left);
  if (right >= 0) EraseMapPointMatch(right);
}

std::vector<MapPoint*> KeyFrame::GetMapPointMatches() {
  const Lock lock(mutex_features_);
  return slots_;
}

std::vector<MapPoint*> KeyFrame::GoodPoints() {
  std::vector<MapPoint*> points = GetMapPointMatches();
  std::erase_if(points, [](MapPoint* point) { return point == nullptr || point->isBad(); });
  return points;
}

std::set<MapPoint*> KeyFrame::GetMapPoints() {
  const std::vector<MapPoint*> points = GoodPoints();
  return {points.begin(), points.end()};
}

int KeyFrame::TrackedMapPoints(int minObs) {
  const std::vector<MapPoint*> points = GoodPoints();
  return static_cast<int>(std::count_if(
      points.begin(), points.end(), [&](MapPoint* point) { return minObs <= 0 || point->Observations() >= minObs; }));
}

MapPoint* KeyFrame::GetMapPoint(std::size_t idx) {
  const Lock lock(mutex_features_);
  return idx < slots_.size() ? slots_[idx] : nullptr;
}

int KeyFrame::GetNumberMPs() {
  const Lock lock(mutex_features_);
  return static_cast<int>(slots_.size()) - static_cast<int>(std::count(slots_.begin(), slots_.end(), nullptr));
}

float KeyFrame::ComputeSceneMedianDepth(int q) {
  const Rigid3f pose = GetPose();
  std::vector<float> depths;
  for (MapPoint* point : GetMapPointMatches())
    if (point != nullptr) depths.push_back((pose * point->GetWorldPos()).z());
  if (depths.empty() || q < 1) return -1;
  return slamdb::detail::ElementInOrder(depths, (depths.size() - 1) / static_cast<std::size_t>(q));
}

}  // namespace slamdb::live
