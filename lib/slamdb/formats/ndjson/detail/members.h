// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>
#include <vector>

#include "slamdb/formats/export/detail/json_appender.h"
#include "slamdb/formats/ndjson/detail/names.h"
#include "slamdb/model/fields.h"

// The fields of fields.h as members of JSON objects.
namespace slamdb::detail {

// A field as a member, whatever its type.
template <class T>
void AppendMember(JsonAppender& json, std::string_view name, const T& value) {
  json.Field(name, value);
}
template <class T, class Allocator>
void AppendMember(JsonAppender& json, std::string_view name, const std::vector<T, Allocator>& values) {
  json.Array(name, values);
}
inline void AppendMember(JsonAppender& json, std::string_view name, MatrixForm form) { json.Field(name, NameOf(form)); }
inline void AppendMember(JsonAppender& json, std::string_view name, CameraModel model) {
  json.Field(name, NameOf(model));
}
void AppendMember(JsonAppender& json, std::string_view name, const Column<Keypoint>& keypoints);
void AppendMember(JsonAppender& json, std::string_view name, const Column<Connection>& connections);
void AppendMember(JsonAppender& json, std::string_view name, const Column<Observation>& observations);
void AppendMember(JsonAppender& json, std::string_view name, const Column<ImuMeasurement>& measurements);
void AppendMember(JsonAppender& json, std::string_view name, const std::vector<RepeatedEntry>& entries);
void AppendMember(JsonAppender& json, std::string_view name, const std::vector<LandmarkFeature>& features);
void AppendMember(JsonAppender& json, std::string_view name, const Boxed<Carried>& carried);  // nothing for null

// Members by dotted names: `features.grid.cell_sizes` is a member of an object in an object. Names that begin alike
// must follow each other.
class DottedMembers {
 public:
  explicit DottedMembers(JsonAppender& json) : json_(json) {}
  ~DottedMembers() { LeaveTo({}); }
  DottedMembers(const DottedMembers&) = delete;
  DottedMembers& operator=(const DottedMembers&) = delete;

  // Enters the object that the member `name` is in, and returns the member's own name.
  std::string_view Enter(std::string_view name);

  template <class T>
  void Append(std::string_view name, const T& value) {
    const std::string_view own = Enter(name);
    AppendMember(json_, own, value);
  }

 private:
  void LeaveTo(std::string_view object);

  JsonAppender& json_;
  std::string_view object_;  // that is open: `features.grid`
};

}  // namespace slamdb::detail
