// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/mcap/detail/schemas.h"

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/export/detail/protobuf.h"

namespace slamdb::detail {
namespace {

// FieldDescriptorProto::Type.
enum class Type {
  kDouble = 1,
  kInt64 = 3,
  kInt32 = 5,
  kFixed32 = 7,
  kBool = 8,
  kString = 9,
  kMessage = 11,
  kBytes = 12,
  kEnum = 14
};

struct Field {
  std::string_view name;
  int number;
  Type type;
  std::string_view of{};  // the message, or the enumeration in this message
  bool repeated = false;
};

struct Enumeration {
  std::string_view name;
  std::span<const std::string_view> values;  // 0, 1, ...
};

// A message, alone in a file.
struct Message {
  std::string_view name;  // with its package
  std::vector<Field> fields;
  Enumeration enumeration{};  // in it; without name: none
};

constexpr std::string_view kTimestamp = "google.protobuf.Timestamp", kDuration = "google.protobuf.Duration";
constexpr std::string_view kVector3 = "foxglove.Vector3", kPoint3 = "foxglove.Point3", kColor = "foxglove.Color";
constexpr std::string_view kPose = "foxglove.Pose", kQuaternion = "foxglove.Quaternion";
constexpr std::array<std::string_view, 9> kNumericTypes = {"UNKNOWN", "UINT8", "INT8",    "UINT16", "INT16",
                                                           "UINT32",  "INT32", "FLOAT32", "FLOAT64"};
constexpr std::array<std::string_view, 3> kLineTypes = {"LINE_STRIP", "LINE_LOOP", "LINE_LIST"};
constexpr std::array<std::string_view, 2> kDeletionTypes = {"MATCHING_ID", "ALL"};

Field Of(std::string_view name, int number, std::string_view message) {
  return {name, number, Type::kMessage, message};
}
Field ListOf(std::string_view name, int number, std::string_view message) {
  return {name, number, Type::kMessage, message, true};
}

std::vector<Field> Doubles(std::string_view names) {
  std::vector<Field> fields;
  for (std::size_t i = 0; i < names.size(); ++i)
    fields.push_back({names.substr(i, 1), static_cast<int>(i) + 1, Type::kDouble});
  return fields;
}

std::vector<Message> BasicMessages() {
  return {
      {kTimestamp, {{"seconds", 1, Type::kInt64}, {"nanos", 2, Type::kInt32}}},
      {kDuration, {{"seconds", 1, Type::kInt64}, {"nanos", 2, Type::kInt32}}},
      {kVector3, Doubles("xyz")},
      {kPoint3, Doubles("xyz")},
      {kQuaternion, Doubles("xyzw")},
      {kColor, Doubles("rgba")},
      {kPose, {Of("position", 1, kVector3), Of("orientation", 2, kQuaternion)}},
      {"foxglove.PackedElementField",
       {{"name", 1, Type::kString}, {"offset", 2, Type::kFixed32}, {"type", 3, Type::kEnum, "NumericType"}},
       {"NumericType", kNumericTypes}},
      {"foxglove.PointCloud",
       {Of("timestamp", 1, kTimestamp),
        {"frame_id", 2, Type::kString},
        Of("pose", 3, kPose),
        {"point_stride", 4, Type::kFixed32},
        ListOf("fields", 5, "foxglove.PackedElementField"),
        {"data", 6, Type::kBytes}}},
      {"foxglove.PosesInFrame",
       {Of("timestamp", 1, kTimestamp), {"frame_id", 2, Type::kString}, ListOf("poses", 3, kPose)}},
      {"foxglove.FrameTransform",
       {Of("timestamp", 1, kTimestamp),
        {"parent_frame_id", 2, Type::kString},
        {"child_frame_id", 3, Type::kString},
        Of("translation", 4, kVector3),
        Of("rotation", 5, kQuaternion)}},
      {"foxglove.CameraCalibration",
       {Of("timestamp", 1, kTimestamp),
        {"frame_id", 9, Type::kString},
        {"width", 2, Type::kFixed32},
        {"height", 3, Type::kFixed32},
        {"distortion_model", 4, Type::kString},
        {"D", 5, Type::kDouble, {}, true},
        {"K", 6, Type::kDouble, {}, true},
        {"R", 7, Type::kDouble, {}, true},
        {"P", 8, Type::kDouble, {}, true}}},
  };
}

std::vector<Message> SceneMessages() {
  const Field pose = Of("pose", 1, kPose);
  return {
      {"foxglove.KeyValuePair", {{"key", 1, Type::kString}, {"value", 2, Type::kString}}},
      {"foxglove.ArrowPrimitive",
       {pose,
        {"shaft_length", 2, Type::kDouble},
        {"shaft_diameter", 3, Type::kDouble},
        {"head_length", 4, Type::kDouble},
        {"head_diameter", 5, Type::kDouble},
        Of("color", 6, kColor)}},
      {"foxglove.CubePrimitive", {pose, Of("size", 2, kVector3), Of("color", 3, kColor)}},
      {"foxglove.SpherePrimitive", {pose, Of("size", 2, kVector3), Of("color", 3, kColor)}},
      {"foxglove.CylinderPrimitive",
       {pose,
        Of("size", 2, kVector3),
        {"bottom_scale", 3, Type::kDouble},
        {"top_scale", 4, Type::kDouble},
        Of("color", 5, kColor)}},
      {"foxglove.LinePrimitive",
       {{"type", 1, Type::kEnum, "Type"},
        Of("pose", 2, kPose),
        {"thickness", 3, Type::kDouble},
        {"scale_invariant", 4, Type::kBool},
        ListOf("points", 5, kPoint3),
        Of("color", 6, kColor),
        ListOf("colors", 7, kColor),
        {"indices", 8, Type::kFixed32, {}, true}},
       {"Type", kLineTypes}},
      {"foxglove.TriangleListPrimitive",
       {pose,
        ListOf("points", 2, kPoint3),
        Of("color", 3, kColor),
        ListOf("colors", 4, kColor),
        {"indices", 5, Type::kFixed32, {}, true}}},
      {"foxglove.TextPrimitive",
       {pose,
        {"billboard", 2, Type::kBool},
        {"font_size", 3, Type::kDouble},
        {"scale_invariant", 4, Type::kBool},
        Of("color", 5, kColor),
        {"text", 6, Type::kString}}},
      {"foxglove.ModelPrimitive",
       {pose,
        Of("scale", 2, kVector3),
        Of("color", 3, kColor),
        {"override_color", 4, Type::kBool},
        {"url", 5, Type::kString},
        {"media_type", 6, Type::kString},
        {"data", 7, Type::kBytes}}},
      {"foxglove.SceneEntityDeletion",
       {Of("timestamp", 1, kTimestamp), {"type", 2, Type::kEnum, "Type"}, {"id", 3, Type::kString}},
       {"Type", kDeletionTypes}},
      {"foxglove.SceneEntity",
       {Of("timestamp", 1, kTimestamp),
        {"frame_id", 2, Type::kString},
        {"id", 3, Type::kString},
        Of("lifetime", 4, kDuration),
        {"frame_locked", 5, Type::kBool},
        ListOf("metadata", 6, "foxglove.KeyValuePair"),
        ListOf("arrows", 7, "foxglove.ArrowPrimitive"),
        ListOf("cubes", 8, "foxglove.CubePrimitive"),
        ListOf("spheres", 9, "foxglove.SpherePrimitive"),
        ListOf("cylinders", 10, "foxglove.CylinderPrimitive"),
        ListOf("lines", 11, "foxglove.LinePrimitive"),
        ListOf("triangles", 12, "foxglove.TriangleListPrimitive"),
        ListOf("texts", 13, "foxglove.TextPrimitive"),
        ListOf("models", 14, "foxglove.ModelPrimitive")}},
      {"foxglove.SceneUpdate",
       {ListOf("deletions", 1, "foxglove.SceneEntityDeletion"), ListOf("entities", 2, "foxglove.SceneEntity")}},
  };
}

const std::vector<Message>& AllMessages() {
  static const std::vector<Message> messages = [] {
    std::vector<Message> all = BasicMessages();
    for (Message& message : SceneMessages()) all.push_back(std::move(message));
    return all;
  }();
  return messages;
}

const Message& Find(std::string_view name) {
  return *std::ranges::find(AllMessages(), name, [](const Message& message) { return message.name; });
}

// Google's own are in lower case: `google/protobuf/timestamp.proto`, `foxglove/Pose.proto`.
std::string FileOf(std::string_view message) {
  if (message == kTimestamp) return "google/protobuf/timestamp.proto";
  if (message == kDuration) return "google/protobuf/duration.proto";
  return Concat("foxglove/", message.substr(message.rfind('.') + 1), ".proto");
}

// The messages that a message's fields are of, each once, in their order.
std::vector<std::string_view> NeededBy(const Message& message) {
  std::vector<std::string_view> needed;
  for (const Field& field : message.fields)
    if (field.type == Type::kMessage && std::ranges::find(needed, field.of) == needed.end()) needed.push_back(field.of);
  return needed;
}

// What a message needs stands before it.
void Collect(const Message& message, std::vector<const Message*>& ordered) {
  if (std::ranges::find(ordered, &message) != ordered.end()) return;
  for (const std::string_view needed : NeededBy(message)) Collect(Find(needed), ordered);
  ordered.push_back(&message);
}

// FieldDescriptorProto.
void AppendField(ProtoAppender& proto, const Message& message, const Field& field) {
  constexpr int kOptional = 1, kRepeated = 3;
  proto.Text(1, field.name);
  proto.Varint(3, field.number);
  proto.Varint(4, field.repeated ? kRepeated : kOptional);
  proto.Varint(5, static_cast<std::uint64_t>(field.type));
  if (field.type == Type::kMessage) proto.Text(6, Concat('.', field.of));
  if (field.type == Type::kEnum) proto.Text(6, Concat('.', message.name, '.', field.of));
}

// EnumDescriptorProto.
void AppendEnumeration(ProtoAppender& proto, const Enumeration& enumeration) {
  proto.Text(1, enumeration.name);
  for (std::size_t value = 0; value < enumeration.values.size(); ++value)
    proto.Message(2, [&](ProtoAppender& of_value) {
      of_value.Text(1, enumeration.values[value]);
      of_value.Varint(2, value);
    });
}

// FileDescriptorProto.
void AppendFile(ProtoAppender& proto, const Message& message) {
  const std::size_t dot = message.name.rfind('.');
  proto.Text(1, FileOf(message.name));
  proto.Text(2, message.name.substr(0, dot));
  for (const std::string_view needed : NeededBy(message)) proto.Text(3, FileOf(needed));
  proto.Message(4, [&](ProtoAppender& of_message) {
    of_message.Text(1, message.name.substr(dot + 1));
    for (const Field& field : message.fields)
      of_message.Message(2, [&](ProtoAppender& of_field) { AppendField(of_field, message, field); });
    if (!message.enumeration.name.empty())
      of_message.Message(4, [&](ProtoAppender& of_enum) { AppendEnumeration(of_enum, message.enumeration); });
  });
  proto.Text(12, "proto3");
}

}  // namespace

std::string FileDescriptorSetOf(std::string_view message) {
  std::vector<const Message*> ordered;
  Collect(Find(message), ordered);
  std::string bytes;
  ProtoAppender proto(bytes);
  for (const Message* file : ordered) proto.Message(1, [file](ProtoAppender& of_file) { AppendFile(of_file, *file); });
  return bytes;
}

}  // namespace slamdb::detail
