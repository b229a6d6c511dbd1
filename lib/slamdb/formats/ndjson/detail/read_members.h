// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include "slamdb/formats/ndjson/detail/json_scanner.h"
#include "slamdb/model/fields.h"

// The fields of fields.h out of members of JSON objects: the way back of members.h.
namespace slamdb::detail {

inline void ReadMember(JsonScanner& json, float& value) { value = json.Float(); }
inline void ReadMember(JsonScanner& json, double& value) { value = json.Double(); }
template <std::integral Integer>
void ReadMember(JsonScanner& json, Integer& value) {
  value = json.Whole<Integer>();
}
inline void ReadMember(JsonScanner& json, std::string& text) { text = json.Text(); }
void ReadMember(JsonScanner& json, bool& value);
void ReadMember(JsonScanner& json, Flag& flag);
void ReadMember(JsonScanner& json, MatrixForm& form);
void ReadMember(JsonScanner& json, CameraModel& model);
void ReadMember(JsonScanner& json, FeatureType& type);
void ReadMember(JsonScanner& json, Rigid3f& transform);
void ReadMember(JsonScanner& json, Descriptor& descriptor);
void ReadMember(JsonScanner& json, Connection& connection);
void ReadMember(JsonScanner& json, Observation& observation);
void ReadMember(JsonScanner& json, ImuMeasurement& measurement);
void ReadMember(JsonScanner& json, RepeatedEntry& entry);
void ReadMember(JsonScanner& json, LandmarkFeature& feature);
void ReadMember(JsonScanner& json, Column<Keypoint>& keypoints);
void ReadMember(JsonScanner& json, std::vector<FeatureDescriptor>& descriptors);
void ReadMember(JsonScanner& json, Boxed<Carried>& carried);

template <class Entity>
void ReadMember(JsonScanner& json, Id<Entity>& id) {
  if (json.TakeNull()) {
    id = {};
    return;
  }
  id = Id<Entity>(json.Whole<std::uint64_t>());
  if (!id) json.Refuse("is no id, which are below 18446744073709551615; null is none");
}

// Row after row.
template <class Scalar, int kRows, int kColumns>
void ReadMember(JsonScanner& json, Eigen::Matrix<Scalar, kRows, kColumns>& matrix) {
  Eigen::Index place = 0;
  json.Array([&] {
    if (place == kRows * kColumns) json.Refuse(Concat("more elements than ", kRows * kColumns));
    ReadMember(json, matrix(place / kColumns, place % kColumns));
    ++place;
  });
  if (place != kRows * kColumns) json.Refuse(Concat("expected ", kRows * kColumns, " elements, found ", place));
}

template <class T, class Allocator>
void ReadMember(JsonScanner& json, std::vector<T, Allocator>& values) {
  values.clear();
  json.Array([&] {
    T value{};
    ReadMember(json, value);
    values.push_back(std::move(value));
  });
}

// The data of a matrix: 32-bit floats as numbers under this name, any other type as bytes.
inline constexpr std::string_view kMatrixValues = "distortion.values", kMatrixBytes = "distortion.bytes";
void ReadMember(JsonScanner& json, Column<std::byte>& floats);
void ReadMatrixBytes(JsonScanner& json, Column<std::byte>& bytes);

// Throws Error with the place when a matrix does not have as much data as its rows, columns and type say.
void RequireSound(JsonScanner& json, std::string_view name, const Matrix& matrix);

// Bytes as hex digits.
void ReadHex(JsonScanner& json, std::vector<std::uint8_t>& bytes);

// The members of a small object by their names; those that are optional may be missing.
struct Presence {
  std::string_view name;
  bool optional = false;
};
template <std::size_t kCount, class Read>
void ReadObject(JsonScanner& json, const std::array<Presence, kCount>& members, const Read& read) {
  std::array<bool, kCount> seen{};
  json.Object([&](std::string_view name) {
    const std::size_t which =
        static_cast<std::size_t>(std::ranges::find(members, name, &Presence::name) - members.begin());
    if (which == kCount) json.Refuse("there is no such member");
    if (std::exchange(seen[which], true)) json.Refuse("stands there twice");
    read(which);
  });
  for (std::size_t i = 0; i < kCount; ++i)
    if (!seen[i] && !members[i].optional) json.Refuse(Concat("the member `", members[i].name, "` is missing"));
}

}  // namespace slamdb::detail
