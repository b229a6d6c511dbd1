// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/tables/detail/cells.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <span>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/lengths.h"
#include "slamdb/base/error.h"
#include "slamdb/base/time_unit.h"
#include "slamdb/model/detail/camera_in_world.h"
#include "slamdb/model/detail/is_pose.h"

namespace slamdb::tables {
namespace {

using detail::Concat;
using detail::Table;
using detail::TableKind;

// What slamdb writes besides: it follows from the rest.
constexpr std::string_view kDerivedOfPoints[] = {"observations", "reprojection_error"};

constexpr std::string_view kDerivedOfKeyFrames[] = {"camera",     "parent",      "children",  "connections",
                                                    "loop_edges", "merge_edges", "keypoints", "map_points"};

std::vector<std::string> IgnoredColumns(const Table& table, const TableKind& kind,
                                        std::span<const std::string_view> derived) {
  std::vector<std::string> ignored;
  for (const detail::ColumnName& column : table.names()) {
    const bool known = std::ranges::any_of(kind.columns, [&](const detail::Column& wanted) {
      return std::ranges::find(wanted.names, column.name) != wanted.names.end();
    });
    if (!known && std::ranges::find(derived, column.name) == derived.end()) ignored.push_back(column.text);
  }
  return ignored;
}

// The other table has ids and positions, too, and would move what it is not about.
void RefuseOther(const Table& table, std::string_view only_other_has, std::string_view wanted, std::string_view found) {
  if (std::ranges::find(table.names(), only_other_has, &detail::ColumnName::name) == table.names().end()) return;
  throw Error(
      ErrorKind::kDamaged, "", "line 1",
      Concat("a table of ", found, "s, as its column ", only_other_has, " says, in place of one of ", wanted, "s"));
}
void RequireUsualUnits(const Table& table, std::initializer_list<std::size_t> lengths) {
  for (const std::size_t column : lengths) detail::RequireMetres(table, column);
}
void RequireSeconds(const Table& table, std::size_t column) {
  const detail::ColumnName* name = table.NameOf(column);
  if (name == nullptr || name->unit.empty() || TimeUnitByName(name->unit) == TimeUnit::kSeconds) return;
  throw Error(ErrorKind::kUnsupported, "", "column " + name->text,
              Concat("expected seconds, and no unit in the name, found '", name->unit, "'"));
}

// The same of each number from the column on.
bool SetNumbers(const Table& table, std::size_t first, std::span<float> numbers) {
  bool changed = false;
  for (std::size_t i = 0; i < numbers.size(); ++i) changed |= Set(table, first + i, numbers[i]);
  return changed;
}

void RequireFinite(const Table& table, std::size_t first, std::span<const float> numbers) {
  for (std::size_t i = 0; i < numbers.size(); ++i)
    if (!std::isfinite(numbers[i])) throw table.CellError(first + i, "a finite number");
}

}  // namespace

const TableKind& PointTable() {
  constexpr int kOptional = detail::Column::kOptional;
  static const TableKind kind = {.columns = {{{"id"}, 0},
                                             {{"map"}, kOptional},
                                             {{"x"}, kOptional},
                                             {{"y"}, kOptional},
                                             {{"z"}, kOptional},
                                             {{"nx"}, kOptional},
                                             {{"ny"}, kOptional},
                                             {{"nz"}, kOptional},
                                             {{"reference_keyframe"}, kOptional},
                                             {{"min_distance"}, kOptional},
                                             {{"max_distance"}, kOptional},
                                             {{"bad"}, kOptional}},
                                 .expected = "a table of points whose first line names its columns, `id` among them",
                                 .by_position = false};
  return kind;
}

const TableKind& KeyFrameTableKind() {
  constexpr int kOptional = detail::Column::kOptional;
  static const TableKind kind = {.columns = {{{"id"}, 0},
                                             {{"map"}, kOptional},
                                             {{"timestamp"}, kOptional},
                                             {{"frame_id"}, kOptional},
                                             {{"x"}, kOptional},
                                             {{"y"}, kOptional},
                                             {{"z"}, kOptional},
                                             {{"qx"}, kOptional},
                                             {{"qy"}, kOptional},
                                             {{"qz"}, kOptional},
                                             {{"qw"}, kOptional},
                                             {{"vx"}, kOptional},
                                             {{"vy"}, kOptional},
                                             {{"vz"}, kOptional},
                                             {{"not_erase"}, kOptional},
                                             {{"bad"}, kOptional}},
                                 .expected = "a table of keyframes whose first line names its columns, `id` among them",
                                 .by_position = false};
  return kind;
}

std::vector<std::string> IgnoredColumnsOfPoints(const Table& table) {
  RefuseOther(table, "qw", "point", "keyframe");
  RequireUsualUnits(table, {kX, kX + 1, kX + 2, kNearest, kFarthest});
  return IgnoredColumns(table, PointTable(), kDerivedOfPoints);
}

std::vector<std::string> IgnoredColumnsOfKeyFrames(const Table& table) {
  RefuseOther(table, "min_distance", "keyframe", "point");
  RequireUsualUnits(table, {kPose, kPose + 1, kPose + 2});
  RequireSeconds(table, kTimestamp);
  return IgnoredColumns(table, KeyFrameTableKind(), kDerivedOfKeyFrames);
}

bool Set(const Table& table, std::size_t column, KeyFrameId& field) {
  std::uint64_t id = field.value();
  const bool changed = Set(table, column, id);
  field = KeyFrameId(id);
  return changed;
}

bool Set(const Table& table, std::size_t column, Flag& field) {
  const std::string_view text = table.Raw(column);
  if (text.empty()) return false;
  const bool value = text == "1" || text == "true";
  if (!value && text != "0" && text != "false") throw table.CellError(column, "0 or 1, false or true");
  if (value == static_cast<bool>(field)) return false;
  field = value;
  return true;
}

bool SetBad(const Table& table, std::size_t column, Flag& bad, std::uint8_t& dropped) {
  Flag wanted = bad;
  if (!Set(table, column, wanted)) return false;
  dropped = wanted ? 1 : 0;
  if (wanted) return false;
  bad = wanted;
  return true;
}

bool SaysAny(const Table& table, std::size_t first, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i)
    if (!table.Raw(first + i).empty()) return true;
  return false;
}

bool SetVector(const Table& table, std::size_t first, Eigen::Vector3f& field) {
  Eigen::Vector3f value = field;
  if (!SetNumbers(table, first, {value.data(), 3})) return false;
  RequireFinite(table, first, {value.data(), 3});
  field = value;
  return true;
}

// ORB-SLAM3's are means of the directions in which keyframes see a point.
bool SetNormal(const Table& table, Eigen::Vector3f& field) {
  if (!SetVector(table, kNormalX, field)) return false;
  constexpr float kLongest = 1.001F;
  if (const float length = field.norm(); !(length > 0 && length <= kLongest))
    throw table.LineError(Concat("no viewing direction in columns nx, ny, nz: it has length ", length,
                                 ", expected above 0 and at most 1"));
  return true;
}

bool SetRange(const Table& table, MapPoint& point) {
  const bool nearest = Set(table, kNearest, point.min_distance);
  const bool farthest = Set(table, kFarthest, point.max_distance);
  const auto require = [&](bool set, std::size_t column, float distance) {
    if (set && !(std::isfinite(distance) && distance > 0)) throw table.CellError(column, "a finite distance above 0");
  };
  require(nearest, kNearest, point.min_distance);
  require(farthest, kFarthest, point.max_distance);
  if ((nearest || farthest) && !(point.min_distance <= point.max_distance))
    throw table.LineError(Concat("no range of distances in columns min_distance, max_distance: from ",
                                 point.min_distance, " to ", point.max_distance));
  return nearest || farthest;
}

bool SetPose(const Table& table, Rigid3f& camera_from_world) {
  Rigid3f pose = detail::CameraInWorld(camera_from_world);
  const bool moved = SetNumbers(table, kPose, {pose.translation.data(), 3});
  const bool turned = SetNumbers(table, kPose + 3, {pose.rotation.coeffs().data(), 4});
  if (!moved && !turned) return false;
  RequireFinite(table, kPose, {pose.translation.data(), 3});
  RequireFinite(table, kPose + 3, {pose.rotation.coeffs().data(), 4});
  if (!detail::IsPose(pose))
    throw table.LineError(
        Concat("no rotation in columns qx, qy, qz, qw: it has length ", pose.rotation.norm(), ", expected 1"));
  camera_from_world = pose.Normalized().Inverse();
  return true;
}

bool SetTime(const Table& table, double& timestamp) {
  // Seconds since 1970 of years that have five digits are something else, such as nanoseconds.
  constexpr double kLatest = 2.5e11;
  if (!Set(table, kTimestamp, timestamp)) return false;
  if (!(std::abs(timestamp) < kLatest)) throw table.CellError(kTimestamp, "a time in seconds");
  return true;
}

}  // namespace slamdb::tables
