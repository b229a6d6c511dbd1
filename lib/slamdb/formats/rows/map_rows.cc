// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/rows/detail/map_rows.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>

namespace slamdb::rows {
namespace {

std::string ParametersAsJson(const std::vector<float>& parameters) {
  std::string json = "[";
  for (const float value : parameters) {
    if (json.size() > 1) json += ',';
    std::array<char, 64> text{};
    if (std::isfinite(value)) {
      json.append(text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr);
    } else {
      json += "null";
    }
  }
  return json + "]";
}

// Whether the columns keep all of a camera.
bool Fits(const Camera& camera) {
  return FitsReal(camera.precision) &&
         std::ranges::all_of(camera.parameters, [](float value) { return FitsReal(value) && std::isfinite(value); });
}

}  // namespace

CameraRows::CameraRows(std::int64_t atlas, const std::vector<Camera>& cameras) {
  parameters_.reserve(cameras.size());  // rows point into it
  exact_.reserve(cameras.size());
  std::vector<CameraId> seen;
  for (const Camera& camera : cameras) {
    const bool unique = std::ranges::find(seen, camera.id) == seen.end() && camera.id.has_value();
    seen.push_back(camera.id);
    parameters_.push_back(ParametersAsJson(camera.parameters));
    std::vector<float>& exact = exact_.emplace_back(1, camera.precision);
    exact.insert(exact.end(), camera.parameters.begin(), camera.parameters.end());
    rows_.push_back({atlas, static_cast<std::int64_t>(rows_.size()), ToColumn(camera.id),
                     ValueOrNull(unique ? ToReference(camera.id) : std::nullopt),
                     std::int64_t{static_cast<std::uint32_t>(camera.model)}, std::int64_t{camera.recorded_type},
                     std::string_view(parameters_.back()), static_cast<double>(camera.precision),
                     Fits(camera) ? Value() : Value(std::as_bytes(std::span(exact)))});
  }
}

std::vector<float> ParseParameters(std::string_view json) {
  std::vector<float> parameters;
  const char* at = json.data();
  const char* end = at + json.size();
  const auto damaged = [] { return Error(ErrorKind::kDamaged, "parameters are no list of numbers"); };
  if (json.size() < 2 || *at++ != '[' || *--end != ']') throw damaged();
  while (at < end) {
    float value = 0;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc() || (next < end && *next != ',')) throw damaged();
    parameters.push_back(value);
    at = next + 1;
  }
  return parameters;
}

void SetExact(Bytes exact, Camera& camera) {
  if (exact.size() % sizeof(float) != 0) throw Error(ErrorKind::kDamaged, "blob of wrong length");
  std::vector<float> values(exact.size() / sizeof(float));
  std::memcpy(values.data(), exact.data(), exact.size());
  camera.precision = values.front();
  camera.parameters.assign(values.begin() + 1, values.end());
}

std::array<Value, 14> MapRow(std::int64_t row, std::int64_t atlas, std::size_t position, const Map& map,
                             std::int64_t hash) {
  return {row,
          atlas,
          static_cast<std::int64_t>(position),
          ToColumn(map.id),
          ValueOrNull(ToReference(map.initial_keyframe)),
          ValueOrNull(ToReference(map.first_keyframe)),
          ValueOrNull(ToReference(map.lowest_keyframe)),
          ToColumn(map.max_keyframe_id),
          std::int64_t{map.big_change_index},
          std::int64_t{map.imu_initialized.recorded},
          std::int64_t{map.inertial.recorded},
          std::int64_t{map.imu_ba1.recorded},
          std::int64_t{map.imu_ba2.recorded},
          hash};
}

std::array<Value, 7> RepeatedRow(std::int64_t atlas, std::string_view list, std::int64_t map, std::size_t sequence,
                                 const RepeatedEntry& entry) {
  const bool null = entry.owner_map == RepeatedEntry::kNull;
  return {atlas,
          list,
          map,
          static_cast<std::int64_t>(sequence),
          ToColumn(entry.position),
          null ? Value() : Value(std::int64_t{entry.owner_map}),
          ToColumn(entry.row)};
}

std::array<Value, 13> HeaderRow(const Atlas& atlas) {
  const Counters& next = atlas.next_ids;
  const ArchiveEncoding& encoding = atlas.encoding;
  return {std::string_view(atlas.vocabulary.name),
          std::string_view(atlas.vocabulary.checksum),
          ToColumn(next.map),
          ToColumn(next.frame),
          ToColumn(next.keyframe),
          ToColumn(next.map_point),
          ToColumn(next.camera),
          ToColumn(next.initial_keyframe),
          std::int64_t{encoding.text},
          std::int64_t{encoding.boost_version},
          std::int64_t{encoding.long_bytes},
          std::int64_t{encoding.size_bytes},
          atlas.layout.empty() ? Value() : Value(std::string_view(atlas.layout))};
}

}  // namespace slamdb::rows
