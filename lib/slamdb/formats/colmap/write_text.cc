// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/colmap/detail/codec.h"
#include "slamdb/formats/export/detail/rows.h"

namespace slamdb::colmap {
namespace {

using detail::AppendNumber;
using detail::Concat;

template <class Number>
void Add(std::string& out, Number number) {
  AppendNumber(out, number);
  out += ' ';
}
template <class Numbers>
void AddAll(std::string& out, const Numbers& numbers) {
  for (const auto number : numbers) Add(out, number);
}
void AddPose(std::string& out, const Pose& pose) {
  AddAll(out, pose.wxyz);
  AddAll(out, pose.translation);
}
void AddSensor(std::string& out, const Sensor& sensor) {
  out += sensor.type == SensorType::kCamera ? "CAMERA " : sensor.type == SensorType::kImu ? "IMU " : "INVALID ";
  Add(out, sensor.id);
}
void EndLine(std::string& out) { out.back() = '\n'; }

void Append(std::string& out, const Camera& camera) {
  Add(out, camera.id);
  out.append(kCameraModels[static_cast<std::size_t>(camera.model)].name).push_back(' ');
  Add(out, camera.width);
  Add(out, camera.height);
  AddAll(out, camera.parameters);
  EndLine(out);
}

void Append(std::string& out, const Image& image) {
  Add(out, image.id);
  AddPose(out, image.camera_from_world);
  Add(out, image.camera);
  out.append(image.name).push_back('\n');
  for (const Point2& point : image.points) {
    Add(out, point.x);
    Add(out, point.y);
    if (point.point == kNoPoint)
      out += "-1 ";
    else
      Add(out, point.point);
  }
  if (image.points.empty())
    out += '\n';
  else
    EndLine(out);
}

void Append(std::string& out, const Point& point, const Model& model) {
  Add(out, point.id);
  AddAll(out, point.position);
  AddAll(out, point.color);
  Add(out, point.error);
  for (std::uint64_t row = point.track_begin; row < point.track_begin + point.track_length; ++row) {
    Add(out, model.tracks[row].image);
    Add(out, model.tracks[row].row);
  }
  EndLine(out);
}

void Append(std::string& out, const Rig& rig) {
  Add(out, rig.id);
  Add(out, rig.sensors.size());
  for (std::size_t row = 0; row < rig.sensors.size(); ++row) {
    const RigSensor& sensor = rig.sensors[row];
    AddSensor(out, sensor.sensor);
    if (row == 0) continue;
    Add(out, sensor.sensor_from_rig ? 1 : 0);
    if (sensor.sensor_from_rig) AddPose(out, *sensor.sensor_from_rig);
  }
  EndLine(out);
}

void Append(std::string& out, const Frame& frame) {
  Add(out, frame.id);
  Add(out, frame.rig);
  AddPose(out, frame.rig_from_world);
  Add(out, frame.data.size());
  for (const FrameData& data : frame.data) {
    AddSensor(out, data.sensor);
    Add(out, data.data);
  }
  EndLine(out);
}

// The comments by which COLMAP's own files, and those who read them, tell which file it is.
constexpr std::array<std::string_view, 5> kHeads = {
    "# Camera list with one line of data per camera:\n"
    "#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n",
    "# Image list with two lines of data per image:\n"
    "#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n"
    "#   POINTS2D[] as (X, Y, POINT3D_ID)\n",
    "# 3D point list with one line of data per point:\n"
    "#   POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n",
    "# Rig calib list with one line of data per calib:\n"
    "#   RIG_ID, NUM_SENSORS, REF_SENSOR_TYPE, REF_SENSOR_ID, SENSORS[] as (SENSOR_TYPE, SENSOR_ID, HAS_POSE, [QW, QX, "
    "QY, QZ, TX, TY, TZ])\n",
    "# Frame list with one line of data per frame:\n"
    "#   FRAME_ID, RIG_ID, RIG_FROM_WORLD[QW, QX, QY, QZ, TX, TY, TZ], NUM_DATA_IDS, DATA_IDS[] as (SENSOR_TYPE, "
    "SENSOR_ID, DATA_ID)\n"};

constexpr std::array<std::string_view, 5> kCounted = {"cameras", "images", "points", "rigs", "frames"};

template <class List, class AppendOne>
void WriteList(Part part, const List& list, std::size_t grain, AtomicFile& file, const WriteOptions& options,
               const AppendOne& append) {
  const auto number = static_cast<std::size_t>(part);
  file.Write(kHeads[number]);
  file.Write(Concat("# Number of ", kCounted[number], ": ", list.size(), "\n"));  // by which readers see a cut
  detail::WriteRows(file, list.size(), grain, options, [&](std::size_t begin, std::size_t end, std::string& out) {
    for (std::size_t row = begin; row < end; ++row) append(out, list[row]);
  });
}

void RefuseBlanks(const Model& model, const std::string& path) {
  const auto has_blank = [](const Image& image) { return image.name.find_first_of(" \t\r\n") != std::string::npos; };
  const auto image = std::ranges::find_if(model.images, has_blank);
  if (image == model.images.end()) return;
  throw Error(ErrorKind::kNotPossible, path, "",
              Concat("the name of image ", image->id, " (", image->name,
                     ") has blanks in it, with which images.txt cannot be read; the binary form can hold it"));
}

}  // namespace

void EncodeText(Part part, const Model& model, AtomicFile& file, const WriteOptions& options) {
  constexpr std::size_t kFew = 1024, kImages = 16, kPoints = 8192;
  const auto plain = [](std::string& out, const auto& row) { Append(out, row); };
  switch (part) {
    case Part::kCameras:
      return WriteList(part, model.cameras, kFew, file, options, plain);
    case Part::kImages:
      RefuseBlanks(model, "images.txt");
      return WriteList(part, model.images, kImages, file, options, plain);
    case Part::kPoints:
      return WriteList(part, model.points, kPoints, file, options,
                       [&](std::string& out, const Point& point) { Append(out, point, model); });
    case Part::kRigs:
      return WriteList(part, model.rigs, kFew, file, options, plain);
    case Part::kFrames:
      return WriteList(part, model.frames, kFew, file, options, plain);
  }
}

}  // namespace slamdb::colmap
