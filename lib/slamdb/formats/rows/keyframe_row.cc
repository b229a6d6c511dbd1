// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/rows/detail/keyframe_row.h"

namespace slamdb::rows {

const std::array<Value, KeyframeRow::kColumns>& KeyframeRow::Of(const KeyframeKeys& keys, const KeyFrame& keyframe) {
  std::size_t next = 0;
  const auto put = [&](const Value& value) { columns_[next++] = value; };
  put(keys.row);
  put(keys.map);
  put(keys.atlas);
  put(ToColumn(keyframe.id));
  put(ValueOrNull(keys.unique ? ToReference(keyframe.id) : std::nullopt));
  put(keys.hash);
  put(keys.links_hash);
  put(ToColumn(keyframe.frame_id));
  const detail::KeyframeReals reals = detail::RealsOf(keyframe);
  bool fits = FitsReal(keyframe.timestamp);
  put(keyframe.timestamp);
  for (const float real : reals) {
    fits = fits && FitsReal(real);
    put(static_cast<double>(real));
  }
  put(ValueOrNull(ToReference(keyframe.camera)));
  put(ValueOrNull(ToReference(keyframe.right_camera)));
  put(ValueOrNull(ToReference(keyframe.parent)));
  put(ValueOrNull(ToReference(keyframe.previous)));
  put(ValueOrNull(ToReference(keyframe.next)));
  put(std::int64_t{keyframe.origin_map});
  const Features& features = keyframe.features;
  for (const std::int32_t count : {features.count, features.left_count, features.right_count}) put(std::int64_t{count});
  for (const Flag flag : {keyframe.first_connection, keyframe.not_erase, keyframe.to_be_erased, keyframe.bad,
                          keyframe.imu_initialized, keyframe.has_velocity})
    put(std::int64_t{flag.recorded});
  details_.Clear();
  detail::EncodeDetails(keyframe, details_);
  put(details_.bytes());
  exact_.Clear();
  exact_.Put(keyframe.timestamp);
  exact_.PutBytes(std::as_bytes(std::span(reals)));
  put(fits ? Value() : Value(exact_.bytes()));
  return columns_;
}

}  // namespace slamdb::rows
