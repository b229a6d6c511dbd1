// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstring>
#include <deque>
#include <type_traits>

#include "slamdb/formats/rows/detail/columns.h"
#include "slamdb/model/map_point.h"

// A map point without its observations as a row of the table `map_point`.
namespace slamdb::rows {

// Which row it is, and what stands beside it.
struct PointKeys {
  std::int64_t row = 0, map = 0;
  bool unique = true;  // the first of its id in the list
  std::int64_t hash = 0, observations_hash = 0;
};

// The columns of the table, in its order. Blobs in them are valid as long as the point and this are.
class PointRow {
 public:
  static constexpr std::size_t kColumns = 26;
  std::array<Value, kColumns> Of(const PointKeys& keys, const MapPoint& point) {
    const Reals reals{point.position.x(), point.position.y(), point.position.z(), point.normal.x(),
                      point.normal.y(),   point.normal.z(),   point.min_distance, point.max_distance};
    return {keys.row,
            keys.map,
            ToColumn(point.id),
            ValueOrNull(keys.unique ? ToReference(point.id) : std::nullopt),
            keys.hash,
            keys.observations_hash,
            reals[0],
            reals[1],
            reals[2],
            reals[3],
            reals[4],
            reals[5],
            reals[6],
            reals[7],
            ValueOrNull(ToReference(point.reference)),
            ValueOrNull(ToReference(point.replaced_by)),
            point.first_keyframe,
            point.first_frame,
            std::int64_t{point.observation_count},
            std::int64_t{point.bad.recorded},
            Bytes(std::as_bytes(std::span(point.descriptor))),
            std::int64_t{static_cast<std::uint8_t>(point.descriptor_form)},
            ExactOf(reals),
            Recorded(point.origin_map, MapPoint::kNoOrigin),
            Recorded(point.visible_count, MapPoint::kNoCount),
            Recorded(point.found_count, MapPoint::kNoCount)};
  }

 private:
  using Reals = std::array<float, 8>;

  // What REAL columns do not keep.
  Value ExactOf(const Reals& reals) {
    if (std::ranges::all_of(reals, [](float value) { return FitsReal(value); })) return Value();
    return Bytes(std::as_bytes(std::span(exact_.emplace_back(reals))));
  }
  template <class Integer>
  static Value Recorded(Integer value, Integer not_recorded) {
    return value == not_recorded ? Value() : Value(std::int64_t{value});
  }

  std::deque<Reals> exact_;
};

// What ReadPoint takes, in this order, before what versions of the schema brought later.
inline constexpr const char* kPointColumns =
    "row, id, hash, observations_hash, x, y, z, nx, ny, nz, min_distance, max_distance, reference, replaced_by, "
    "first_keyframe, first_frame, observation_count, bad, descriptor, exact, descriptor_form";
inline constexpr const char* kPointTrackingColumns = "origin_map, visible_count, found_count";

// False: the numbers in its columns are not those in `exact`. Throws what `damaged()` gives where a blob is of a wrong
// length.
template <class Columns, class Damaged>
bool ReadPoint(const Columns& row, MapPoint& point, const Damaged& damaged) {
  bool same = true;
  point.id = MapPointId(static_cast<std::uint64_t>(row.Integer(1)));
  std::array<float, 8> reals;
  const Bytes exact = row.Blob(19);
  if (!exact.empty()) {
    if (exact.size() != sizeof(reals)) throw damaged();
    std::memcpy(reals.data(), exact.data(), sizeof(reals));
    same = TakeColumns(row, 4, reals);
  } else {
    for (std::size_t i = 0; i < reals.size(); ++i) reals[i] = static_cast<float>(row.Real(4 + static_cast<int>(i)));
  }
  point.position = {reals[0], reals[1], reals[2]};
  point.normal = {reals[3], reals[4], reals[5]};
  point.min_distance = reals[6];
  point.max_distance = reals[7];
  point.reference = FromReference<KeyFrameId>(row, 12);
  point.replaced_by = FromReference<MapPointId>(row, 13);
  point.first_keyframe = row.Integer(14);
  point.first_frame = row.Integer(15);
  point.observation_count = static_cast<std::int32_t>(row.Integer(16));
  point.bad.recorded = static_cast<std::uint8_t>(row.Integer(17));
  const Bytes descriptor = row.Blob(18);
  if (descriptor.size() != point.descriptor.size()) throw damaged();
  std::memcpy(point.descriptor.data(), descriptor.data(), descriptor.size());
  point.descriptor_form = static_cast<MatrixForm>(row.Integer(20) & 3);
  const auto read_recorded = [&row](int column, auto& value) {  // NULL: it stays what it is, not recorded
    if (!row.IsNull(column)) value = static_cast<std::remove_reference_t<decltype(value)>>(row.Integer(column));
  };
  read_recorded(21, point.origin_map);
  read_recorded(22, point.visible_count);
  read_recorded(23, point.found_count);
  return same;
}

}  // namespace slamdb::rows
