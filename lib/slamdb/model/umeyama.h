// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "slamdb/export.h"
#include "slamdb/model/similarity.h"

namespace slamdb {

struct UmeyamaOptions {
  bool with_scale = true;        // false: the scale is 1
  double outlier_distance = 0;   // target units; pairs farther apart than this are left out, and the rest is solved
                                 // again until nothing changes (RANSAC starts it); 0: every pair counts
  bool leave_out_gross = false;  // without an outlier distance: pairs are left out that end up ten times farther apart
                                 // than the rest (robust scale of the least median of squares) and by more than a tenth
                                 // of how far the rest spreads
  bool accept_line = false;      // without both: points on one line are solved too, with some rotation about it
};

struct UmeyamaResult {
  Similarity3d target_from_source;
  std::vector<double> residuals;      // |target - target_from_source * source| of each pair, target units
  std::vector<std::uint8_t> inliers;  // 1: the pair was used
  double rms = 0;                     // of the inliers' residuals
  double spread = 0;                  // RMS distance of the inliers' targets from their mean
  bool on_line = false;               // they lie on one line, with accept_line: the rotation about it means nothing
};

// The similarity that takes `source` points to `target` points with the least squared distance.
// Points correspond by their place in the spans.
// Deterministic.
//
// Throws Error:
//   kUsage        the spans differ in length
//   kNotPossible  they hold values that are not finite; they do not determine the transform, with fewer than three
//                 pairs or all on one line; no three pairs agree within the outlier distance
// After Umeyama, PAMI 1991.
SLAMDB_EXPORT UmeyamaResult SolveUmeyama(std::span<const Eigen::Vector3d> source,
                                         std::span<const Eigen::Vector3d> target, const UmeyamaOptions& options);

// A sentence when the residuals are large for points that spread so: some pair is wrong, or the shapes differ.
SLAMDB_EXPORT std::optional<std::string> PoorFitWarning(double rms, double spread);

}  // namespace slamdb
