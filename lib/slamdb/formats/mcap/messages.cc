// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/mcap/detail/messages.h"

#include <array>
#include <span>

#include "slamdb/formats/export/detail/protobuf.h"

namespace slamdb::detail {
namespace {

void AppendTime(ProtoAppender& proto, std::uint64_t time) {
  proto.Message(1, [time](ProtoAppender& timestamp) {
    timestamp.Varint(1, time / 1'000'000'000);
    timestamp.Varint(2, time % 1'000'000'000);
  });
}

template <class Numbers>
void AppendDoubles(ProtoAppender& proto, int field, const Numbers& numbers) {
  proto.Message(field, [&](ProtoAppender& message) {
    int number = 0;
    for (const auto value : numbers) message.Double(++number, static_cast<double>(value));
  });
}

// A packed list.
void AppendList(ProtoAppender& proto, int field, std::span<const double> numbers) {
  std::string bytes;
  for (const double number : numbers) AppendRaw(bytes, number);
  proto.Text(field, bytes);
}

void AppendPose(ProtoAppender& proto, int field, const Rigid3f& pose) {
  proto.Message(field, [&](ProtoAppender& message) {
    AppendDoubles(message, 1, pose.translation);
    AppendDoubles(message, 2, pose.rotation.coeffs());
  });
}

void AppendColor(ProtoAppender& proto, int field, const Color& color, double opacity) {
  AppendDoubles(proto, field, std::array{color[0] / 255.0, color[1] / 255.0, color[2] / 255.0, opacity});
}

// LinePrimitive.
void AppendLines(ProtoAppender& proto, const GraphLines& lines) {
  constexpr std::uint64_t kLineList = 2;
  proto.Varint(1, kLineList);
  AppendPose(proto, 2, Rigid3f{});
  proto.Double(3, 1);  // one pixel thick
  proto.Varint(4, 1);  // whatever the distance
  for (const Eigen::Vector3f& point : lines.points) AppendDoubles(proto, 5, point);
  AppendColor(proto, 6, lines.color, lines.opacity);
  proto.Head(8, sizeof(std::uint32_t) * lines.ends.size());
  proto.Raw(std::as_bytes(std::span(lines.ends)));
}

// PackedElementField::NumericType.
enum class Element : std::uint8_t { kUint8 = 1, kUint32 = 5, kFloat32 = 7, kFloat64 = 8 };

struct CloudField {
  std::string_view name;
  std::uint32_t offset;
  Element element;
};

std::array<CloudField, 13> CloudFields(IdColumn ids) {
  return {{{"x", 0, Element::kFloat32},
           {"y", 4, Element::kFloat32},
           {"z", 8, Element::kFloat32},
           {"normal_x", 12, Element::kFloat32},
           {"normal_y", 16, Element::kFloat32},
           {"normal_z", 20, Element::kFloat32},
           {"red", 24, Element::kUint8},
           {"green", 25, Element::kUint8},
           {"blue", 26, Element::kUint8},
           {"alpha", 27, Element::kUint8},
           {"observations", 28, Element::kUint32},
           {"reprojection_error", 32, Element::kFloat32},
           {"id", 36, ids == IdColumn::kUnsigned32 ? Element::kUint32 : Element::kFloat64}}};
}

// Kannala and Brandt's image is not undistorted; all others are, and begin at the bounds' corner.
struct Calibration {
  std::string_view model;
  std::vector<double> distortion;
  double fx = 0, fy = 0, cx = 0, cy = 0;
};

Calibration CalibrationOf(const KeyFrame& keyframe, const Camera* camera) {
  if (camera != nullptr && camera->model == CameraModel::kKannalaBrandt8 && camera->parameters.size() == 8) {
    const std::vector<float>& p = camera->parameters;
    return {"kannala_brandt", {p.begin() + 4, p.end()}, p[0], p[1], p[2], p[3]};
  }
  const Intrinsics& intrinsics = keyframe.intrinsics;
  return {"plumb_bob",
          {0, 0, 0, 0, 0},
          intrinsics.fx,
          intrinsics.fy,
          intrinsics.cx - static_cast<float>(keyframe.bounds.min_x),
          intrinsics.cy - static_cast<float>(keyframe.bounds.min_y)};
}

std::uint32_t Extent(std::int32_t from, std::int32_t to) {
  return to > from ? static_cast<std::uint32_t>(std::int64_t{to} - from) : 0;
}

}  // namespace

std::string FrameTransformMessage(std::uint64_t time, std::string_view parent, std::string_view child,
                                  const Rigid3f& parent_from_child) {
  std::string message;
  ProtoAppender proto(message);
  AppendTime(proto, time);
  proto.Text(2, parent);
  proto.Text(3, child);
  AppendDoubles(proto, 4, parent_from_child.translation);
  AppendDoubles(proto, 5, parent_from_child.rotation.coeffs());
  return message;
}

std::string PosesMessage(std::uint64_t time, std::string_view frame, const std::vector<TimedPose>& poses) {
  std::string message;
  ProtoAppender proto(message);
  AppendTime(proto, time);
  proto.Text(2, frame);
  for (const TimedPose& pose : poses) AppendPose(proto, 3, pose.world_from_it);
  return message;
}

std::string SceneMessage(std::uint64_t time, std::string_view frame, const std::vector<GraphLines>& lines) {
  std::string message;
  ProtoAppender proto(message);
  for (const GraphLines& of_kind : lines)
    proto.Message(2, [&](ProtoAppender& entity) {
      AppendTime(entity, time);
      entity.Text(2, frame);
      entity.Text(3, of_kind.name);
      entity.Varint(5, 1);  // moves with its frame
      entity.Message(11, [&](ProtoAppender& primitive) { AppendLines(primitive, of_kind); });
    });
  return message;
}

std::string CalibrationBody(std::string_view frame, const KeyFrame& keyframe, const Camera* camera) {
  const auto [model, distortion, fx, fy, cx, cy] = CalibrationOf(keyframe, camera);
  std::string message;
  ProtoAppender proto(message);
  proto.Fixed32(2, Extent(keyframe.bounds.min_x, keyframe.bounds.max_x));
  proto.Fixed32(3, Extent(keyframe.bounds.min_y, keyframe.bounds.max_y));
  proto.Text(4, model);
  AppendList(proto, 5, distortion);
  AppendList(proto, 6, std::array<double, 9>{fx, 0, cx, 0, fy, cy, 0, 0, 1});
  AppendList(proto, 7, std::array<double, 9>{1, 0, 0, 0, 1, 0, 0, 0, 1});
  AppendList(proto, 8, std::array<double, 12>{fx, 0, cx, 0, 0, fy, cy, 0, 0, 0, 1, 0});
  proto.Text(9, frame);
  return message;
}

std::string CalibrationMessage(std::uint64_t time, std::string_view body) {
  std::string message;
  ProtoAppender proto(message);
  AppendTime(proto, time);
  return message.append(body);
}

std::uint32_t PointStride(IdColumn ids) { return ids == IdColumn::kUnsigned32 ? 40 : 44; }

std::string CloudHead(std::uint64_t time, std::string_view frame, std::uint64_t points, IdColumn ids) {
  std::string message;
  ProtoAppender proto(message);
  AppendTime(proto, time);
  proto.Text(2, frame);
  AppendPose(proto, 3, Rigid3f{});
  proto.Fixed32(4, PointStride(ids));
  for (const CloudField& field : CloudFields(ids))
    proto.Message(5, [&](ProtoAppender& element) {
      element.Text(1, field.name);
      element.Fixed32(2, field.offset);
      element.Varint(3, static_cast<std::uint64_t>(field.element));
    });
  proto.Head(6, points * PointStride(ids));
  return message;
}

}  // namespace slamdb::detail
