// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <optional>
#include <unordered_map>
#include <unordered_set>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/colmap/detail/database.h"
#include "slamdb/formats/colmap/detail/lenses.h"
#include "slamdb/formats/colmap/detail/local_origin.h"
#include "slamdb/formats/colmap/detail/models.h"
#include "slamdb/formats/colmap/detail/names.h"
#include "slamdb/formats/colmap/detail/poses.h"
#include "slamdb/formats/detail/select.h"
#include "slamdb/formats/import/detail/complete.h"
#include "slamdb/model/colors.h"
#include "slamdb/model/derive.h"

namespace slamdb::colmap {
namespace {

using detail::Concat;
using detail::Counted;

// What is left out of models that were read.
struct Unread {
  std::uint64_t images = 0;          // twice there, or of a camera that is not
  std::uint64_t points = 0;          // twice there
  std::uint64_t unseen = 0;          // points that are no image's keypoint
  std::uint64_t keypoints = 0;       // of points that are not there, or that the image sees twice
  std::uint64_t track_elements = 0;  // of keypoints that are not there, or see another point
  std::uint64_t colors = 0;          // of points
  std::uint64_t names = 0;           // of images, which are no times
  std::uint64_t undistorted = 0;     // keypoints of lenses that we have not
  std::uint64_t moved_models = 0;    // whose ids others had
  std::uint64_t rigs = 0;            // of other kinds than a fisheye stereo pair
  std::uint64_t strangers = 0;       // images that the database has not
  std::uint64_t descriptors = 0;     // of keypoints, that are not ORB's
  std::uint64_t undescribed = 0;     // keypoints without descriptor
  std::uint64_t rights = 0;          // right images by their names, of pairs that no rig makes
};

Rigid3f RigidOf(const Pose& pose) {
  const auto number = [](double value) { return static_cast<float>(value); };
  return {Quaternionf(number(pose.wxyz[0]), number(pose.wxyz[1]), number(pose.wxyz[2]), number(pose.wxyz[3])),
          {number(pose.translation[0]), number(pose.translation[1]), number(pose.translation[2])}};
}

template <class Row>
std::unordered_map<std::uint64_t, std::uint32_t> RowsById(const std::vector<Row>& rows) {
  std::unordered_map<std::uint64_t, std::uint32_t> by_id;
  by_id.reserve(rows.size());
  for (std::uint32_t row = 0; row < rows.size(); ++row) by_id.emplace(rows[row].id, row);
  return by_id;
}

// Where an image is: its pose, and the other of the pair that it is one of.
struct Place {
  Pose camera_from_world;
  std::optional<std::uint32_t> right;  // of a left image: the row of the right one
  Pose right_from_left;
  bool is_right = false;
};

// The poses of images by frames and rigs where there are any; those of the images themselves are copies.
class Places {
 public:
  explicit Places(const Model& model)
      : model_(model), images_(RowsById(model.images)), cameras_(RowsById(model.cameras)), rigs_(RowsById(model.rigs)) {
    for (const Image& image : model.images) places_.push_back({.camera_from_world = image.camera_from_world});
    for (const Frame& frame : model.frames)
      if (const auto rig = rigs_.find(frame.rig); rig != rigs_.end()) Add(frame, model.rigs[rig->second]);
  }

  const Place& operator[](std::size_t image) const { return places_[image]; }
  bool HasOtherRigs() const { return other_rigs_; }

 private:
  void Add(const Frame& frame, const Rig& rig) {
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

  bool IsFisheye(std::uint32_t image) const {
    const auto camera = cameras_.find(model_.images[image].camera);
    if (camera == cameras_.end() || WhyNotRead(model_.cameras[camera->second]) != nullptr) return false;
    return SettingsOf(model_.cameras[camera->second], CameraId(0)).camera.model == CameraModel::kKannalaBrandt8;
  }

  const Model& model_;
  std::unordered_map<std::uint64_t, std::uint32_t> images_, cameras_, rigs_;
  std::vector<Place> places_;
  bool other_rigs_ = false;
};

// How ids of COLMAP become ours: ids there begin with 1, unless one is 0.
class Ids {
 public:
  template <class Row>
  explicit Ids(const std::vector<Row>& rows) {
    for (const Row& row : rows) below_ = row.id == 0 ? 0 : below_;
  }
  std::uint64_t Of(std::uint64_t id) const { return id - below_ + above_; }
  void MoveUp(std::uint64_t by) { above_ = by; }

 private:
  std::uint64_t below_ = 1, above_ = 0;
};

// One model on its way to a map.
class MapMaker {
 public:
  MapMaker(const NamedModel& named, FeatureDatabase* database, const Ids& images, const Ids& cameras,
           std::uint64_t points_above, Unread& unread)
      : model_(named.model),
        database_(database),
        images_(images),
        cameras_(cameras),
        points_above_(points_above),
        unread_(unread),
        places_(named.model) {
    for (const Camera& camera : model_.cameras) {
      if (const char* why = WhyNotRead(camera)) Refuse(named.path, camera, why);
      settings_.emplace(camera.id, SettingsOf(camera, CameraId(cameras_.Of(camera.id))));
      colmap_cameras_.emplace(camera.id, &camera);
    }
    if (places_.HasOtherRigs()) ++unread_.rigs;
  }

  Map Make(MapId id) {
    Map map;
    map.id = id;
    AddPoints(map);
    AddKeyFrames(map);
    return map;
  }

  // The cameras that no model before had, in the model's order.
  void AddCameras(std::vector<slamdb::Camera>& cameras) const {
    for (const Camera& camera : model_.cameras) {
      const slamdb::Camera& made = settings_.at(camera.id).camera;
      if (std::ranges::find(cameras, made.id, &slamdb::Camera::id) == cameras.end()) cameras.push_back(made);
    }
  }

 private:
  [[noreturn]] static void Refuse(const std::string& path, const Camera& camera, const char* why) {
    throw Error(ErrorKind::kUnsupported, path, Concat("camera ", camera.id),
                Concat("of model ", kCameraModels[static_cast<std::size_t>(camera.model)].name, " is not read: ", why));
  }

  void AddPoints(Map& map) {
    map.points.reserve(model_.points.size());
    known_points_.reserve(model_.points.size());
    std::unordered_set<std::uint64_t> seen;
    for (const Image& image : model_.images)
      for (const Point2& keypoint : image.points) seen.insert(keypoint.point);
    for (const Point& read : model_.points) {
      if (!known_points_.insert(read.id).second || read.id == kNoPoint) {
        ++unread_.points;
        continue;
      }
      if (!seen.contains(read.id)) {
        ++unread_.unseen;
        continue;
      }
      MapPoint& point = map.points.emplace_back();
      point.id = MapPointId(read.id + points_above_);
      for (std::size_t axis = 0; axis < 3; ++axis)
        point.position[static_cast<Eigen::Index>(axis)] = static_cast<float>(read.position[axis]);
      point.descriptor_form = MatrixForm::kEmpty;
      const bool is_grey = read.color == kNoColor || read.color == Color{};
      unread_.colors += is_grey ? 0 : 1;
    }
  }

  void AddKeyFrames(Map& map) {
    std::unordered_set<std::uint64_t> seen;
    for (std::uint32_t row = 0; row < model_.images.size(); ++row) {
      const Image& image = model_.images[row];
      if (!seen.insert(image.id).second || !settings_.contains(image.camera)) {
        ++unread_.images;
        continue;
      }
      if (places_[row].is_right) continue;
      unread_.rights += image.name.starts_with("right/") ? 1 : 0;
      map.keyframes.push_back(KeyFrameOf(row));
    }
  }

  KeyFrame KeyFrameOf(std::uint32_t row) {
    const Image& image = model_.images[row];
    const Place& place = places_[row];
    const CameraSettings& settings = settings_.at(image.camera);
    KeyFrame keyframe;
    keyframe.id = KeyFrameId(images_.Of(image.id));
    keyframe.frame_id = keyframe.id.value();
    keyframe.timestamp = TimeInName(image.name).value_or(std::numeric_limits<double>::quiet_NaN());
    keyframe.camera_from_world = RigidOf(place.camera_from_world);
    keyframe.camera = settings.camera.id;
    SetCalibration(settings, keyframe);
    AddKeypoints(image, keyframe.features.keypoints, keyframe.features);
    if (place.right) AddRight(model_.images[*place.right], place, keyframe);
    Features& features = keyframe.features;
    if (settings.camera.model == CameraModel::kPinhole) Undistort(settings, features);
    SetDescriptors(keyframe);
    return keyframe;
  }

  // Of all keypoints or of none: ORB's are columns, others travel along.
  void SetDescriptors(KeyFrame& keyframe) {
    constexpr std::int32_t kBytes = 0;  // OpenCV's type code
    Features& features = keyframe.features;
    const std::size_t count = features.map_points.size();
    const bool whole = descriptor_bytes_ > 0 && descriptors_.size() == count * descriptor_bytes_;
    if (whole && descriptor_bytes_ == sizeof(Descriptor)) {
      features.descriptors.resize(count);
      if (count > 0) std::memcpy(features.descriptors.front().data(), descriptors_.data(), descriptors_.size());
    } else if (whole && count > 0) {
      keyframe.carried.Make().descriptors = {static_cast<std::int32_t>(count),
                                             static_cast<std::int32_t>(descriptor_bytes_), kBytes, true, descriptors_};
      unread_.descriptors += count;
    } else {
      unread_.undescribed += count;
    }
    descriptors_.clear();
  }

  void AddRight(const Image& image, const Place& place, KeyFrame& keyframe) {
    Features& features = keyframe.features;
    const CameraSettings& settings = settings_.at(image.camera);
    keyframe.right_camera = settings.camera.id;
    keyframe.left_from_right = RigidOf(Inverse(place.right_from_left));
    keyframe.intrinsics.baseline = keyframe.left_from_right.translation.norm();
    keyframe.intrinsics.baseline_fx = keyframe.intrinsics.baseline * keyframe.intrinsics.fx;
    keyframe.half_baseline = keyframe.intrinsics.baseline / 2;
    features.left_count = static_cast<std::int32_t>(features.keypoints.size());
    AddKeypoints(image, features.right_keypoints, features);
    MatchSides(features);
    features.right_count = static_cast<std::int32_t>(features.right_keypoints.size());
  }

  // Keypoints of both sides that are the same point.
  static void MatchSides(Features& features) {
    const auto left = static_cast<std::size_t>(features.left_count);
    features.right_of_left.assign(left, -1);
    features.left_of_right.assign(features.right_keypoints.size(), -1);
    std::unordered_map<std::uint64_t, std::size_t> left_of_point;
    for (std::size_t row = 0; row < left; ++row)
      if (features.map_points[row]) left_of_point.emplace(features.map_points[row].value(), row);
    for (std::size_t row = left; row < features.map_points.size(); ++row) {
      const auto match = left_of_point.find(features.map_points[row].value());
      if (match == left_of_point.end()) continue;
      features.right_of_left[match->second] = static_cast<std::int32_t>(row - left);
      features.left_of_right[row - left] = static_cast<std::int32_t>(match->second);
    }
  }

  static void SetCalibration(const CameraSettings& settings, KeyFrame& keyframe) {
    constexpr std::int32_t kFloats = 5;  // OpenCV's type code
    const std::vector<float>& p = settings.camera.parameters;
    keyframe.intrinsics.fx = p[0];
    keyframe.intrinsics.fy = p[1];
    keyframe.intrinsics.cx = p[2];
    keyframe.intrinsics.cy = p[3];
    std::vector<double> distortion = settings.distortion;
    distortion.resize(std::max<std::size_t>(distortion.size(), 4), 0);
    keyframe.distortion = {static_cast<std::int32_t>(distortion.size()), 1, kFloats, true, {}};
    for (const double k : distortion)
      for (const std::byte byte : std::bit_cast<std::array<std::byte, sizeof(float)>>(static_cast<float>(k)))
        keyframe.distortion.data.push_back(byte);
    keyframe.bounds = UndistortedBounds(settings, settings.width, settings.height);
  }

  // Behind those that are there. Of a lens that we have not, where a pinhole would see them.
  void AddKeypoints(const Image& image, Column<Keypoint>& keypoints, Features& features) {
    const Camera& camera = *colmap_cameras_.at(image.camera);
    const bool strange = NeedsUndistorting(camera);
    keypoints.reserve(image.points.size());
    points_seen_.clear();
    for (const Point2& read : image.points) {
      Eigen::Vector2d at(read.x - kHalfPixel, read.y - kHalfPixel);
      if (strange) at = UndistortedBy(camera, at);
      keypoints.push_back({.angle = 0,
                           .response = 0,
                           .size = kPatch,
                           .x = static_cast<float>(at.x()),
                           .y = static_cast<float>(at.y()),
                           .class_id = -1,
                           .octave = 0});
      features.map_points.push_back(Seen(read.point));
    }
    if (strange) unread_.undistorted += image.points.size();
    features.count = static_cast<std::int32_t>(features.map_points.size());
    if (database_ != nullptr) AddKnown(image, keypoints);
  }

  // What the database has of the image.
  void AddKnown(const Image& image, Column<Keypoint>& keypoints) {
    const std::optional<ImageFeatures> known = database_->Find(image);
    if (!known) {
      ++unread_.strangers;
      return;
    }
    for (std::size_t row = 0; row < known->scales.size(); ++row)
      SetShape(known->scales[row], known->angles[row], keypoints[row]);
    descriptor_bytes_ = known->descriptor_bytes;
    descriptors_.insert(descriptors_.end(), known->descriptors.begin(), known->descriptors.end());
  }

  // Pyramids are of eight levels of 1.2, as ORB-SLAM3's examples have them.
  static void SetShape(float scale, float angle, Keypoint& keypoint) {
    constexpr float kTurn = 360, kFactor = 1.2F, kCoarsest = 7;
    const float degrees = angle * (kTurn / 2 / std::numbers::pi_v<float>);
    if (std::isfinite(degrees)) keypoint.angle = degrees - kTurn * std::floor(degrees / kTurn);
    if (!(scale > 0) || !std::isfinite(scale)) return;
    keypoint.octave =
        static_cast<std::int32_t>(std::clamp(std::round(std::log(scale) / std::log(kFactor)), 0.F, kCoarsest));
    keypoint.size = kPatch * scale;
  }

  MapPointId Seen(std::uint64_t point) {
    if (point == kNoPoint) return {};
    if (known_points_.contains(point) && points_seen_.insert(point).second) return MapPointId(point + points_above_);
    ++unread_.keypoints;
    return {};
  }

  static void Undistort(const CameraSettings& settings, Features& features) {
    features.undistorted = features.keypoints;
    if (settings.distortion.empty()) return;
    for (Keypoint& keypoint : features.undistorted) {
      const Eigen::Vector2d at =
          Undistorted(settings, {static_cast<double>(keypoint.x), static_cast<double>(keypoint.y)});
      keypoint.x = static_cast<float>(at.x());
      keypoint.y = static_cast<float>(at.y());
    }
  }

  static constexpr float kPatch = 31;  // pixels: of ORB at its finest level

  const Model& model_;
  FeatureDatabase* database_;
  const Ids &images_, &cameras_;
  std::uint64_t points_above_;
  Unread& unread_;
  Places places_;
  std::unordered_map<std::uint32_t, CameraSettings> settings_;
  std::unordered_map<std::uint32_t, const Camera*> colmap_cameras_;
  std::unordered_set<std::uint64_t> known_points_, points_seen_;
  Column<std::byte> descriptors_;  // of the keyframe so far
  std::size_t descriptor_bytes_ = 0;
};

// Keypoints say which point they see, and tracks say it again: what tracks say alone is left out, and counted.
void CheckTracks(const Model& model, Unread& unread) {
  const auto rows = RowsById(model.images);
  const auto is_seen = [&](const TrackElement& element, std::uint64_t point) {
    const auto row = rows.find(element.image);
    if (row == rows.end()) return false;
    const Column<Point2>& keypoints = model.images[row->second].points;
    return element.row < keypoints.size() && keypoints[element.row].point == point;
  };
  for (const Point& point : model.points)
    for (std::uint64_t row = 0; row < point.track_length; ++row)
      unread.track_elements += is_seen(model.tracks[point.track_begin + row], point.id) ? 0 : 1;
}

// COLMAP counts ids of each model from 1 on, and an atlas has each id once.
class UsedIds {
 public:
  // How far up the ids of a list have to move so that none of them is there already.
  std::uint64_t Enter(const std::vector<std::uint64_t>& ids, const std::string& path, std::uint64_t& moved) {
    constexpr std::uint64_t kMost = std::uint64_t{1} << 62U;
    const bool taken = std::ranges::any_of(ids, [&](std::uint64_t id) { return used_.contains(id); });
    const std::uint64_t above = taken ? next_ : 0;
    moved += taken ? 1 : 0;
    if (taken && (above > kMost || std::ranges::any_of(ids, [](std::uint64_t id) { return id > kMost; })))
      throw Error(ErrorKind::kUnsupported, path, "",
                  "has ids that another model has too, and they are too large to be moved apart; read it alone");
    for (const std::uint64_t id : ids) {
      used_.insert(id + above);
      next_ = std::max(next_, id + above + 1);
    }
    return above;
  }

 private:
  std::unordered_set<std::uint64_t> used_;
  std::uint64_t next_ = 0;
};

// Models of one reconstruction list the same cameras.
class UsedCameras {
 public:
  std::uint64_t Enter(const std::vector<Camera>& cameras, const Ids& ids) {
    const bool clash = std::ranges::any_of(cameras, [&](const Camera& camera) {
      const auto used = used_.find(ids.Of(camera.id));
      return used != used_.end() && used->second != camera;
    });
    const std::uint64_t above = clash ? next_ : 0;
    for (const Camera& camera : cameras) {
      used_.emplace(ids.Of(camera.id) + above, camera);
      next_ = std::max(next_, ids.Of(camera.id) + above + 1);
    }
    return above;
  }

 private:
  std::unordered_map<std::uint64_t, Camera> used_;
  std::uint64_t next_ = 0;
};

template <class Row, class IdOf>
std::vector<std::uint64_t> IdsOf(const std::vector<Row>& rows, const IdOf& id_of) {
  std::vector<std::uint64_t> ids;
  ids.reserve(rows.size());
  for (const Row& row : rows) ids.push_back(id_of(row.id));
  return ids;
}

// Times of names where all are such, else their order.
void SetTimes(Atlas& atlas, Unread& unread) {
  bool all = true;
  std::uint64_t count = 0;
  for (const Map& map : atlas.maps)
    for (const KeyFrame& keyframe : map.keyframes) all = all && std::isfinite(keyframe.timestamp);
  if (all) return;
  for (Map& map : atlas.maps)
    for (KeyFrame& keyframe : map.keyframes) keyframe.timestamp = static_cast<double>(++count);
  unread.names = count;
}

void TellOfDescriptors(const Unread& unread, bool has_database, Notices& notices) {
  if (unread.descriptors > 0)
    notices.Warn(Concat(Counted(unread.descriptors, "keypoint"),
                        " have descriptors that are not the 32 bytes of ORB: they are kept, and points have none"));
  if (unread.undescribed > 0)
    notices.Warn(Concat(Counted(unread.undescribed, "keypoint"), " and all points have no ORB descriptors: ",
                        has_database ? "the database has none of them"
                                     : "a model has none; ColmapReadOptions::database names the database that has"));
  if (unread.strangers > 0)
    notices.Warn(Concat("the database has other keypoints, or another name, or nothing for ",
                        Counted(unread.strangers, "image")));
}

void Tell(const Unread& unread, bool has_database, bool with_descriptors, Notices& notices) {
  const auto lose = [&](std::uint64_t count, std::string_view noun, std::string_view why) {
    if (count > 0) notices.Lose(Concat(Counted(count, noun), " ", why));
  };
  lose(unread.images, "image", "left out: their id is there twice, or their camera is not there");
  lose(unread.points, "point", "left out: their id is there twice");
  lose(unread.unseen, "point", "left out, which no image sees: ORB-SLAM3 crashes on such");
  lose(unread.keypoints, "keypoint",
       "see nothing now: their point is not there, or the image has another keypoint of it");
  lose(unread.track_elements, "element",
       "of tracks left out: their image or keypoint is not there, or sees another point");
  lose(unread.colors, "point", "lose their colours, which an atlas has no place for");
  lose(unread.names, "image", "lose their names, which are no times: timestamps are their order, in seconds");
  lose(unread.undistorted, "keypoint",
       "are of lenses that slamdb has not, and are read where a lens without distortion would see them");
  if (unread.rights > 0)
    notices.Warn(Concat(Counted(unread.rights, "image"),
                        " named as right ones of fisheye pairs, which no rig of the model makes pairs: each is a "
                        "keyframe of its own. COLMAP before 3.12 knows nothing of rigs"));
  if (unread.rigs > 0)
    notices.Warn(
        "rigs that are no pair of fisheye cameras: each of their images is a keyframe of its own, at its pose");
  if (unread.moved_models > 0) notices.Warn("several models had the same ids: those of later ones were moved up");
  if (with_descriptors) TellOfDescriptors(unread, has_database, notices);
}

}  // namespace

Atlas AtlasOf(std::span<NamedModel> models, FeatureDatabase* database, const ReadOptions& options, Notices& notices) {
  Atlas atlas;
  Unread unread;
  UsedIds used_images, used_points;
  UsedCameras used_cameras;
  const Eigen::Vector3d origin = MoveToLocalOrigin(models);
  if (Eigen::Vector3d* taken_off = options.of<ColmapReadOptions>().origin)
    *taken_off = origin;
  else
    WarnOfLocalOrigin(origin, notices);
  for (NamedModel& named : models) {
    Ids images(named.model.images), cameras(named.model.cameras);
    images.MoveUp(used_images.Enter(IdsOf(named.model.images, [&](std::uint64_t id) { return images.Of(id); }),
                                    named.path, unread.moved_models));
    const std::uint64_t points_above = used_points.Enter(IdsOf(named.model.points, [](std::uint64_t id) { return id; }),
                                                         named.path, unread.moved_models);
    cameras.MoveUp(used_cameras.Enter(named.model.cameras, cameras));
    CheckTracks(named.model, unread);
    MapMaker maker(named, database, images, cameras, points_above, unread);
    atlas.maps.push_back(maker.Make(MapId(named.map)));
    maker.AddCameras(atlas.cameras);
  }
  SetTimes(atlas, unread);
  detail::CompleteAtlas(atlas, "COLMAP", options.threads, notices);
  Tell(unread, database != nullptr, options.features == FeatureColumns::kAll, notices);
  detail::Select(options.selection, atlas);
  return atlas;
}

}  // namespace slamdb::colmap
