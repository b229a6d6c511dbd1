// SPDX-License-Identifier: BSD-3-Clause
#include <cstring>

#include "slamdb/formats/colmap/detail/codec.h"
#include "slamdb/formats/export/detail/raw.h"
#include "slamdb/formats/export/detail/rows.h"

namespace slamdb::colmap {
namespace {

using detail::AppendRaw;
using detail::WriteRows;

template <class Values>
void AppendAll(std::string& out, const Values& values) {
  for (const auto value : values) AppendRaw(out, value);
}

// One behind the other, without padding.
template <class... Values>
void AppendPacked(std::string& out, const Values&... values) {
  char bytes[(sizeof(Values) + ...)];
  char* at = bytes;
  const auto put = [&at](const auto& value) {
    std::memcpy(at, &value, sizeof value);
    at += sizeof value;
  };
  (put(values), ...);
  out.append(bytes, sizeof bytes);
}

// Elements without padding, as they are in memory.
template <class Element>
void AppendBytes(std::string& out, const Element* elements, std::uint64_t count) {
  if (count > 0) out.append(reinterpret_cast<const char*>(elements), count * sizeof(Element));
}

void AppendPose(std::string& out, const Pose& pose) {
  AppendAll(out, pose.wxyz);
  AppendAll(out, pose.translation);
}

void AppendSensor(std::string& out, const Sensor& sensor) {
  AppendRaw(out, static_cast<std::int32_t>(sensor.type));
  AppendRaw(out, sensor.id);
}

void Append(std::string& out, const Camera& camera) {
  AppendRaw(out, camera.id);
  AppendRaw(out, camera.model);
  AppendRaw(out, camera.width);
  AppendRaw(out, camera.height);
  AppendAll(out, camera.parameters);
}

void Append(std::string& out, const Image& image) {
  AppendRaw(out, image.id);
  AppendPose(out, image.camera_from_world);
  AppendRaw(out, image.camera);
  out.append(image.name).push_back('\0');
  AppendRaw(out, std::uint64_t{image.points.size()});
  AppendBytes(out, image.points.data(), image.points.size());
}

void Append(std::string& out, const Point& point, const Model& model) {
  AppendPacked(out, point.id, point.position, point.color, point.error, point.track_length);
  AppendBytes(out, model.tracks.data() + point.track_begin, point.track_length);
}

void Append(std::string& out, const Rig& rig) {
  AppendRaw(out, rig.id);
  AppendRaw(out, static_cast<std::uint32_t>(rig.sensors.size()));
  for (std::size_t row = 0; row < rig.sensors.size(); ++row) {
    const RigSensor& sensor = rig.sensors[row];
    AppendSensor(out, sensor.sensor);
    if (row == 0) continue;
    AppendRaw(out, static_cast<std::uint8_t>(sensor.sensor_from_rig ? 1 : 0));
    if (sensor.sensor_from_rig) AppendPose(out, *sensor.sensor_from_rig);
  }
}

void Append(std::string& out, const Frame& frame) {
  AppendRaw(out, frame.id);
  AppendRaw(out, frame.rig);
  AppendPose(out, frame.rig_from_world);
  AppendRaw(out, static_cast<std::uint32_t>(frame.data.size()));
  for (const FrameData& data : frame.data) {
    AppendSensor(out, data.sensor);
    AppendRaw(out, data.data);
  }
}

template <class List, class AppendOne>
void WriteList(const List& list, std::size_t grain, AtomicFile& file, const WriteOptions& options,
               const AppendOne& append) {
  std::string count;
  AppendRaw(count, std::uint64_t{list.size()});
  file.Write(count);
  WriteRows(file, list.size(), grain, options, [&](std::size_t begin, std::size_t end, std::string& out) {
    for (std::size_t row = begin; row < end; ++row) append(out, list[row]);
  });
}

}  // namespace

void EncodeBinary(Part part, const Model& model, AtomicFile& file, const WriteOptions& options) {
  constexpr std::size_t kFew = 1024, kImages = 2, kPoints = 512;  // small blocks stay in the cache
  const auto plain = [](std::string& out, const auto& row) { Append(out, row); };
  switch (part) {
    case Part::kCameras:
      return WriteList(model.cameras, kFew, file, options, plain);
    case Part::kImages:
      return WriteList(model.images, kImages, file, options, plain);
    case Part::kPoints:
      return WriteList(model.points, kPoints, file, options,
                       [&](std::string& out, const Point& point) { Append(out, point, model); });
    case Part::kRigs:
      return WriteList(model.rigs, kFew, file, options, plain);
    case Part::kFrames:
      return WriteList(model.frames, kFew, file, options, plain);
  }
}

}  // namespace slamdb::colmap
