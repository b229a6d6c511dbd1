// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/error.h"
#include "slamdb/formats/format.h"
#include "tests/formats/formats/in_memory.h"

namespace slamdb {

// Bytes of numbers one behind the other, in either order.
class CloudBytes {
 public:
  explicit CloudBytes(bool big_endian = false) : big_endian_(big_endian) {}

  template <class Number>
  CloudBytes& Add(Number value) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    if (big_endian_) std::reverse(std::begin(bytes), std::end(bytes));
    text_.append(bytes, sizeof value);
    return *this;
  }
  const std::string& text() const { return text_; }

 private:
  bool big_endian_;
  std::string text_;
};

struct ReadCloud {
  Atlas atlas;
  Notices notices;

  const MapPoint& point(std::size_t row) const { return atlas.maps.at(0).points.at(row); }
  Eigen::Vector3f position(std::size_t row) const { return point(row).position; }
  bool Tells(Notice::Kind kind, std::string_view part) const {
    return std::ranges::any_of(notices.items(), [&](const Notice& notice) {
      return notice.kind == kind && notice.text.find(part) != std::string::npos;
    });
  }
};

inline ReadCloud ReadAsCloud(const Format& format, std::string_view bytes, const ReadOptions& options = {}) {
  ReadCloud read;
  read.atlas = format.read({std::as_bytes(std::span(bytes)), "cloud"}, options, read.notices);
  return read;
}

// The error of reading; nothing when it was read.
inline std::optional<Error> CloudError(const Format& format, std::string_view bytes) {
  try {
    (void)Decoded(format, bytes);
  } catch (const Error& error) {
    return error;
  }
  return std::nullopt;
}

// What a cloud holds of an atlas: what must come back to the last bit. Bad points are left out.
inline Atlas PointsAlone(const Atlas& atlas) {
  Atlas points;
  for (const Map& from : atlas.maps) {
    Map map;
    map.id = from.id;
    for (const MapPoint& point : from.points) {
      if (point.bad) continue;
      MapPoint& kept = map.points.emplace_back();
      kept.id = point.id;
      kept.position = point.position;
      kept.normal = point.normal;
      kept.min_distance = point.min_distance;
      kept.max_distance = point.max_distance;
      kept.descriptor_form = MatrixForm::kEmpty;
    }
    if (!map.points.empty()) points.maps.push_back(std::move(map));
  }
  return points;
}

}  // namespace slamdb
