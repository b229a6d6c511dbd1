// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/loss_function.h>
#include <ceres/problem.h>

#include <cstdint>
#include <deque>
#include <vector>

#include "slamdb/optimize/bundle_adjustment.h"
#include "slamdb/optimize/detail/costs.h"
#include "slamdb/optimize/detail/solve.h"

namespace slamdb::detail {

// What may move in a bundle adjustment, what measures it, and how to solve it. Refers to the atlas of the index.
class Bundle {
 public:
  // `free`: by row of the keyframes.
  Bundle(const AtlasIndex& index, std::size_t map, const std::vector<std::uint8_t>& free, const BundleOptions& options);

  // Minimises over the measurements that are used.
  Solution Run(const BundleOptions& options, std::string_view stage);

  // Uses the measurements that fit, and no others. Whether these are others than before.
  bool Judge();
  std::vector<const Measurement*> Misfits() const;

  // Takes away what no measurement fixes, but the gauge does.
  void RestoreGauge();

  const MapStates& before() const { return before_; }
  MapStates& states() { return states_; }
  bool nothing_moves() const;
  // All but what was to move and is not measured enough: that follows something else.
  const Moved& settled() const { return settled_; }

  // Counts, costs and errors of what is used now.
  void Describe(BundleReport& report) const;

 private:
  // Of a reprojection: in standard deviations, squared, with the depth; and in pixels, without. Infinite behind a
  // camera.
  struct Errors {
    double squared, pixels;
  };

  void ChooseWhatMoves(const Map& map, const std::vector<std::uint8_t>& free, const BundleOptions& options);
  void ChooseGauge(const Map& map, const BundleOptions& options);
  void Settle(const std::vector<std::uint8_t>& free, const BundleOptions& options);
  bool KnowsScale() const;
  std::uint32_t InitialKeyFrame(const Map& map) const;
  void AddReprojections(ceres::Problem& problem);
  void AddInertia(ceres::Problem& problem);
  void FixWhatStays(ceres::Problem& problem);
  static Errors ErrorsOf(const Measurement& measurement, const MapStates& states);

  const Measurements measurements_;
  std::vector<const Measurement*> involved_;  // of points that may move or are seen by what may
  std::vector<std::uint8_t> used_;            // of involved_
  std::vector<InertialLink> links_;
  std::uint64_t unusable_links_ = 0;
  const MapStates before_;
  MapStates states_;
  Moved moved_, settled_;
  std::vector<std::uint8_t> seeing_;  // keyframes that see what is involved
  Gauge gauge_ = Gauge::kNeighbours;
  std::uint32_t anchor_ = kNoRow;  // the keyframe that the gauge is about

  PoseManifold pose_manifold_;
  ceres::HuberLoss loss2_, loss3_, inertial_loss_;
  std::deque<ReprojectionCost<2>> costs2_;
  std::deque<ReprojectionCost<3>> costs3_;
  std::deque<InertialCost> inertial_costs_;
  std::deque<BiasWalkCost> walk_costs_;
};

}  // namespace slamdb::detail
