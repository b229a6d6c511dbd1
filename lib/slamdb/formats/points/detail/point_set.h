// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/error.h"
#include "slamdb/formats/format.h"

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
  kDerived,  // what slamdb writes and an atlas of points alone has not: colours, counts, errors
  kUnknown,
};
PointField FieldByName(std::string_view name);

// A column: of which type, and where its numbers are.
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
  // What fits into memory that a file of so many bytes may ask for.
  void Reserve(std::uint64_t points) { points_.reserve(points); }

  void BeginPoint() { now_ = {}; }
  // A number of the point that was begun, as it stands in memory; `swapped`: the other byte order.
  void Set(const CloudColumn& column, const std::byte* number, bool swapped);
  // The same as text; false when it is no number.
  bool Set(const CloudColumn& column, std::string_view number);
  void EndPoint();

  // Maps by their ids, points in the order of the file; names as losses what an atlas has no place for.
  // Points without an id get the number of their row.
  Atlas Finish(const Selection& selection, Notices& notices);

 private:
  struct Row {
    Eigen::Vector3f position = Eigen::Vector3f::Zero(), normal = Eigen::Vector3f::Zero();
    float min_distance = 0, max_distance = 0;
    std::optional<std::uint64_t> map, id;
    bool camera = false;
  };
  void SetReal(PointField field, double value);
  void SetWhole(PointField field, std::optional<std::uint64_t> value);

  const std::string& path_;
  std::string unknown_;
  bool has_ids_ = false, has_doubles_ = false;
  Row now_;
  std::uint64_t row_ = 0, cameras_ = 0;
  std::vector<Row> points_;
};

// A count of rows, of which each takes so many bytes of those that are left. Throws Error (kDamaged) when they do not
// suffice.
void RequireRoom(const std::string& path, std::uint64_t rows, std::uint64_t bytes_of_row, std::uint64_t left);

}  // namespace slamdb::detail
