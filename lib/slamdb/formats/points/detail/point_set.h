// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "slamdb/base/error.h"
#include "slamdb/formats/format.h"
#include "slamdb/model/detail/rounding.h"

// Point clouds read as atlases of points alone, to be compared and converted.
namespace slamdb::detail {

// The types of numbers that clouds have.
enum class NumberType : std::uint8_t {
  kInt8,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kInt64,
  kUint64,
  kFloat,
  kDouble
};
std::size_t SizeOf(NumberType type);

// What a column of a cloud is to a point.
enum class PointField : std::uint8_t {
  kX,
  kY,
  kZ,
  kNormalX,
  kNormalY,
  kNormalZ,
  kMinDistance,
  kMaxDistance,
  kMap,
  kId,
  kCamera,   // above 0: no point, but a corner of a camera that is drawn
  kDerived,  // what slamdb writes of keyframes, which are not there: counts, errors
  kColor,    // slamdb's own tell what other columns have, those of others a colour
  kPadding,
  kUnknown,
};
// By the names that slamdb, PCL, and, with `scalar_` before them, CloudCompare give columns.
PointField FieldByName(std::string_view name);

// A column: of which type, and what its numbers are.
struct CloudColumn {
  NumberType type = NumberType::kFloat;
  PointField field = PointField::kUnknown;
  std::string name;
};

// Collects the points of a cloud, number after number.
class PointSet {
 public:
  // Throws Error (kUnsupported) when a coordinate has no column.
  PointSet(const std::string& path, const std::vector<CloudColumn>& columns);
  // `points`: as many as the bytes of the file suffice for.
  void Reserve(std::uint64_t points) { expected_ = points; }

  void BeginPoint() { now_ = {}; }
  // A number of the point that was begun, as it stands in memory; `swapped`: the other byte order.
  // Throws Error (kDamaged) for a coordinate that no float holds.
  void Set(const CloudColumn& column, const std::byte* number, bool swapped);
  // The same as text; false when it is no number.
  bool Set(const CloudColumn& column, std::string_view number);
  // Points without an id get the number of their row. What has neither id nor position is none, as where a depth camera
  // measured nothing.
  // Throws Error (kUnsupported) when there are more maps than any atlas has.
  void EndPoint();

  // Maps in the order in which they came; names as losses what an atlas has no place for, and leaves out points whose
  // id an earlier one of their map has.
  Atlas Finish(const Selection& selection, Notices& notices);

 private:
  struct Row {
    Eigen::Vector3f position = Eigen::Vector3f::Zero(), normal = Eigen::Vector3f::Zero();
    float min_distance = 0, max_distance = 0;
    std::uint64_t map = 0;
    std::optional<std::uint64_t> id;
    bool camera = false;
  };
  void SetReal(PointField field, double value);
  void SetWhole(PointField field, std::optional<std::uint64_t> value);
  Map& MapOf(std::uint64_t id);
  void LeaveOutTwins();
  void Tell(Notices& notices) const;

  const std::string& path_;
  std::string unknown_, derived_;  // names of columns
  bool has_ids_ = false;
  Row now_;
  std::uint64_t row_ = 0, expected_ = 0, cameras_ = 0, empty_ = 0, twins_ = 0;
  Rounding rounding_;
  Atlas atlas_;
  std::unordered_map<std::uint64_t, std::size_t> rows_of_maps_;  // of atlas_.maps, by id
};

// A count of rows, of which each takes so many bytes of those that are left. Throws Error (kDamaged) when they do not
// suffice.
void RequireRoom(const std::string& path, std::uint64_t rows, std::uint64_t bytes_of_row, std::uint64_t left);

}  // namespace slamdb::detail
