// SPDX-License-Identifier: BSD-3-Clause
// With T = world_from_camera moved to T * d, d = (shift, turn), a point in the camera moves by -shift + x^ turn. The
// measured pose of the second camera in the frame of the first then moves by
//   d_second - Ad(second_from_first) d_first,
// whose covariance is the sum of both, and whose information is the inverse of that.
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>

#include "slamdb/formats/g2o/detail/edges.h"
#include "slamdb/model/covariance.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/detail/rotations.h"
#include "slamdb/model/index.h"

namespace slamdb::g2o {
namespace {

constexpr std::size_t kLeastShared = 8;  // points; fewer tell a pose by chance
constexpr double kLeastCondition = 1e-10;

// nullopt where it cannot be inverted.
std::optional<Matrix6d> Inverted(const Matrix6d& matrix) {
  if (!matrix.allFinite()) return std::nullopt;
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(matrix);
  const auto& values = solver.eigenvalues();  // ascending
  if (!(values[0] > kLeastCondition * values[5])) return std::nullopt;
  return Matrix6d(solver.eigenvectors() * values.cwiseInverse().asDiagonal() * solver.eigenvectors().transpose());
}

}  // namespace

SharedViews::SharedViews(const Atlas& atlas, const Map& map) : map_(map), views_(map.keyframes.size()) {
  const IdTable points = PointTable(map);
  for (std::size_t row = 0; row < map.keyframes.size(); ++row) {
    const KeyFrame& keyframe = map.keyframes[row];
    if (!IsVertex(keyframe)) continue;
    View& view = views_[row];
    view.keyframe = &keyframe;
    const auto camera = std::ranges::find(atlas.cameras, keyframe.camera, &Camera::id);
    if (camera != atlas.cameras.end()) view.camera = &*camera;
    const Rigid3f pose = keyframe.camera_from_world.Normalized();
    view.rotation = pose.rotation.toRotationMatrix().cast<double>();
    view.translation = pose.translation.cast<double>();
    const Column<MapPointId>& slots = keyframe.features.map_points;
    const std::size_t left = std::min(slots.size(), keyframe.features.undistorted.size());
    for (std::size_t slot = 0; slot < left; ++slot)
      if (const std::uint32_t point = points.Find(slots[slot].value()); point != kNoRow && !map.points[point].bad)
        view.sights.push_back({point, static_cast<std::uint32_t>(slot)});
    std::ranges::sort(view.sights);
  }
}

void SharedViews::Add(const View& view, const Sight& sight, Matrix6d& information) const {
  const KeyFrame& keyframe = *view.keyframe;
  const Keypoint* keypoint = ObservedKeypoint(keyframe, static_cast<std::int32_t>(sight.keypoint));
  if (keypoint == nullptr || keypoint->octave < 0 ||
      static_cast<std::size_t>(keypoint->octave) >= keyframe.pyramid.sigma2.size())
    return;
  const Eigen::Vector3d x = view.rotation * map_.points[sight.point].position.cast<double>() + view.translation;
  const auto by_point = ProjectionJacobian(*view.camera, x);
  if (!by_point) return;
  Eigen::Matrix<double, 3, 6> point_by_motion;
  point_by_motion << -Eigen::Matrix3d::Identity(), detail::Hat(x);
  const double weight = 1 / static_cast<double>(keyframe.pyramid.sigma2[static_cast<std::size_t>(keypoint->octave)]);
  const Eigen::Matrix<double, 2, 6> by_motion = *by_point * point_by_motion;
  information += weight * by_motion.transpose() * by_motion;
  const Column<float>& right_x = keyframe.features.right_x;
  if (keyframe.features.is_fisheye_stereo() || sight.keypoint >= right_x.size() || !(right_x[sight.keypoint] >= 0))
    return;
  Eigen::RowVector3d right = by_point->row(0);
  right.z() += static_cast<double>(keyframe.intrinsics.baseline_fx) / (x.z() * x.z());
  const Eigen::Matrix<double, 1, 6> right_by_motion = right * point_by_motion;
  information += weight * right_by_motion.transpose() * right_by_motion;
}

std::optional<Matrix6d> SharedViews::InformationOf(std::uint32_t first, std::uint32_t second) const {
  const View &a = views_[first], &b = views_[second];
  if (a.camera == nullptr || b.camera == nullptr) return std::nullopt;
  Matrix6d of_first = Matrix6d::Zero(), of_second = Matrix6d::Zero();
  std::size_t shared = 0;
  for (auto i = a.sights.begin(), j = b.sights.begin(); i != a.sights.end() && j != b.sights.end();) {
    if (i->point != j->point) {
      ++(i->point < j->point ? i : j);
      continue;
    }
    Add(a, *i++, of_first);
    Add(b, *j++, of_second);
    ++shared;
  }
  if (shared < kLeastShared) return std::nullopt;
  const auto covariance_of_first = Inverted(of_first), covariance_of_second = Inverted(of_second);
  if (!covariance_of_first || !covariance_of_second) return std::nullopt;
  const Eigen::Matrix3d turn = b.rotation * a.rotation.transpose();  // second from first
  const Eigen::Vector3d shift = b.translation - turn * a.translation;
  Matrix6d carried = Matrix6d::Zero();
  carried << turn, detail::Hat(shift) * turn, Eigen::Matrix3d::Zero(), turn;
  return Inverted(*covariance_of_second + carried * *covariance_of_first * carried.transpose());
}

}  // namespace slamdb::g2o
