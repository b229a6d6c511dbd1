// SPDX-License-Identifier: BSD-3-Clause
#include "cli/report/entity_text.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "cli/report/layout.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/statistics.h"
#include "slamdb/model/up.h"

namespace slamdb::cli {
namespace {

using detail::Concat;
using nlohmann::ordered_json;

std::string Line(std::string name, const std::string& value) {
  name.resize(std::max(kNameColumns, name.size() + 2), ' ');
  return name + value + "\n";
}

// To a hundredth.
double Degrees(double radians) { return std::round(radians * 18000 / std::numbers::pi) / 100; }

// Which way it looks: on the plan from x where z is up, else from z, and up or down.
std::string DirectionText(const Eigen::Vector3d& ahead, const Eigen::Vector3d& up) {
  Eigen::Index vertical = 0;
  up.cwiseAbs().maxCoeff(&vertical);
  const bool from_x = vertical == 2;
  const Eigen::Vector3d axis = from_x ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d level = axis - axis.dot(up) * up;
  const double left = Degrees(std::atan2(up.dot(level.cross(ahead)), level.dot(ahead)));
  const double rise = Degrees(std::asin(std::clamp(ahead.dot(up), -1.0, 1.0)));
  return Concat(Short(std::abs(left), 3), left >= 0 ? " degrees left of " : " degrees right of ",
                from_x ? "x, " : "z, ", Short(std::abs(rise), 3), rise >= 0 ? " up" : " down");
}

std::size_t CountFields(const ordered_json& value) {
  if (!value.is_object()) return 1;
  std::size_t count = 0;
  for (const auto& [name, member] : value.items()) count += CountFields(member);
  return count;
}

bool IsEmpty(const ordered_json& value) {
  if (value.is_object()) return std::ranges::all_of(value, IsEmpty);
  return value.is_array() && value.empty();
}

class Folder {
 public:
  explicit Folder(ordered_json& entity) : entity_(entity) {}

  void FoldImu() {
    const auto calibration = entity_.find("imu_calibration");
    if (calibration == entity_.end() || calibration->value("is_set", true)) return;
    for (const char* name : {"imu_bias", "preintegration", "imu_calibration", "velocity", "body_position",
                             "has_velocity", "imu_initialized"})
      Drop(entity_, name);
    reasons_.emplace_back("of an IMU that is not there");
  }

  // What is written when something happens to a keyframe, and uninitialised before.
  void FoldUnused() {
    if (!entity_.contains("merge_edges")) return;
    if (entity_["merge_edges"].empty()) Drop(entity_, "merge_scale");
    if (!entity_.value("bad", true)) Drop(entity_, "camera_from_parent");
  }

  void FoldSecondCamera() {
    const auto right = entity_.find("right_camera");
    if (right == entity_.end() || !right->is_null()) return;
    Drop(entity_, "right_camera");
    Drop(entity_, "left_from_right");
    reasons_.emplace_back("of a second camera");
    if (!entity_.contains("features")) return;
    ordered_json& features = entity_["features"];
    for (const char* name :
         {"left_count", "right_count", "right_keypoints", "right_of_left", "left_of_right", "right_grid"})
      Drop(features, name);
  }

  void FoldFeatures() {
    if (!entity_.contains("features")) return;
    ordered_json& features = entity_["features"];
    if (features.contains("undistorted") && features["undistorted"] == features.value("keypoints", ordered_json())) {
      Drop(features, "undistorted");
      reasons_.emplace_back("that undistorting did not change");
    }
    for (const char* name : {"right_x", "depth"}) {
      const auto found = features.find(name);
      const bool unmeasured =
          found != features.end() && found->is_array() && std::ranges::all_of(*found, [](const ordered_json& value) {
            return value.is_number() && value.get<double>() < 0;
          });
      if (unmeasured) Drop(features, name);
    }
  }

  void FoldEmpty(ordered_json& object) {
    std::vector<std::string> empty;
    for (auto& [name, member] : object.items()) {
      if (IsEmpty(member))
        empty.push_back(name);
      else if (member.is_object())
        FoldEmpty(member);
    }
    for (const std::string& name : empty) Drop(object, name);
    has_empty_ = has_empty_ || !empty.empty();
  }

  std::string Line() const {
    if (folded_ == 0) return {};
    std::string why;
    for (const std::string& reason : reasons_) why += (why.empty() ? "" : ", ") + reason;
    if (has_empty_) why += why.empty() ? "empty" : ", or empty";
    return "(" + Counted(folded_, "field") + " folded: " + why + "; --all shows them)\n";
  }

 private:
  void Drop(ordered_json& object, const std::string& name) {
    const auto found = object.find(name);
    if (found == object.end()) return;
    folded_ += CountFields(*found);
    object.erase(name);
  }

  ordered_json& entity_;
  std::vector<std::string> reasons_;
  std::size_t folded_ = 0;
  bool has_empty_ = false;
};

}  // namespace

std::string WhereIs(const KeyFrame& keyframe, const Map& map) {
  const Eigen::Vector3f center = CameraCenter(keyframe);
  const Eigen::Vector3d ahead =
      keyframe.camera_from_world.Normalized().rotation.conjugate().cast<double>() * Eigen::Vector3d::UnitZ();
  const Up up = UpOf(map);
  std::string text;
  if (center.allFinite() && ahead.allFinite())
    text += Line("camera at",
                 Concat(Rounded(center.x()), " ", Rounded(center.y()), " ", Rounded(center.z()),
                        IsMetric(map) ? " m" : " units", ", world of map ", map.id.value(), " with ", FrameText(up))) +
            Line("camera looks", DirectionText(ahead, up.direction));
  const std::string date = DateText(keyframe.timestamp);
  return date.empty() ? text : text + Line("taken", date);
}

std::string Fold(ordered_json& entity) {
  Folder folder(entity);
  folder.FoldUnused();
  folder.FoldImu();
  folder.FoldSecondCamera();
  folder.FoldFeatures();
  folder.FoldEmpty(entity);
  return folder.Line();
}

}  // namespace slamdb::cli
