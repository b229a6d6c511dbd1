// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/optimize/detail/bundle.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/median.h"

namespace slamdb::detail {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kTolerance = 1e-7;
constexpr double kInertialChiSquare = 16.92;  // 95 %, nine numbers, as in ORB-SLAM3

double RobustCost(double squared, double limit) {
  return 0.5 * (squared <= limit ? squared : 2 * std::sqrt(limit * squared) - limit);
}

Distribution Described(const std::vector<double>& values) {
  Distribution distribution{.count = values.size()};
  if (values.empty()) return distribution;
  for (const double value : values) {
    distribution.mean += value / static_cast<double>(values.size());
    distribution.max = std::max(distribution.max, value);
  }
  distribution.median = MedianOf(values);
  return distribution;
}

// The turn about the vertical that comes nearest to a rotation.
Eigen::Quaterniond HeadingOf(const Eigen::Quaterniond& rotation) {
  const Eigen::Matrix3d matrix = rotation.toRotationMatrix();
  const double angle = std::atan2(matrix(1, 0) - matrix(0, 1), matrix(0, 0) + matrix(1, 1));
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()));
}

}  // namespace

Bundle::Bundle(const AtlasIndex& index, std::size_t map_row, const std::vector<std::uint8_t>& free,
               const BundleOptions& options)
    : measurements_(index, map_row),
      before_(index.atlas().maps[map_row]),
      states_(before_),
      loss2_(std::sqrt(kChiSquare2)),
      loss3_(std::sqrt(kChiSquare3)),
      inertial_loss_(std::sqrt(kInertialChiSquare)) {
  const Map& map = index.atlas().maps[map_row];
  if (!options.fix_poses) links_ = FindInertialLinks(map, unusable_links_);
  ChooseWhatMoves(map, free, options);
  ChooseGauge(map, options);
  Settle(free, options);
  used_.resize(involved_.size());
  for (std::size_t i = 0; i < involved_.size(); ++i) used_[i] = std::isfinite(ErrorsOf(*involved_[i], states_).squared);
}

void Bundle::ChooseWhatMoves(const Map& map, const std::vector<std::uint8_t>& free, const BundleOptions& options) {
  moved_ = {std::vector<std::uint8_t>(map.keyframes.size(), 0), std::vector<std::uint8_t>(map.points.size(), 0)};
  std::vector<std::uint8_t> is_involved(map.points.size(), 0);
  for (const Measurement& measurement : measurements_.all()) {
    if (!free[measurement.keyframe]) continue;
    is_involved[measurement.point] = 1;
    moved_.keyframes[measurement.keyframe] = !options.fix_poses;
    moved_.points[measurement.point] = !options.fix_points;
  }
  for (const InertialLink& link : links_)
    for (const std::uint32_t end : {link.first, link.second})
      if (free[end]) moved_.keyframes[end] = 1;
  std::erase_if(links_, [&](const InertialLink& link) {
    return !moved_.keyframes[link.first] && !moved_.keyframes[link.second];
  });
  seeing_.assign(map.keyframes.size(), 0);
  for (const Measurement& measurement : measurements_.all()) {
    if (!is_involved[measurement.point]) continue;
    involved_.push_back(&measurement);
    seeing_[measurement.keyframe] = 1;
  }
}

std::uint32_t Bundle::InitialKeyFrame(const Map& map) const {
  std::uint32_t lowest = kNoRow;
  for (std::uint32_t row = 0; row < map.keyframes.size(); ++row) {
    if (!moved_.keyframes[row]) continue;
    if (map.keyframes[row].id == map.initial_keyframe) return row;
    if (lowest == kNoRow || map.keyframes[row].id < map.keyframes[lowest].id) lowest = row;
  }
  return lowest;
}

bool Bundle::KnowsScale() const {
  return !links_.empty() ||
         std::ranges::any_of(involved_, [](const Measurement* m) { return m->has_depth() || m->eye->right; });
}

void Bundle::ChooseGauge(const Map& map, const BundleOptions& options) {
  if (options.fix_points) {
    gauge_ = Gauge::kPoints;
    return;
  }
  std::uint32_t fixed = 0, last_fixed = kNoRow;
  for (std::uint32_t row = 0; row < seeing_.size(); ++row)
    if (seeing_[row] && !moved_.keyframes[row]) {
      ++fixed;
      last_fixed = row;
    }
  const bool knows_scale = KnowsScale();
  if (fixed > 1 || (fixed == 1 && knows_scale)) return;
  anchor_ = fixed == 1 ? last_fixed : InitialKeyFrame(map);
  if (anchor_ == kNoRow) return;
  gauge_ = !links_.empty() ? Gauge::kHeading : knows_scale ? Gauge::kKeyFrame : Gauge::kKeyFrameAndScale;
  if (gauge_ != Gauge::kHeading) moved_.keyframes[anchor_] = 0;
}

void Bundle::Settle(const std::vector<std::uint8_t>& free, const BundleOptions& options) {
  settled_ = moved_;
  for (std::uint32_t row = 0; row < free.size(); ++row)
    if (!free[row] || options.fix_poses || row == anchor_) settled_.keyframes[row] = 1;
  if (options.fix_points) std::ranges::fill(settled_.points, std::uint8_t{1});
}

bool Bundle::nothing_moves() const {
  return std::ranges::count(moved_.keyframes, 1) + std::ranges::count(moved_.points, 1) == 0;
}

Bundle::Errors Bundle::ErrorsOf(const Measurement& measurement, const MapStates& states) {
  const PoseState& pose = states.poses[measurement.keyframe];
  const Eigen::Vector3d in_camera = pose.rotation() * states.points[measurement.point] + pose.translation();
  const auto errors = [&]<int kRows>(std::integral_constant<int, kRows>) -> Errors {
    Eigen::Matrix<double, kRows, 1> error;
    Eigen::Matrix<double, kRows, 3> by_point;
    if (!Predict<kRows>(measurement, in_camera, error, by_point)) return {kInfinity, kInfinity};
    return {error.squaredNorm(), error.template head<2>().norm() / measurement.inverse_sigma};
  };
  return measurement.has_depth() ? errors(std::integral_constant<int, 3>()) : errors(std::integral_constant<int, 2>());
}

void Bundle::AddReprojections(ceres::Problem& problem) {
  costs2_.clear();
  costs3_.clear();
  for (std::size_t i = 0; i < involved_.size(); ++i) {
    const Measurement& measurement = *involved_[i];
    if (!used_[i]) continue;
    double* pose = states_.poses[measurement.keyframe].values.data();
    double* point = states_.points[measurement.point].data();
    if (measurement.has_depth())
      problem.AddResidualBlock(&costs3_.emplace_back(measurement), &loss3_, pose, point);
    else
      problem.AddResidualBlock(&costs2_.emplace_back(measurement), &loss2_, pose, point);
  }
}

void Bundle::AddInertia(ceres::Problem& problem) {
  inertial_costs_.clear();
  walk_costs_.clear();
  for (const InertialLink& link : links_) {
    const std::uint32_t a = link.first, b = link.second;
    problem.AddResidualBlock(&inertial_costs_.emplace_back(link), &inertial_loss_, states_.poses[a].values.data(),
                             states_.velocities[a].data(), states_.biases[a].data(), states_.poses[b].values.data(),
                             states_.velocities[b].data());
    problem.AddResidualBlock(&walk_costs_.emplace_back(link), nullptr, states_.biases[a].data(),
                             states_.biases[b].data());
  }
}

void Bundle::FixWhatStays(ceres::Problem& problem) {
  for (std::size_t row = 0; row < states_.poses.size(); ++row) {
    double* const pose = states_.poses[row].values.data();
    if (problem.HasParameterBlock(pose)) {
      problem.SetManifold(pose, &pose_manifold_);
      if (!moved_.keyframes[row]) problem.SetParameterBlockConstant(pose);
    }
    for (double* block : {states_.velocities[row].data(), states_.biases[row].data()})
      if (problem.HasParameterBlock(block) && !moved_.keyframes[row]) problem.SetParameterBlockConstant(block);
  }
  for (std::size_t row = 0; row < states_.points.size(); ++row)
    if (double* const point = states_.points[row].data(); !moved_.points[row] && problem.HasParameterBlock(point))
      problem.SetParameterBlockConstant(point);
}

Solution Bundle::Run(const BundleOptions& options, std::string_view stage) {
  ceres::Problem problem(BorrowingProblem());
  AddReprojections(problem);
  AddInertia(problem);
  FixWhatStays(problem);
  std::vector<double*> points;
  for (std::size_t row = 0; row < states_.points.size(); ++row)
    if (double* const point = states_.points[row].data(); moved_.points[row] && problem.HasParameterBlock(point))
      points.push_back(point);
  const auto cameras = static_cast<std::size_t>(std::ranges::count(moved_.keyframes, 1));
  return Solve(problem, cameras, std::move(points), {options.iterations, kTolerance, stage, options.progress});
}

bool Bundle::Judge() {
  bool changed = false;
  for (std::size_t i = 0; i < involved_.size(); ++i) {
    const bool fits = ErrorsOf(*involved_[i], states_).squared <= Limit(*involved_[i]);
    changed |= fits != (used_[i] != 0);
    used_[i] = fits;
  }
  return changed;
}

std::vector<const Measurement*> Bundle::Misfits() const {
  std::vector<const Measurement*> misfits;
  for (std::size_t i = 0; i < involved_.size(); ++i)
    if (!used_[i]) misfits.push_back(involved_[i]);
  return misfits;
}

void Bundle::RestoreGauge() {
  if (anchor_ == kNoRow || gauge_ == Gauge::kKeyFrame) return;
  const Eigen::Vector3d center = before_.poses[anchor_].Center();
  Similarity3d target_from_source;
  if (gauge_ == Gauge::kHeading) {
    const PoseState &was = before_.poses[anchor_], &is = states_.poses[anchor_];
    target_from_source.rotation = HeadingOf(was.rotation().conjugate() * is.rotation());
    target_from_source.translation = center - target_from_source.rotation * is.Center();
  } else {
    double was = 0, is = 0;  // squared distances of cameras
    for (std::size_t row = 0; row < states_.poses.size(); ++row) {
      if (!moved_.keyframes[row]) continue;
      was += (before_.poses[row].Center() - center).squaredNorm();
      is += (states_.poses[row].Center() - center).squaredNorm();
    }
    if (!(was > 0 && is > 0)) return;
    target_from_source.scale = std::sqrt(was / is);
    target_from_source.translation = center - target_from_source.scale * center;
  }
  states_.Move(target_from_source, moved_);
}

void Bundle::Describe(BundleReport& report) const {
  report.keyframes = static_cast<std::uint64_t>(std::ranges::count(moved_.keyframes, 1));
  report.points = static_cast<std::uint64_t>(std::ranges::count(moved_.points, 1));
  for (std::size_t row = 0; row < seeing_.size(); ++row)
    report.fixed_keyframes += seeing_[row] && !moved_.keyframes[row] ? 1 : 0;
  report.gauge = gauge_;
  report.observations = involved_.size();
  report.with_depth = static_cast<std::uint64_t>(
      std::ranges::count_if(involved_, [](const Measurement* measurement) { return measurement->has_depth(); }));
  report.inertial_links = links_.size();
  if (unusable_links_ > 0)
    report.warnings.push_back(Concat(unusable_links_,
                                     " inertial links are left out: they hold no covariance, or "
                                     "their keyframes no calibration, velocity or bias"));
  std::vector<double> before, after;
  for (std::size_t i = 0; i < involved_.size(); ++i) {
    const Measurement& measurement = *involved_[i];
    const Errors was = ErrorsOf(measurement, before_), is = ErrorsOf(measurement, states_);
    if (!used_[i] || !std::isfinite(was.squared)) continue;
    report.cost_before += RobustCost(was.squared, Limit(measurement));
    report.cost_after += RobustCost(is.squared, Limit(measurement));
    before.push_back(was.pixels);
    after.push_back(is.pixels);
  }
  report.error_before = Described(before);
  report.error_after = Described(after);
}

}  // namespace slamdb::detail
