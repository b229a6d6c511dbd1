// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/colmap/detail/places.h"

#include <algorithm>

#include "slamdb/formats/colmap/detail/ids.h"
#include "slamdb/formats/colmap/detail/lenses.h"
#include "slamdb/formats/colmap/detail/poses.h"

namespace slamdb::colmap {

Places::Places(const Model& model)
    : model_(model), images_(RowsById(model.images)), cameras_(RowsById(model.cameras)), rigs_(RowsById(model.rigs)) {
  for (const Image& image : model.images) places_.push_back({.camera_from_world = image.camera_from_world});
  for (const Frame& frame : model.frames)
    if (const auto rig = rigs_.find(frame.rig); rig != rigs_.end()) Add(frame, model.rigs[rig->second]);
}

void Places::Add(const Frame& frame, const Rig& rig) {
  std::optional<std::uint32_t> left, right;
  const RigSensor* second = nullptr;
  for (const FrameData& data : frame.data) {
    if (data.sensor.type != SensorType::kCamera) continue;
    const auto image = images_.find(data.data);
    const auto sensor = std::ranges::find(rig.sensors, data.sensor, &RigSensor::sensor);
    if (image == images_.end() || sensor == rig.sensors.end()) continue;
    const bool reference = sensor == rig.sensors.begin();
    if (!reference && !sensor->sensor_from_rig) continue;  // its pose in the rig is not known
    places_[image->second].camera_from_world =
        reference ? frame.rig_from_world : Compose(*sensor->sensor_from_rig, frame.rig_from_world);
    if (reference)
      left = image->second;
    else
      right = image->second, second = &*sensor;
  }
  if (rig.sensors.size() == 1 || !left || !right) return;
  if (rig.sensors.size() > 2 || !IsFisheye(*left) || !IsFisheye(*right) || *left == *right) {
    other_rigs_ = true;
    return;
  }
  places_[*left].right = right;
  places_[*left].right_from_left = *second->sensor_from_rig;
  places_[*right].is_right = true;
}

bool Places::IsFisheye(std::uint32_t image) const {
  const auto camera = cameras_.find(model_.images[image].camera);
  if (camera == cameras_.end() || WhyNotRead(model_.cameras[camera->second]) != nullptr) return false;
  return SettingsOf(model_.cameras[camera->second], CameraId(0)).camera.model == CameraModel::kKannalaBrandt8;
}

}  // namespace slamdb::colmap
