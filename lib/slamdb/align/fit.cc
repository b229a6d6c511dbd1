// SPDX-License-Identifier: BSD-3-Clause
// A step of the transform is a small motion in the first map about the centre of the matched points, so that rotation,
// translation and scale hardly depend on each other.
#include "slamdb/align/detail/fit.h"

#include <cmath>
#include <limits>

#include "slamdb/align/detail/huber.h"
#include "slamdb/model/detail/rotations.h"

namespace slamdb::detail {
namespace {

using Vector7 = Eigen::Matrix<double, 7, 1>;
using Matrix7 = Eigen::Matrix<double, 7, 7>;
using Jacobian = Eigen::Matrix<double, 2, 7>;

// A keypoint's place, and one over its standard deviation.
struct Measured {
  const View& view;
  Eigen::Vector2d pixel;
  double inverse_sigma;
};

Measured At(const MapViews& map, const Sighting& sighting) {
  const View& view = map.views()[sighting.view];
  const Keypoint& keypoint = view.keypoints[sighting.keypoint];
  return {view, PixelOf(keypoint), 1 / view.ScaleOf(keypoint.octave)};
}

// Of a point in the world of the measuring camera's map.
double SquaredError(const Measured& measured, const Eigen::Vector3d& point) {
  Eigen::Vector2d pixel;
  if (!measured.view.lens.Project(measured.view.CameraFromWorld(point), pixel))
    return std::numeric_limits<double>::infinity();
  return ((pixel - measured.pixel) * measured.inverse_sigma).squaredNorm();
}

// Which small motions are free: columns of a basis.
Eigen::MatrixXd BasisOf(Freedom freedom, const MapViews& first) {
  if (freedom == Freedom::kSimilarity) return Matrix7::Identity();
  if (freedom == Freedom::kRigid) return Matrix7::Identity().leftCols<6>();
  Eigen::Matrix<double, 7, 4> basis = Eigen::Matrix<double, 7, 4>::Zero();
  basis.col(0).head<3>() = *first.up();
  basis.block<3, 3>(3, 1).setIdentity();
  return basis;
}

Similarity3d Moved(const Similarity3d& transform, const Vector7& step, const Eigen::Vector3d& center) {
  const Eigen::Quaterniond rotation = Turn(step.head<3>());
  const Similarity3d motion{std::exp(step[6]), rotation,
                            center + step.segment<3>(3) - std::exp(step[6]) * (rotation * center)};
  Similarity3d moved = motion * transform;
  moved.rotation.normalize();
  return moved;
}

using Normal = RobustNormal<7>;

class Refiner {
 public:
  Refiner(const MapViews& first, const MapViews& second, std::span<const PointMatch> matches, Freedom freedom)
      : first_(first), second_(second), matches_(matches), basis_(BasisOf(freedom, first)) {
    for (const PointMatch& match : matches) center_ += first.points()[match.first.point].position;
    if (!matches.empty()) center_ /= static_cast<double>(matches.size());
  }

  Fit Run(Similarity3d transform, int iterations) const {
    const Normal normal = MinimiseRobustly<7>(
        transform, iterations, basis_, [&](const Similarity3d& at) { return Linearise(at); },
        [&](const Similarity3d& at, const Vector7& step) { return Moved(at, step, center_); });
    return {transform, normal.cost, normal.residuals, normal.Covariance(basis_), center_};
  }

 private:
  Normal Linearise(const Similarity3d& transform) const {
    Normal normal;
    const Similarity3d inverse = transform.Inverse();
    const Eigen::Matrix3d second_from_first = inverse.rotation.toRotationMatrix() * inverse.scale;
    Jacobian jacobian;
    Eigen::Matrix<double, 2, 3> by_point;
    Eigen::Matrix<double, 3, 7> motion;  // of a point in the first map
    Eigen::Vector2d pixel;
    const auto move = [&](const Eigen::Vector3d& point) {
      motion.leftCols<3>() = -Hat(point - center_);
      motion.middleCols<3>(3).setIdentity();
      motion.col(6) = point - center_;
    };
    for (const PointMatch& match : matches_) {
      const Measured in_first = At(first_, match.first.sighting), in_second = At(second_, match.second.sighting);
      const Eigen::Vector3d point = transform * second_.points()[match.second.point].position;
      if (in_first.view.lens.Project(in_first.view.CameraFromWorld(point), pixel, by_point)) {
        move(point);
        jacobian = in_first.inverse_sigma * by_point * in_first.view.rotation * motion;
        normal.Add((pixel - in_first.pixel) * in_first.inverse_sigma, jacobian);
      } else {
        normal.AddBehind();
      }
      const Eigen::Vector3d& own = first_.points()[match.first.point].position;
      if (in_second.view.lens.Project(in_second.view.CameraFromWorld(inverse * own), pixel, by_point)) {
        move(own);
        jacobian = -in_second.inverse_sigma * by_point * in_second.view.rotation * second_from_first * motion;
        normal.Add((pixel - in_second.pixel) * in_second.inverse_sigma, jacobian);
      } else {
        normal.AddBehind();
      }
    }
    return normal;
  }

  const MapViews &first_, &second_;
  const std::span<const PointMatch> matches_;
  const Eigen::MatrixXd basis_;
  Eigen::Vector3d center_ = Eigen::Vector3d::Zero();
};

// The rotation nearest to a given one that takes one vertical to the other.
Eigen::Quaterniond Levelled(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& up_first,
                            const Eigen::Vector3d& up_second) {
  return (Eigen::Quaterniond::FromTwoVectors(rotation * up_second, up_first) * rotation).normalized();
}

}  // namespace

Freedom PairGeometry::freedom() const {
  if (!first_.metric() || !second_.metric()) return Freedom::kSimilarity;
  return first_.up() && second_.up() ? Freedom::kUpright : Freedom::kRigid;
}

MatchErrors PairGeometry::ErrorsOf(const PointMatch& match, const Similarity3d& first_from_second) const {
  const Eigen::Vector3d& in_first = first_.points()[match.first.point].position;
  const Eigen::Vector3d& in_second = second_.points()[match.second.point].position;
  return {SquaredError(At(first_, match.first.sighting), first_from_second * in_second),
          SquaredError(At(second_, match.second.sighting), first_from_second.Inverse() * in_first)};
}

Fit PairGeometry::Refine(std::span<const PointMatch> matches, const Similarity3d& start, int iterations) const {
  Similarity3d transform = start;
  if (freedom() == Freedom::kUpright) transform.rotation = Levelled(start.rotation, *first_.up(), *second_.up());
  return Refiner(first_, second_, matches, freedom()).Run(transform, iterations);
}

}  // namespace slamdb::detail
