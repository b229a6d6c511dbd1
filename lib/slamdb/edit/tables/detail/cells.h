// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "slamdb/base/detail/table.h"
#include "slamdb/model/atlas.h"

// The columns of tables of points and keyframes, and what their cells say of a field. Errors name line and column.
namespace slamdb::tables {

enum PointColumn : std::size_t {
  kPointId,
  kPointMap,
  kX,
  kNormalX = kX + 3,
  kReference = kNormalX + 3,
  kNearest,
  kFarthest,
  kPointBad
};

enum KeyFrameColumn : std::size_t {
  kKeyFrameId,
  kKeyFrameMap,
  kTimestamp,
  kFrameId,
  kPose,
  kVelocity = kPose + 7,
  kNotErase = kVelocity + 3,
  kKeyFrameBad
};

const detail::TableKind& PointTable();
const detail::TableKind& KeyFrameTableKind();

// The columns that are of no field. Throws Error when the table is of the other kind, or in other units.
std::vector<std::string> IgnoredColumnsOfPoints(const detail::Table& table);
std::vector<std::string> IgnoredColumnsOfKeyFrames(const detail::Table& table);

inline bool SameNumber(auto a, auto b) { return a == b || (a != a && b != b); }

// Whether the cell says something else than the field has, which it then has.
template <class Number>
bool Set(const detail::Table& table, std::size_t column, Number& field) {
  if (table.Raw(column).empty()) return false;
  const auto value = table.Get<Number>(column);
  if (SameNumber(value, field)) return false;
  field = value;
  return true;
}

bool Set(const detail::Table& table, std::size_t column, KeyFrameId& field);
bool Set(const detail::Table& table, std::size_t column, Flag& field);
// The same of three numbers from the column on.
bool SetVector(const detail::Table& table, std::size_t first, Eigen::Vector3f& field);

// What turns bad is dropped: ORB-SLAM3 saves nothing that is, and reading something that refers to it crashes.
// Whether something is no longer bad.
bool SetBad(const detail::Table& table, std::size_t column, Flag& bad, std::uint8_t& dropped);

// Whether any of so many cells from the column on says something.
bool SaysAny(const detail::Table& table, std::size_t first, std::size_t count);

bool SetNormal(const detail::Table& table, Eigen::Vector3f& field);
// The range of distances from which a point is looked for.
bool SetRange(const detail::Table& table, MapPoint& point);
// The poses that tables hold are those of the camera in the world.
bool SetPose(const detail::Table& table, Rigid3f& camera_from_world);
bool SetTime(const detail::Table& table, double& timestamp);

}  // namespace slamdb::tables
