// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstring>
#include <limits>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/colmap/detail/codec.h"
#include "slamdb/formats/colmap/detail/lenses.h"
#include "slamdb/formats/colmap/detail/poses.h"

namespace slamdb::colmap {
namespace {

using detail::Concat;

// A cursor over the bytes of one file, which knows what it is at.
class Cursor {
 public:
  Cursor(const WholeFile& file, std::string_view entity) : file_(file), entity_(entity) {}

  template <class Value>
  Value Take() {
    Value value;
    std::memcpy(&value, Need(sizeof value), sizeof value);
    return value;
  }
  template <class Value>
  void TakeAll(Value* values, std::uint64_t count) {
    if (count > 0) std::memcpy(values, Need(count * sizeof(Value)), count * sizeof(Value));
  }
  // How many records of at least `least` bytes follow.
  std::uint64_t TakeCount(std::uint64_t least, std::string_view of) {
    return Fitting(Take<std::uint64_t>(), least, of);
  }
  std::uint32_t TakeCount32(std::uint64_t least, std::string_view of) {
    return static_cast<std::uint32_t>(Fitting(Take<std::uint32_t>(), least, of));
  }
  std::string TakeName() {
    const std::string_view rest = file_.text().substr(at_);
    const std::size_t end = rest.find('\0');
    if (end == rest.npos) Fail("a name does not end: the file is truncated");
    at_ += end + 1;
    return std::string(rest.substr(0, end));
  }
  Pose TakePose() {
    Pose pose;
    TakeAll(pose.wxyz.data(), pose.wxyz.size());
    TakeAll(pose.translation.data(), pose.translation.size());
    Require(WhyNoPose(pose));
    return pose;
  }
  SensorType TakeSensorType() {
    const auto type = Take<std::int32_t>();
    if (type < -1 || type > 1) Fail(Concat("there is no sensor of type ", type));
    return SensorType{type};
  }

  void Begin(std::uint64_t row) { row_ = row; }
  void End() const {
    if (at_ == file_.bytes().size()) return;
    throw Error(ErrorKind::kDamaged, file_.path(), Concat("byte ", at_),
                Concat(file_.bytes().size() - at_, " bytes follow behind the last ", entity_));
  }
  [[noreturn]] void Fail(const std::string& problem) const {
    throw Error(ErrorKind::kDamaged, file_.path(), Concat("byte ", at_, ", ", entity_, " ", row_), problem);
  }
  void Require(const std::string& why_not) const {
    if (!why_not.empty()) Fail(why_not);
  }

 private:
  const std::byte* Need(std::uint64_t bytes) {
    const std::uint64_t left = file_.bytes().size() - at_;
    if (bytes > left) Fail(Concat(bytes, " bytes are needed and ", left, " are left: the file is truncated"));
    const std::byte* place = file_.bytes().data() + at_;
    at_ += static_cast<std::size_t>(bytes);
    return place;
  }
  std::uint64_t Fitting(std::uint64_t count, std::uint64_t least, std::string_view of) {
    const std::uint64_t left = file_.bytes().size() - at_;
    if (count <= left / least) return count;
    Fail(Concat("a count of ", count, " ", of, " does not fit into the ", left, " bytes left: the file is truncated"));
  }

  const WholeFile& file_;
  std::string_view entity_;
  std::size_t at_ = 0;
  std::uint64_t row_ = 0;
};

// A list of records of at least `least` bytes, each read by `take` into a new element.
template <class List, class Take>
void TakeList(Cursor& cursor, std::uint64_t least, std::string_view of, List& list, const Take& take) {
  const std::uint64_t count = cursor.TakeCount(least, of);
  list.reserve(count);
  for (std::uint64_t row = 0; row < count; ++row) {
    cursor.Begin(row);
    take(list.emplace_back());
  }
  cursor.End();
}

void TakeCameras(Cursor& cursor, Model& model) {
  TakeList(cursor, 24, "cameras", model.cameras, [&](Camera& camera) {
    camera.id = cursor.Take<std::uint32_t>();
    camera.model = cursor.Take<std::int32_t>();
    camera.width = cursor.Take<std::uint64_t>();
    camera.height = cursor.Take<std::uint64_t>();
    if (camera.model < 0 || static_cast<std::size_t>(camera.model) >= kCameraModels.size())
      cursor.Fail(Concat("there is no camera model ", camera.model));
    camera.parameters.resize(kCameraModels[static_cast<std::size_t>(camera.model)].parameters);
    cursor.TakeAll(camera.parameters.data(), camera.parameters.size());
    cursor.Require(WhyNoCamera(camera));
  });
}

void TakeImages(Cursor& cursor, Model& model) {
  TakeList(cursor, 73, "images", model.images, [&](Image& image) {
    image.id = cursor.Take<std::uint32_t>();
    image.camera_from_world = cursor.TakePose();
    image.camera = cursor.Take<std::uint32_t>();
    image.name = cursor.TakeName();
    image.points.resize(cursor.TakeCount(sizeof(Point2), "keypoints"));
    cursor.TakeAll(image.points.data(), image.points.size());
  });
}

void TakePoints(Cursor& cursor, Model& model) {
  TakeList(cursor, 51, "points", model.points, [&](Point& point) {
    point.id = cursor.Take<std::uint64_t>();
    cursor.TakeAll(point.position.data(), point.position.size());
    cursor.Require(WhyNoPosition(point));
    cursor.TakeAll(point.color.data(), point.color.size());
    point.error = cursor.Take<double>();
    point.track_begin = model.tracks.size();
    point.track_length = cursor.TakeCount(sizeof(TrackElement), "track elements");
    model.tracks.resize(point.track_begin + point.track_length);
    cursor.TakeAll(model.tracks.data() + point.track_begin, point.track_length);
  });
}

void TakeRigs(Cursor& cursor, Model& model) {
  TakeList(cursor, 8, "rigs", model.rigs, [&](Rig& rig) {
    rig.id = cursor.Take<std::uint32_t>();
    rig.sensors.resize(cursor.TakeCount32(8, "sensors"));
    for (std::size_t row = 0; row < rig.sensors.size(); ++row) {
      RigSensor& sensor = rig.sensors[row];
      sensor.sensor.type = cursor.TakeSensorType();
      sensor.sensor.id = cursor.Take<std::uint32_t>();
      if (row > 0 && cursor.Take<std::uint8_t>() != 0) sensor.sensor_from_rig = cursor.TakePose();
    }
  });
}

void TakeFrames(Cursor& cursor, Model& model) {
  TakeList(cursor, 68, "frames", model.frames, [&](Frame& frame) {
    frame.id = cursor.Take<std::uint32_t>();
    frame.rig = cursor.Take<std::uint32_t>();
    frame.rig_from_world = cursor.TakePose();
    frame.data.resize(cursor.TakeCount32(16, "images"));
    for (FrameData& data : frame.data) {
      data.sensor.type = cursor.TakeSensorType();
      data.sensor.id = cursor.Take<std::uint32_t>();
      data.data = cursor.Take<std::uint64_t>();
    }
  });
}

}  // namespace

void DecodeBinary(Part part, const WholeFile& file, Model& model) {
  switch (part) {
    case Part::kCameras: {
      Cursor cursor(file, "camera");
      return TakeCameras(cursor, model);
    }
    case Part::kImages: {
      Cursor cursor(file, "image");
      return TakeImages(cursor, model);
    }
    case Part::kPoints: {
      Cursor cursor(file, "point");
      return TakePoints(cursor, model);
    }
    case Part::kRigs: {
      Cursor cursor(file, "rig");
      return TakeRigs(cursor, model);
    }
    case Part::kFrames: {
      Cursor cursor(file, "frame");
      return TakeFrames(cursor, model);
    }
  }
}

}  // namespace slamdb::colmap
