// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "slamdb/base/error.h"
#include "slamdb/formats/rows/detail/columns.h"
#include "slamdb/model/atlas.h"

// Cameras, maps and what hangs on them as rows of `camera`, `map` and `repeated_entry`. They are few.
namespace slamdb::rows {

// The columns of `camera` for each camera of an atlas.
class CameraRows {
 public:
  static constexpr std::size_t kColumns = 9;
  CameraRows(std::int64_t atlas, const std::vector<Camera>& cameras);
  const std::vector<std::array<Value, kColumns>>& rows() const { return rows_; }

 private:
  std::vector<std::string> parameters_;
  std::vector<std::vector<float>> exact_;
  std::vector<std::array<Value, kColumns>> rows_;
};

// What ReadCamera takes, in this order.
inline constexpr const char* kCameraColumns = "id, model, recorded_type, precision, exact, parameters";

// `[1,2.5]`, and exact as precision and parameters. Throws Error without a place where they are damaged.
std::vector<float> ParseParameters(std::string_view json);
void SetExact(Bytes exact, Camera& camera);

template <class Columns>
Camera ReadCamera(const Columns& row) {
  Camera camera;
  camera.id = CameraId(static_cast<std::uint64_t>(row.Integer(0)));
  const std::int64_t model = row.Integer(1);
  camera.model = model == 2 ? CameraModel::kEquirectangular : static_cast<CameraModel>(model & 1);
  camera.recorded_type = static_cast<std::uint32_t>(row.Integer(2));
  if (const Bytes exact = row.Blob(4); !exact.empty()) {
    SetExact(exact, camera);
  } else {
    camera.precision = static_cast<float>(row.Real(3));
    camera.parameters = ParseParameters(row.Text(5));
  }
  return camera;
}

// The columns of `map` for a map without its lists, but for those that say in which order these are.
std::array<Value, 14> MapRow(std::int64_t row, std::int64_t atlas, std::size_t position, const Map& map,
                             std::int64_t hash);

// What ReadMap takes, in this order.
inline constexpr const char* kMapColumns =
    "id, initial_keyframe, first_keyframe, lowest_keyframe, max_keyframe_id, big_change_index, imu_initialized, "
    "inertial, imu_ba1, imu_ba2, hash";

template <class Columns>
Map ReadMap(const Columns& row) {
  Map map;
  map.id = MapId(static_cast<std::uint64_t>(row.Integer(0)));
  map.initial_keyframe = FromReference<KeyFrameId>(row, 1);
  map.first_keyframe = FromReference<KeyFrameId>(row, 2);
  map.lowest_keyframe = FromReference<KeyFrameId>(row, 3);
  map.max_keyframe_id = static_cast<std::uint64_t>(row.Integer(4));
  map.big_change_index = static_cast<std::int32_t>(row.Integer(5));
  int column = 6;
  for (Flag* flag : {&map.imu_initialized, &map.inertial, &map.imu_ba1, &map.imu_ba2})
    flag->recorded = static_cast<std::uint8_t>(row.Integer(column++));
  return map;
}

// The columns of `repeated_entry`.
std::array<Value, 7> RepeatedRow(std::int64_t atlas, std::string_view list, std::int64_t map, std::size_t sequence,
                                 const RepeatedEntry& entry);

// Of the columns position, owner_map, entry.
template <class Columns>
RepeatedEntry ReadRepeated(const Columns& row) {
  const auto owner = row.IsNull(1) ? RepeatedEntry::kNull : static_cast<std::uint32_t>(row.Integer(1));
  return {static_cast<std::uint64_t>(row.Integer(0)), owner, static_cast<std::uint64_t>(row.Integer(2))};
}

// ---- the atlas itself

// The columns from vocabulary_name to archive_size_bytes, and layout: what of an atlas is no list.
inline constexpr const char* kHeaderColumns =
    "vocabulary_name, vocabulary_checksum, next_map, next_frame, next_keyframe, next_map_point, next_camera, "
    "next_initial_keyframe, archive_text, archive_boost_version, archive_long_bytes, archive_size_bytes, layout";
std::array<Value, 13> HeaderRow(const Atlas& atlas);

template <class Columns>
void ReadHeader(const Columns& row, Atlas& atlas) {
  atlas.vocabulary = {std::string(row.Text(0)), std::string(row.Text(1))};
  int column = 2;
  Counters& next = atlas.next_ids;
  for (std::uint64_t* value :
       {&next.map, &next.frame, &next.keyframe, &next.map_point, &next.camera, &next.initial_keyframe})
    *value = static_cast<std::uint64_t>(row.Integer(column++));
  atlas.encoding.text = row.Integer(8) != 0;
  atlas.encoding.boost_version = static_cast<std::uint32_t>(row.Integer(9));
  atlas.encoding.long_bytes = static_cast<std::uint8_t>(row.Integer(10));
  atlas.encoding.size_bytes = static_cast<std::uint8_t>(row.Integer(11));
  if (!row.IsNull(12)) atlas.layout = row.Text(12);
}

}  // namespace slamdb::rows
