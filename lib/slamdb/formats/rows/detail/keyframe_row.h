// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "slamdb/formats/rows/detail/columns.h"
#include "slamdb/model/detail/packing.h"
#include "slamdb/model/detail/record.h"
#include "slamdb/model/keyframe.h"

// A keyframe without features and links as a row of the table `keyframe`.
namespace slamdb::rows {

// Which row it is, and what stands beside it.
struct KeyframeKeys {
  std::int64_t row = 0, map = 0, atlas = 0;
  bool unique = true;  // the first of its id in the list
  std::int64_t hash = 0, links_hash = 0;
};

// The columns of the table, in its order. What it gives is valid until it is asked again.
class KeyframeRow {
 public:
  static constexpr std::size_t kColumns = 42;
  const std::array<Value, kColumns>& Of(const KeyframeKeys& keys, const KeyFrame& keyframe);

 private:
  std::array<Value, kColumns> columns_;
  detail::ByteWriter details_, exact_;
};

namespace keyframe_row {

// The columns from `timestamp` on, and `exact`. False: what stands in them is not what is in `exact`.
template <class Columns>
bool ReadReals(const Columns& row, int timestamp_column, int exact_column, KeyFrame& keyframe) {
  detail::KeyframeReals reals;
  bool same = true;
  const Bytes exact = row.Blob(exact_column);
  if (!exact.empty()) {
    detail::ByteReader in(exact);
    std::array timestamp{in.Get<double>()};
    reals = in.Get<detail::KeyframeReals>();
    in.ExpectEnd();
    same = TakeColumns(row, timestamp_column, timestamp);
    same = TakeColumns(row, timestamp_column + 1, reals) && same;
    keyframe.timestamp = timestamp[0];
  } else {
    keyframe.timestamp = row.Real(timestamp_column);
    for (std::size_t i = 0; i < reals.size(); ++i) {
      reals[i] = static_cast<float>(row.Real(timestamp_column + 1 + static_cast<int>(i)));
    }
  }
  detail::SetReals(keyframe, reals);
  return same;
}

}  // namespace keyframe_row

// What ReadKeyframe takes, in this order.
inline constexpr const char* kKeyframeColumns =
    "row, id, hash, links_hash, frame_id, timestamp, qw, qx, qy, qz, tx, ty, tz, vx, vy, vz, bias_ax, bias_ay, "
    "bias_az, bias_wx, bias_wy, bias_wz, camera, right_camera, parent, previous, next, origin_map, features, "
    "left_features, right_features, first_connection, not_erase, to_be_erased, bad, imu_initialized, has_velocity, "
    "details, exact";

// False: the numbers in its columns are not those in `exact`. Throws Error where a blob is damaged.
template <class Columns>
bool ReadKeyframe(const Columns& row, KeyFrame& keyframe) {
  keyframe.id = KeyFrameId(static_cast<std::uint64_t>(row.Integer(1)));
  keyframe.frame_id = static_cast<std::uint64_t>(row.Integer(4));
  const bool same = keyframe_row::ReadReals(row, 5, 38, keyframe);
  keyframe.camera = FromReference<CameraId>(row, 22);
  keyframe.right_camera = FromReference<CameraId>(row, 23);
  keyframe.parent = FromReference<KeyFrameId>(row, 24);
  keyframe.previous = FromReference<KeyFrameId>(row, 25);
  keyframe.next = FromReference<KeyFrameId>(row, 26);
  keyframe.origin_map = static_cast<std::uint32_t>(row.Integer(27));
  keyframe.features.count = static_cast<std::int32_t>(row.Integer(28));
  keyframe.features.left_count = static_cast<std::int32_t>(row.Integer(29));
  keyframe.features.right_count = static_cast<std::int32_t>(row.Integer(30));
  int column = 31;
  for (Flag* flag : {&keyframe.first_connection, &keyframe.not_erase, &keyframe.to_be_erased, &keyframe.bad,
                     &keyframe.imu_initialized, &keyframe.has_velocity}) {
    flag->recorded = static_cast<std::uint8_t>(row.Integer(column++));
  }
  detail::DecodeDetails(row.Blob(37), keyframe);
  return same;
}

// How many rows of keyframe_link a keyframe has.
inline std::size_t CountLinks(const KeyFrame& keyframe) {
  return keyframe.children.size() + keyframe.connections.size() + keyframe.loop_edges.size() +
         keyframe.merge_edges.size();
}

}  // namespace slamdb::rows
