// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/column.h"
#include "slamdb/base/file.h"

// A sparse model of COLMAP as its files hold it: schema/colmap.md. Lists are in the order of the files; ids may be
// anything.
namespace slamdb::colmap {

inline constexpr std::uint64_t kNoPoint = ~std::uint64_t{0};
inline constexpr std::uint32_t kNoId = ~std::uint32_t{0};

// x_in_target = R(rotation) x_in_source + translation; pixels, and units of the model.
struct Pose {
  std::array<double, 4> wxyz{1, 0, 0, 0};
  std::array<double, 3> translation{};
  friend bool operator==(const Pose&, const Pose&) = default;
};

struct Camera {
  std::uint32_t id = 0;
  std::int32_t model = 0;  // a row of kCameraModels
  std::uint64_t width = 0, height = 0;
  std::vector<double> parameters;
  friend bool operator==(const Camera&, const Camera&) = default;
};

enum class SensorType : std::int32_t { kInvalid = -1, kCamera = 0, kImu = 1 };

struct Sensor {
  SensorType type = SensorType::kCamera;
  std::uint32_t id = 0;  // of a camera: the camera's
  friend bool operator==(const Sensor&, const Sensor&) = default;
};

struct RigSensor {
  Sensor sensor;
  std::optional<Pose> sensor_from_rig;  // of the first, which is the reference, none
  friend bool operator==(const RigSensor&, const RigSensor&) = default;
};

struct Rig {
  std::uint32_t id = 0;
  std::vector<RigSensor> sensors;
  friend bool operator==(const Rig&, const Rig&) = default;
};

struct FrameData {
  Sensor sensor;
  std::uint64_t data = 0;  // of a camera: the image's id
  friend bool operator==(const FrameData&, const FrameData&) = default;
};

struct Frame {
  std::uint32_t id = 0, rig = 0;
  Pose rig_from_world;
  std::vector<FrameData> data;
  friend bool operator==(const Frame&, const Frame&) = default;
};

// A keypoint; the centre of the top left pixel is at 0.5, 0.5.
struct Point2 {
  double x = 0, y = 0;
  std::uint64_t point = kNoPoint;
  friend bool operator==(const Point2&, const Point2&) = default;
};
static_assert(sizeof(Point2) == 24);

struct Image {
  std::uint32_t id = 0, camera = 0;
  Pose camera_from_world;
  std::string name;
  Column<Point2> points;
  friend bool operator==(const Image&, const Image&) = default;
};

struct TrackElement {
  std::uint32_t image = 0, row = 0;  // of Image::points
  friend bool operator==(const TrackElement&, const TrackElement&) = default;
};
static_assert(sizeof(TrackElement) == 8);

struct Point {
  std::uint64_t id = 0;
  std::array<double, 3> position{};
  std::array<std::uint8_t, 3> color{};
  double error = -1;                                // pixels; -1: not computed
  std::uint64_t track_begin = 0, track_length = 0;  // of Model::tracks
  friend bool operator==(const Point&, const Point&) = default;
};

struct Model {
  std::vector<Camera> cameras;
  std::vector<Rig> rigs;      // none in models that COLMAP before 3.12 wrote
  std::vector<Frame> frames;  // the same
  std::vector<Image> images;
  Column<Point> points;
  Column<TrackElement> tracks;  // point after point
  friend bool operator==(const Model&, const Model&) = default;
};

// What COLMAP calls a camera model.
struct CameraModelName {
  std::string_view name;
  std::size_t parameters = 0;
};
enum CameraModelId : std::int32_t {
  kSimplePinhole = 0,
  kPinhole = 1,
  kSimpleRadial = 2,
  kRadial = 3,
  kOpencv = 4,
  kOpencvFisheye = 5,
  kFullOpencv = 6,
  kFov = 7,
  kSimpleRadialFisheye = 8,
  kRadialFisheye = 9,
  kThinPrismFisheye = 10,
  kRadTanThinPrismFisheye = 11,
  kSimpleDivision = 12,
  kDivision = 13,
  kSimpleFisheye = 14,
  kFisheye = 15,
  kEucm = 16,
  kEquirectangular = 17,
};
inline constexpr std::array<CameraModelName, 18> kCameraModels = {{{"SIMPLE_PINHOLE", 3},
                                                                   {"PINHOLE", 4},
                                                                   {"SIMPLE_RADIAL", 4},
                                                                   {"RADIAL", 5},
                                                                   {"OPENCV", 8},
                                                                   {"OPENCV_FISHEYE", 8},
                                                                   {"FULL_OPENCV", 12},
                                                                   {"FOV", 5},
                                                                   {"SIMPLE_RADIAL_FISHEYE", 4},
                                                                   {"RADIAL_FISHEYE", 5},
                                                                   {"THIN_PRISM_FISHEYE", 12},
                                                                   {"RAD_TAN_THIN_PRISM_FISHEYE", 16},
                                                                   {"SIMPLE_DIVISION", 4},
                                                                   {"DIVISION", 5},
                                                                   {"SIMPLE_FISHEYE", 3},
                                                                   {"FISHEYE", 4},
                                                                   {"EUCM", 6},
                                                                   {"EQUIRECTANGULAR", 2}}};

// The files of a model, in which order they are read and written.
enum class Part { kCameras, kImages, kPoints, kRigs, kFrames };
inline constexpr std::array<std::string_view, 5> kPartNames = {"cameras", "images", "points3D", "rigs", "frames"};

}  // namespace slamdb::colmap
