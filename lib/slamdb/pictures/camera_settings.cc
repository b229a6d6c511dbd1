// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/pictures/camera_settings.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/parse_file.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"
#include "slamdb/model/detail/distortion.h"
#include "slamdb/model/detail/image_bounds.h"
#include "slamdb/model/detail/lens_numbers.h"
#include "slamdb/model/index.h"
#include "slamdb/pictures/detail/record_camera.h"

namespace slamdb {
namespace {

using detail::Concat;

constexpr std::int32_t kLargestSide = 32768, kMostFeatures = 100'000, kMostLevels = 32;

[[noreturn]] void Refuse(const std::string& place, const std::string& problem) {
  throw Error(ErrorKind::kDamaged, "", place, problem);
}

// The lines `name: value` of a YAML file.
class Lines {
 public:
  explicit Lines(std::string_view text) {
    text = detail::WithoutMark(text);
    for (std::size_t number = 1; !text.empty(); ++number) {
      std::string_view line = detail::TakeLine(text);
      if (line.starts_with('#') || line.starts_with('%')) continue;
      const std::size_t colon = line.find(": ");
      if (colon == std::string_view::npos) continue;
      std::string_view value = line.substr(colon + 2);
      value = detail::Trimmed(value.substr(0, value.find(" #")));
      if (value.size() >= 2 && value.front() == '"' && value.back() == '"') value = value.substr(1, value.size() - 2);
      values_[std::string(detail::Trimmed(line.substr(0, colon)))] = {std::string(value), number};
    }
  }

  bool Has(const std::string& name) const { return values_.contains(name); }
  std::string Text(const std::string& name) const { return Has(name) ? values_.at(name).text : std::string(); }
  std::string PlaceOf(const std::string& name) const {
    return Has(name) ? Concat("line ", values_.at(name).line) : std::string();
  }

  double Number(const std::string& name, std::optional<double> otherwise = std::nullopt) const {
    if (!Has(name)) {
      if (!otherwise) Refuse("", Concat("has no `", name, "`"));
      return *otherwise;
    }
    const std::optional<double> number = detail::ParseNumber<double>(Text(name));
    if (!number || !std::isfinite(*number)) Refuse(PlaceOf(name), Concat("`", name, "` must be a number"));
    return *number;
  }

  std::int32_t Whole(const std::string& name, std::int32_t otherwise, std::int32_t most) const {
    const double number = Number(name, otherwise);
    if (Has(name) && (!(number >= 1 && number <= most) || number != std::floor(number)))
      Refuse(PlaceOf(name), Concat("`", name, "` must be a whole number from 1 to ", most));
    return static_cast<std::int32_t>(number);
  }

 private:
  struct Value {
    std::string text;
    std::size_t line = 0;
  };
  std::map<std::string, Value> values_;
};

void SetCamera(const Lines& lines, CameraSettings& settings) {
  const std::string type = lines.Text("Camera.type");
  const bool fisheye = type == "KannalaBrandt8" || type == "KannalaBrandt";
  if (!fisheye && !type.empty() && type != "PinHole" && type != "Pinhole" && type != "Rectified")
    Refuse(lines.PlaceOf("Camera.type"),
           Concat("the camera model `", type, "` is none of PinHole, Rectified and KannalaBrandt8"));
  const std::string camera = lines.Has("Camera1.fx") ? "Camera1." : "Camera.";
  const auto add = [&](const char* name) {
    settings.camera.parameters.push_back(static_cast<float>(lines.Number(camera + name)));
  };
  for (const char* name : {"fx", "fy", "cx", "cy"}) add(name);
  for (const std::size_t focal : {0, 1})
    if (!(settings.camera.parameters[focal] > 0))
      Refuse(lines.PlaceOf(camera + (focal == 0 ? "fx" : "fy")), "a focal length must be above 0");
  if (fisheye) {
    settings.camera.model = CameraModel::kKannalaBrandt8;
    settings.camera.recorded_type = 1;
    for (const char* name : {"k1", "k2", "k3", "k4"}) add(name);
  } else if (type != "Rectified") {
    for (const char* name : {"k1", "k2", "p1", "p2", "k3"})
      settings.distortion.push_back(lines.Number(camera + name, 0.0));
    while (!settings.distortion.empty() && settings.distortion.back() == 0) settings.distortion.pop_back();
  }
}

// ORB-SLAM3 scales pictures where newWidth and newHeight say so, and the camera with them.
void SetSize(const Lines& lines, CameraSettings& settings) {
  settings.file_width = lines.Whole("Camera.width", 0, kLargestSide);
  settings.file_height = lines.Whole("Camera.height", 0, kLargestSide);
  settings.width = lines.Whole("Camera.newWidth", settings.file_width, kLargestSide);
  settings.height = lines.Whole("Camera.newHeight", settings.file_height, kLargestSide);
  if (settings.file_width == 0 || settings.file_height == 0) return;
  const float across = static_cast<float>(settings.width) / static_cast<float>(settings.file_width);
  const float down = static_cast<float>(settings.height) / static_cast<float>(settings.file_height);
  std::vector<float>& parameters = settings.camera.parameters;
  for (const auto& [row, factor] : {std::pair(0, across), std::pair(1, down), std::pair(2, across), std::pair(3, down)})
    parameters[static_cast<std::size_t>(row)] *= factor;
}

// Whether bounds are those of pictures of one size: where a lens distorts, about.
bool IsAbout(const ImageBounds& one, const ImageBounds& other) {
  const std::int32_t width = one.max_x - one.min_x, height = one.max_y - one.min_y;
  const bool straight = one.min_x == 0 && one.min_y == 0;
  const auto differ = [&](std::int32_t a, std::int32_t b, std::int32_t side) {
    return std::abs(std::int64_t{a} - b) > (straight ? 0 : side / 20);
  };
  return !differ(one.min_x, other.min_x, width) && !differ(one.max_x, other.max_x, width) &&
         !differ(one.min_y, other.min_y, height) && !differ(one.max_y, other.max_y, height);
}

CameraSettings Parse(std::string_view text) {
  const Lines lines(text);
  CameraSettings settings;
  SetCamera(lines, settings);
  SetSize(lines, settings);
  settings.features = lines.Whole("ORBextractor.nFeatures", 0, kMostFeatures);
  settings.levels = lines.Whole("ORBextractor.nLevels", settings.levels, kMostLevels);
  settings.initial_threshold = lines.Whole("ORBextractor.iniThFAST", settings.initial_threshold, 255);
  settings.least_threshold = lines.Whole("ORBextractor.minThFAST", settings.least_threshold, 255);
  const std::string factor = "ORBextractor.scaleFactor";
  settings.scale_factor = static_cast<float>(lines.Number(factor, static_cast<double>(settings.scale_factor)));
  if (!(settings.scale_factor > 1 && settings.scale_factor <= 4))
    Refuse(lines.PlaceOf(factor), Concat("`", factor, "` must be above 1, and 4 at most"));
  return settings;
}

}  // namespace

CameraSettings ReadCameraSettings(const Source& source) {
  return detail::ParseFile(source, "settings of a camera", Parse, {"yaml"});
}

std::vector<double> DistortionOf(const KeyFrame& keyframe) { return detail::DistortionCoefficients(keyframe); }

Eigen::Vector2d Undistorted(const CameraSettings& settings, const Eigen::Vector2d& pixel) {
  if (settings.distortion.empty() || settings.camera.model != CameraModel::kPinhole) return pixel;
  std::array<double, 5> k{};
  for (std::size_t i = 0; i < std::min(k.size(), settings.distortion.size()); ++i) k[i] = settings.distortion[i];
  const std::vector<float>& p = settings.camera.parameters;
  return detail::UndistortBrownPixel(k.data(), {p[0], p[1]}, {p[2], p[3]}, pixel).value_or(pixel);
}

ImageBounds UndistortedBounds(const CameraSettings& settings, std::int32_t width, std::int32_t height) {
  return detail::BoundsOfCorners(width, height,
                                 [&](const Eigen::Vector2d& corner) { return Undistorted(settings, corner); });
}

std::optional<CameraSettings> SettingsOfMap(const Atlas& atlas, std::int32_t width, std::int32_t height) {
  const AtlasIndex index(atlas);
  for (const Map& map : atlas.maps)
    for (const KeyFrame& keyframe : map.keyframes) {
      const Camera* camera = index.FindCamera(keyframe.camera);
      if (camera == nullptr || keyframe.pyramid.levels < 1 || keyframe.pyramid.levels > kMostLevels ||
          !(keyframe.pyramid.factor > 1 && keyframe.pyramid.factor <= 4))
        continue;
      CameraSettings settings{.camera = *camera,
                              .distortion = DistortionOf(keyframe),
                              .scale_factor = keyframe.pyramid.factor,
                              .levels = keyframe.pyramid.levels};
      if (camera->parameters.size() < 4 || !IsAbout(UndistortedBounds(settings, width, height), keyframe.bounds))
        continue;
      settings.width = settings.file_width = width;
      settings.height = settings.file_height = height;
      return settings;
    }
  return std::nullopt;
}

std::optional<PictureFeatures> WithCamera(const PictureFeatures& features, const CameraSettings& found,
                                          const CameraSettings& other) {
  const auto how = [](const CameraSettings& settings) {
    return std::tuple(settings.width, settings.height, settings.file_width, settings.file_height, settings.scale_factor,
                      settings.levels, settings.initial_threshold, settings.least_threshold);
  };
  if (!found.distortion.empty() || how(found) != how(other)) return std::nullopt;
  PictureFeatures seen = features;
  seen.camera = other.camera;
  seen.bounds = UndistortedBounds(other, other.width, other.height);
  seen.keypoints = detail::WithoutDistortion(other, std::move(seen.keypoints));
  return seen;
}

}  // namespace slamdb
