// SPDX-License-Identifier: BSD-3-Clause
#include "cli/report/similarity.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cli/report/layout.h"

namespace slamdb::cli {
namespace {

// Six digits, and more where they would not reach millimetres, as those of coordinates of UTM.
std::string Listed(const Eigen::Vector3d& vector) {
  const Eigen::Vector3d unsigned_zeros = vector.array() + 0.0;
  const double largest = unsigned_zeros.cwiseAbs().maxCoeff();
  const int digits = largest < 1e3 || largest > 1e12 ? 6 : 4 + static_cast<int>(std::log10(largest));
  return Short(unsigned_zeros.x(), digits) + " " + Short(unsigned_zeros.y(), digits) + " " +
         Short(unsigned_zeros.z(), digits);
}

}  // namespace

std::string SimilarityText(const Similarity3d& transform, std::string_view unit) {
  constexpr double kNothing = 1e-12;  // what a fit in double precision leaves of nothing
  std::string text;
  const auto add = [&text](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  if (transform.translation.norm() > kNothing) add("translation " + Listed(transform.translation) + std::string(unit));
  const Eigen::AngleAxisd turn(transform.rotation);
  if (turn.angle() > kNothing)
    add("rotation " + Short(turn.angle() * 180 / std::numbers::pi, 6) + " degrees about " + Listed(turn.axis()));
  if (std::abs(transform.scale - 1) > kNothing) add("scale " + Short(transform.scale, 8));
  return text.empty() ? "nothing" : text;
}

}  // namespace slamdb::cli
