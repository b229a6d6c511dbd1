// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/ndjson/detail/members.h"

namespace slamdb::detail {
namespace {

constexpr char kDot = '.';

// True when `name` is `object`, or something in it.
bool IsIn(std::string_view name, std::string_view object) {
  return object.empty() || (name.starts_with(object) && (name.size() == object.size() || name[object.size()] == kDot));
}

std::string_view ObjectOf(std::string_view name) {
  const std::size_t dot = name.rfind(kDot);
  return dot == name.npos ? std::string_view() : name.substr(0, dot);
}

// An array with an object for each element, whose members `append(element)` appends.
template <class List, class Append>
void AppendObjects(JsonAppender& json, std::string_view name, const List& list, const Append& append) {
  json.BeginArray(name);
  for (const auto& element : list) {
    json.BeginObject();
    append(element);
    json.EndObject();
  }
  json.EndArray();
}

void AppendSide(JsonAppender& json, std::string_view name, std::int32_t row) {
  if (row != Observation::kAbsent) json.Field(name, row);
}

void AppendType(JsonAppender& json, FeatureType type) {
  const std::string_view name = NameOf(type);
  if (name.empty())
    json.Field("type", static_cast<std::int32_t>(type));
  else
    json.Field("type", name);
}

}  // namespace

void AppendMember(JsonAppender& json, std::string_view name, const Column<Keypoint>& keypoints) {
  json.BeginObject(name);
  json.Array("x", keypoints, [](const Keypoint& keypoint) { return keypoint.x; });
  json.Array("y", keypoints, [](const Keypoint& keypoint) { return keypoint.y; });
  json.Array("size", keypoints, [](const Keypoint& keypoint) { return keypoint.size; });
  json.Array("angle", keypoints, [](const Keypoint& keypoint) { return keypoint.angle; });
  json.Array("response", keypoints, [](const Keypoint& keypoint) { return keypoint.response; });
  json.Array("octave", keypoints, [](const Keypoint& keypoint) { return keypoint.octave; });
  json.Array("class_id", keypoints, [](const Keypoint& keypoint) { return keypoint.class_id; });
  json.EndObject();
}

void AppendMember(JsonAppender& json, std::string_view name, const Column<Connection>& connections) {
  AppendObjects(json, name, connections, [&](const Connection& connection) {
    json.Field("keyframe", connection.keyframe);
    json.Field("weight", connection.weight);
  });
}

void AppendMember(JsonAppender& json, std::string_view name, const Column<Observation>& observations) {
  AppendObjects(json, name, observations, [&](const Observation& observation) {
    json.Field("keyframe", observation.keyframe);
    AppendSide(json, "left", observation.left);
    AppendSide(json, "right", observation.right);
  });
}

void AppendMember(JsonAppender& json, std::string_view name, const Column<ImuMeasurement>& measurements) {
  AppendObjects(json, name, measurements, [&](const ImuMeasurement& measurement) {
    json.Field("acceleration", measurement.acceleration);
    json.Field("angular_velocity", measurement.angular_velocity);
    json.Field("duration", measurement.duration);
  });
}

void AppendMember(JsonAppender& json, std::string_view name, const std::vector<RepeatedEntry>& entries) {
  AppendObjects(json, name, entries, [&](const RepeatedEntry& entry) {
    json.Field("position", entry.position);
    if (entry.owner_map == RepeatedEntry::kNull) return;  // without these two it is a null pointer
    json.Field("owner_map", entry.owner_map);
    json.Field("row", entry.row);
  });
}

void AppendMember(JsonAppender& json, std::string_view name, const std::vector<LandmarkFeature>& features) {
  AppendObjects(json, name, features, [&](const LandmarkFeature& feature) {
    AppendType(json, feature.type);
    ForEachField(&feature, [&](std::string_view field, auto member) {
      const auto& value = feature.*member;
      using Field = std::remove_cvref_t<decltype(value)>;
      if constexpr (std::is_same_v<Field, std::vector<std::uint8_t>>) {
        if (feature.has_patch) json.Hex(field, value.data(), value.size());
      } else if constexpr (std::is_same_v<Field, std::vector<FeatureDescriptor>>) {
        json.BeginObject(field);
        for (const FeatureDescriptor& descriptor : value)
          json.Hex(NameOf(descriptor.kind), descriptor.bytes.data(), descriptor.bytes.size());
        json.EndObject();
      } else if constexpr (!std::is_same_v<Field, FeatureType>) {
        if (field != "has_patch") json.Field(field, value);
      }
    });
  });
}

void AppendMember(JsonAppender& json, std::string_view name, const Boxed<Carried>& carried) {
  if (!carried) return;
  const Matrix& descriptors = carried->descriptors;
  json.BeginObject(name);
  json.Hex("members", carried->members.data(), carried->members.size());
  if (descriptors != Matrix()) {
    json.BeginObject("descriptors");
    json.Field("rows", descriptors.rows);
    json.Field("columns", descriptors.columns);
    json.Field("type", descriptors.type);
    json.Field("continuous", descriptors.continuous);
    json.Hex("bytes", descriptors.data.data(), descriptors.data.size());
    json.EndObject();
  }
  json.EndObject();
}

std::string_view DottedMembers::Enter(std::string_view name) {
  const std::string_view object = ObjectOf(name);
  LeaveTo(object);
  while (object_.size() < object.size()) {
    const std::size_t begin = object_.empty() ? 0 : object_.size() + 1;
    const std::size_t end = std::min(object.find(kDot, begin), object.size());
    json_.BeginObject(object.substr(begin, end - begin));
    object_ = object.substr(0, end);
  }
  return object.empty() ? name : name.substr(object.size() + 1);
}

void DottedMembers::LeaveTo(std::string_view object) {
  for (; !IsIn(object, object_); object_ = ObjectOf(object_)) json_.EndObject();
}

}  // namespace slamdb::detail
