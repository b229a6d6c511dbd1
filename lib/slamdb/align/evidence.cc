// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/detail/evidence.h"

#include <algorithm>
#include <cmath>

#include "slamdb/align/detail/second_axis.h"
#include "slamdb/align/detail/verify.h"

namespace slamdb::detail {
namespace {

constexpr double kNear = 0.3;          // of the median depth: keyframes that near, and
constexpr double kNearCosine = 0.866;  // turned by 30 degrees at most, look at the same

// The share of the second map's keyframes with a near view in the first.
double OverlapOf(const MapPair& pair, const Similarity3d& first_from_second) {
  const MapViews &first = pair.first.views, &second = pair.second.views;
  std::size_t near = 0, all = 0;
  for (const View& view : second.views()) {
    if (view.right) continue;
    ++all;
    const Eigen::Vector3d center = first_from_second * view.center;
    const Eigen::Vector3d axis = first_from_second.rotation * view.axis();
    const bool has_near = std::ranges::any_of(first.views(), [&](const View& other) {
      return !other.right && other.axis().dot(axis) > kNearCosine &&
             (other.center - center).norm() < kNear * first.median_depth();
    });
    near += has_near ? 1 : 0;
  }
  return all == 0 ? 0 : static_cast<double>(near) / static_cast<double>(all);
}

}  // namespace

double ExtentOf(const MapViews& first, const std::vector<PointMatch>& matches) {
  if (matches.size() < 3 || !(first.median_depth() > 0)) return 0;
  std::vector<Eigen::Vector3d> positions;
  for (const PointMatch& match : matches) positions.push_back(first.points()[match.first.point].position);
  return SecondAxis<3>(positions) / first.median_depth();
}

AlignmentEvidence EvidenceFor(const MapPair& pair, const GlobalFit& global, int threads) {
  const Similarity3d& first_from_second = global.fit.first_from_second;
  AlignmentEvidence evidence{.points = global.matches.size(), .extent = ExtentOf(pair.first.views, global.matches)};
  if (global.fit.residuals > 0)
    evidence.rms = std::sqrt(2 * global.fit.cost / static_cast<double>(global.fit.residuals));
  evidence.overlap = OverlapOf(pair, first_from_second);
  // A map with few features in its pictures explains little of a rich one, so the better direction counts.
  const SeenShare in_first = LookFor(pair.second.views, pair.first.views, first_from_second, threads);
  const SeenShare in_second = LookFor(pair.first.views, pair.second.views, first_from_second.Inverse(), threads);
  evidence.found_share = std::max(in_first.found_share(), in_second.found_share());
  evidence.cell_share = std::max(in_first.cell_share(), in_second.cell_share());
  evidence.front_share = std::max(in_first.front_share(), in_second.front_share());
  evidence.views = in_first.views + in_second.views;
  evidence.agreeing_views = in_first.agreeing_views + in_second.agreeing_views;
  return evidence;
}

}  // namespace slamdb::detail
