// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/trajectory/detail/quaternion_order.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/median.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/trajectory/detail/pose_table.h"

namespace slamdb::detail {
namespace {

struct Row {
  Eigen::Vector3d position;
  Eigen::Vector4d numbers;  // of the quaternion, as they stand
};

Eigen::Quaterniond RotationOf(const Row& row, PoseLayout layout) {
  const Eigen::Vector4d& n = row.numbers;
  return (layout == PoseLayout::kEuroc ? Eigen::Quaterniond(n[0], n[1], n[2], n[3])
                                       : Eigen::Quaterniond(n[3], n[0], n[1], n[2]))
      .normalized();
}

double TurnInDegrees(const Row& row, PoseLayout layout) {
  return 2 * std::acos(std::min(1.0, std::abs(RotationOf(row, layout).w()))) * 180 / std::numbers::pi;
}

std::vector<Row> RowsOf(Table& table) {
  std::vector<Row> rows;
  while (table.Next()) {
    Row row;
    for (int i = 0; i < 3; ++i) row.position[i] = table.Get<double>(static_cast<std::size_t>(1 + i));
    for (int i = 0; i < 4; ++i) row.numbers[i] = table.Get<double>(static_cast<std::size_t>(4 + i));
    if (row.position.allFinite() && row.numbers.allFinite() && row.numbers.norm() > 0) rows.push_back(row);
  }
  return rows;
}

// Many recordings begin where they say that they are not turned; in the other order that is half a turn.
std::optional<PoseLayout> ByTheStart(const Row& first) {
  constexpr double kNearlyNone = 20;  // degrees
  for (const PoseLayout layout : {PoseLayout::kTum, PoseLayout::kEuroc})
    if (TurnInDegrees(first, layout) <= kNearlyNone) return layout;
  return std::nullopt;
}

// How much the directions in which a camera moves are the same as seen by itself: 1 when it always goes ahead.
double Steadiness(const std::vector<Row>& rows, const std::vector<std::size_t>& steps, PoseLayout layout) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const std::size_t i : steps)
    sum += RotationOf(rows[i], layout).conjugate() * (rows[i + 1].position - rows[i].position).normalized();
  return sum.norm() / static_cast<double>(steps.size());
}

// Whoever carries a camera mostly goes one way, as seen by it. How far poses turn from one to the next is the same in
// both orders and tells nothing.
std::optional<PoseLayout> ByTheMotion(const std::vector<Row>& rows) {
  constexpr std::size_t kEnough = 10;
  constexpr double kSteady = 0.6, kMoreSteady = 0.2, kHardlyMore = 0.05, kTimesSteadier = 3;
  std::vector<double> lengths;
  for (std::size_t i = 0; i + 1 < rows.size(); ++i) lengths.push_back((rows[i + 1].position - rows[i].position).norm());
  if (lengths.size() < kEnough) return std::nullopt;
  const double usual = MedianOf(lengths);
  std::vector<std::size_t> steps;
  for (std::size_t i = 0; i < lengths.size(); ++i)
    if (lengths[i] > 0 && lengths[i] > usual / 4) steps.push_back(i);
  if (steps.size() < kEnough) return std::nullopt;
  const double last = Steadiness(rows, steps, PoseLayout::kTum), first = Steadiness(rows, steps, PoseLayout::kEuroc);
  const double more = std::max(last, first), less = std::min(last, first);
  const bool clear = more >= kSteady && more - less >= kMoreSteady;
  const bool one_way = more - less >= kHardlyMore && kTimesSteadier * (1 - more) <= 1 - less;
  if (!clear && !one_way) return std::nullopt;
  return last > first ? PoseLayout::kTum : PoseLayout::kEuroc;
}

std::string_view OrderIn(PoseLayout layout) { return layout == PoseLayout::kEuroc ? "w x y z" : "x y z w"; }

std::string Reading(const Row& first, PoseLayout layout) {
  return Concat(OrderIn(layout), layout == PoseLayout::kEuroc ? " (euroc)" : " (tum)", ", the first pose turned by ",
                Fixed(TurnInDegrees(first, layout), 0), " degrees");
}

}  // namespace

PoseLayout LayoutOfRows(std::string_view text, PoseLayout layout, std::string_view path, Notices& notices) {
  const TableGlance glance = GlanceAtTable(text, PoseTable(layout));
  if (glance.named || glance.numbers < 8) return layout;
  Table table(text, PoseTable(layout));
  const std::vector<Row> rows = RowsOf(table);
  if (rows.empty()) return layout;
  const auto start = ByTheStart(rows[0]), motion = ByTheMotion(rows);
  const bool contradict = start && motion && *start != *motion;
  if (IsBlank(glance.separator)) {
    if (motion && *motion != layout && !contradict)
      notices.Warn(
          Concat("no line names the columns, and between blanks quaternions are x y z w, as in tum; but as w x y z "
                 "the camera would go more steadily one way: if they are that, name the columns, or give "
                 "ReadOptions::format euroc"));
    return layout;
  }
  auto order = contradict ? std::nullopt : start ? start : motion;
  if (layout == PoseLayout::kEuroc && !contradict && order != PoseLayout::kTum) return layout;
  if (!start && !motion && path.ends_with(".tum")) order = PoseLayout::kTum;
  if (!start && !motion && path.ends_with(".euroc.csv")) order = PoseLayout::kEuroc;
  if (!order || layout == PoseLayout::kEuroc)
    throw Error(ErrorKind::kNotPossible, "", "line 1",
                Concat("no line names the columns, and between commas quaternions are written in two orders: here as ",
                       Reading(rows[0], PoseLayout::kTum), ", or as ", Reading(rows[0], PoseLayout::kEuroc),
                       "; ReadOptions::format tum or euroc settles it, or a first line that names the columns"));
  notices.Note(Concat("no line names the columns: quaternions are taken as ", OrderIn(*order), ", with which ",
                      start    ? "the first pose is hardly turned"
                      : motion ? "the camera goes steadily one way"
                               : "the name of the file agrees"));
  return *order;
}

}  // namespace slamdb::detail
