// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/frame/axes.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <optional>
#include <string>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"

namespace slamdb {
namespace {

struct Convention {
  std::string_view name;
  std::string_view axes;  // in those of a camera
};
constexpr std::array<Convention, 5> kConventions = {{
    {"camera", "x,y,z"},
    {"ros", "z,-x,-y"},
    {"enu", "x,z,-y"},
    {"ned", "z,x,y"},
    {"opengl", "x,-y,-z"},
}};

Error NotAxes(std::string_view text) {
  std::string names;
  for (const Convention& convention : kConventions) names += detail::Concat(names.empty() ? "" : ", ", convention.name);
  return Error(ErrorKind::kUsage,
               detail::Concat("axes are a list as x,-z,y or two of ", names, " as camera:ros, not '", text, "'"));
}

// The unit vector of `x`, `+x` or `-x`.
std::optional<Eigen::RowVector3d> ParseAxis(std::string_view text) {
  const bool negative = text.starts_with('-');
  if (negative || text.starts_with('+')) text.remove_prefix(1);
  if (text.size() != 1 || text[0] < 'x' || text[0] > 'z') return std::nullopt;
  return (negative ? -1.0 : 1.0) * Eigen::RowVector3d::Unit(text[0] - 'x');
}

// One row for each axis of the target.
std::optional<Eigen::Matrix3d> ParseList(std::string_view text) {
  const auto names = detail::Split(text, ',');
  if (names.size() != 3) return std::nullopt;
  Eigen::Matrix3d rows;
  for (int row = 0; row < 3; ++row) {
    const auto axis = ParseAxis(detail::Trimmed(names[row]));
    if (!axis) return std::nullopt;
    rows.row(row) = *axis;
  }
  return rows;
}

// convention_from_camera.
std::optional<Eigen::Matrix3d> FindConvention(std::string_view name) {
  const auto found = std::ranges::find(kConventions, name, &Convention::name);
  return found == kConventions.end() ? std::nullopt : ParseList(found->axes);
}

std::optional<Eigen::Matrix3d> ParsePair(std::string_view text) {
  const auto names = detail::Split(text, ':');
  if (names.size() != 2) return std::nullopt;
  const auto from = FindConvention(names[0]), to = FindConvention(names[1]);
  if (!from || !to) return std::nullopt;
  return *to * from->transpose();
}

}  // namespace

Eigen::Quaterniond ParseAxes(std::string_view text) {
  auto matrix = ParsePair(text);
  if (!matrix) matrix = ParseList(text);
  if (!matrix) throw NotAxes(text);
  const double determinant = matrix->determinant();
  if (determinant == 0) throw Error(ErrorKind::kUsage, detail::Concat("axes '", text, "' name an axis twice"));
  if (determinant < 0)
    throw Error(ErrorKind::kUsage,
                detail::Concat("axes '", text, "' mirror the map; turn the sign of one, or of all three"));
  return Eigen::Quaterniond(*matrix);
}

}  // namespace slamdb
