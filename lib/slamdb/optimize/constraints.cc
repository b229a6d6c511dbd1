// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/parse_file.h"
#include "slamdb/base/detail/pose_columns.h"
#include "slamdb/base/detail/table.h"
#include "slamdb/model/detail/is_pose.h"
#include "slamdb/optimize/pose_graph.h"

namespace slamdb {
namespace {

enum Columns : std::size_t { kFirst, kSecond, kPosition, kRotation = kPosition + 3, kScale = kRotation + 4 };

const detail::TableKind& ConstraintTable() {
  using detail::PositionColumn, detail::QuaternionColumn;
  static const detail::TableKind kind = {
      .columns = {{{"first", "first_keyframe", "first_kf"}},
                  {{"second", "second_keyframe", "second_kf"}},
                  PositionColumn(0),
                  PositionColumn(1),
                  PositionColumn(2),
                  QuaternionColumn(0),
                  QuaternionColumn(1),
                  QuaternionColumn(2),
                  QuaternionColumn(3),
                  {{"scale"}, 1}},
      .expected = "the columns first,second of keyframes and tx,ty,tz,qx,qy,qz,qw[,scale] of the second in the first"};
  return kind;
}

}  // namespace

std::string_view NameOf(PoseFreedom freedom) {
  switch (freedom) {
    case PoseFreedom::kSimilarity:
      return "similarity";
    case PoseFreedom::kRigid:
      return "rigid";
    case PoseFreedom::kUpright:
      return "upright";
  }
  return "?";
}

std::vector<PoseConstraint> ParseConstraints(std::string_view csv) {
  std::vector<PoseConstraint> constraints;
  detail::Table table(csv, ConstraintTable());
  while (table.Next()) {
    const auto number = [&](std::size_t column) { return table.Get<double>(column); };
    PoseConstraint& constraint = constraints.emplace_back();
    constraint.first = KeyFrameId(table.Get<std::uint64_t>(kFirst));
    constraint.second = KeyFrameId(table.Get<std::uint64_t>(kSecond));
    Similarity3d& transform = constraint.first_from_second;
    transform.translation = {number(kPosition), number(kPosition + 1), number(kPosition + 2)};
    transform.rotation =
        Eigen::Quaterniond(number(kRotation + 3), number(kRotation), number(kRotation + 1), number(kRotation + 2));
    if (!table.Raw(kScale).empty()) transform.scale = number(kScale);
    if (!detail::IsNearUnit(transform.rotation)) throw table.LineError("the quaternion is not of length 1");
    transform.rotation.normalize();
  }
  return constraints;
}

std::vector<PoseConstraint> ReadConstraints(const std::string& path, Notices* notices) {
  Notices unheard;
  std::vector<PoseConstraint> constraints =
      detail::ParseLines(path, "a table of constraints", notices == nullptr ? unheard : *notices, ParseConstraints);
  if (constraints.empty()) throw Error(ErrorKind::kDamaged, path, "", "has no constraint");
  return constraints;
}

}  // namespace slamdb
