// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam3/detail/meaning.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/orbslam3/detail/plausible.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/detail/distortion.h"
#include "slamdb/model/detail/is_pose.h"
#include "slamdb/model/detail/matrix_types.h"
#include "slamdb/model/reprojection.h"

namespace slamdb::orbslam3 {
namespace {

using detail::Concat;

constexpr double kWrong =
    60;  // a question to which all answers are wrong weighs as much as a member that is not like it
constexpr double kUnasked = 15;
constexpr double kPixel = 6;   // that points are farther on average from where keyframes see them
constexpr double kMost = 0.5;  // of the answers: more that are wrong make a doubt

// What no map is without, and what it is read as where a layout has no such member.
struct Needed {
  std::string_view member, instead;
};
constexpr std::array kNeeded = {Needed{"KeyFrame.mTcw", "all keyframes are at the origin"},
                                Needed{"KeyFrame.mTimeStamp", "all keyframes are of time 0"},
                                Needed{"KeyFrame.mDescriptors", "keypoints have no descriptors"},
                                Needed{"MapPoint.mWorldPos", "all map points are at the origin"},
                                Needed{"MapPoint.mDescriptor", "map points have no descriptors"}};

// One thing that holds of nearly all keyframes or points of a sound file.
struct Question {
  std::string_view doubt = {};                 // what is said where it does not
  std::vector<std::string_view> members = {};  // that it is about
  bool some_are = false;                       // of sound files, too: only where most answers are wrong that weighs
  std::size_t asked = 0, wrong = 0;

  void Ask(bool right) {
    ++asked;
    wrong += !right;
  }
  double share() const { return asked == 0 ? 0 : static_cast<double>(wrong) / static_cast<double>(asked); }
};

class Interview {
 public:
  explicit Interview(const Atlas& atlas) : atlas_(atlas) {
    for (const Map& map : atlas.maps) reprojections_.emplace_back(atlas, map);
  }

  // Whether times rise, and points are where keyframes see them.
  void AskPoses() {
    for (const Map& map : atlas_.maps) AskTimes(map);
    ForEachSampled([this](const MapPoint& point, const Reprojection& of) { AskProjections(point, of); });
  }
  // And everything else.
  void AskRest() {
    for (std::size_t map = 0; map < atlas_.maps.size(); ++map) {
      const Column<KeyFrame>& keyframes = atlas_.maps[map].keyframes;
      const std::size_t step = keyframes.size() / kMostKeyFrames + 1;
      for (std::size_t row = 0; row < keyframes.size(); row += step) AskKeyFrame(keyframes[row], reprojections_[map]);
    }
    ForEachSampled([this](const MapPoint& point, const Reprojection& of) { AskPoint(point, of); });
  }

  layouts::Meaning Answer(const ForkProgram& program) const {
    layouts::Meaning meaning;
    for (const Question* question : {&pose_,   &unset_, &camera_,  &times_,     &ticks_, &graph_, &order_, &sides_,
                                     &depths_, &lens_,  &body_,    &projects_,  &right_, &sharp_, &faces_, &near_,
                                     &counts_, &looks_, &matches_, &reference_, &first_, &born_}) {
      if (question->asked == 0 ||
          std::ranges::any_of(question->members, [&](std::string_view name) { return program.Lacks(name); })) {
        meaning.penalty += kUnasked;  // less than a wrong answer, but it must not pay to leave out what is asked about
        continue;
      }
      const bool are_most = question->share() > kMost;
      if (are_most || !question->some_are) meaning.penalty += kWrong * question->share();
      if (question->asked >= kEnough && are_most) meaning.doubts.push_back(DoubtOf(*question));
    }
    // Of poses that are nearly alike, as that of a keyframe and the one that was predicted, the right one has least.
    if (projects_.asked > 0) meaning.penalty += kPixel * pixels_ / static_cast<double>(projects_.asked);
    return meaning;
  }
  std::string AnswerOfPoses() const {
    constexpr double kNearlyAll = 0.8;
    for (const Question* question : {&projects_, &times_})
      if (question->asked >= kEnough && question->share() > kNearlyAll) return DoubtOf(*question);
    return {};
  }

 private:
  static std::string DoubtOf(const Question& question) {
    return Concat(question.doubt, " (", question.wrong, " of ", question.asked, ")");
  }

  template <class Ask>
  void ForEachSampled(const Ask& ask) const {
    std::size_t points = 0;
    for (const Map& map : atlas_.maps) points += map.points.size();
    const std::size_t step = points / kMostPoints + 1;
    for (std::size_t map = 0; map < atlas_.maps.size(); ++map) {
      const Column<MapPoint>& of_map = atlas_.maps[map].points;
      for (std::size_t row = 0; row < of_map.size(); row += step) ask(of_map[row], reprojections_[map]);
    }
  }

  void AskTimes(const Map& map) {
    constexpr double kShortest = 5e-4, kSame = 1e-6;  // seconds
    const std::vector<const KeyFrame*> by_id = ById(map);
    for (std::size_t i = 1; i < by_id.size(); ++i) {
      const double last = by_id[i - 1]->timestamp, time = by_id[i]->timestamp;
      times_.Ask(IsTimeBehind(last, time) && time - last > kShortest);
      const double part = time - std::floor(time);
      if (part > 0 && time > last) ticks_.Ask(std::abs(part - (last - std::floor(last))) > kSame);
    }
  }

  void AskKeyFrame(const KeyFrame& keyframe, const Reprojection& reprojection) {
    AskCamera(keyframe);
    for (const Rigid3f* pose : {&keyframe.camera_from_parent, &keyframe.left_from_right,
                                &keyframe.imu_calibration.camera_from_body, &keyframe.imu_calibration.body_from_camera})
      AskUnset(*pose);
    pose_.Ask(slamdb::detail::IsUnit(keyframe.camera_from_world.rotation) &&
              keyframe.camera_from_world.translation.cwiseAbs().maxCoeff() < 1e7F);
    AskGraph(keyframe, reprojection);
    AskFeatures(keyframe);
    AskBody(keyframe);
  }

  // Depths, columns in the right image and lens of one keyframe say the same, as one answer: a damaged one has many.
  void AskFeatures(const KeyFrame& keyframe) {
    const Features& features = keyframe.features;
    if (features.is_fisheye_stereo()) return sides_.Ask(features.left_count + features.right_count == features.count);
    const std::size_t rows = features.undistorted.size(), step = rows / kMostKeypoints + 1;
    Question depths, lens;
    for (std::size_t row = 0; row < rows; row += step) {
      if (row < std::min(features.depth.size(), features.right_x.size())) AskDepth(keyframe, row, depths);
      if (rows == features.keypoints.size()) AskLens(keyframe, row, lens);
    }
    if (depths.asked > 0) depths_.Ask(depths.share() <= kMost);
    if (lens.asked > 0) lens_.Ask(lens.share() <= kMost);
  }
  static void AskDepth(const KeyFrame& keyframe, std::size_t row, Question& depths) {
    const float depth = keyframe.features.depth[row], right_x = keyframe.features.right_x[row];
    if (depth <= 0 && right_x < 0) return;
    const float expected = keyframe.features.undistorted[row].x - keyframe.intrinsics.baseline_fx / depth;
    depths.Ask(depth > 0 && std::abs(right_x - expected) < kFar);
  }
  // Where the lens moves a keypoint at all.
  static void AskLens(const KeyFrame& keyframe, std::size_t row, Question& bends) {
    const Keypoint &seen = keyframe.features.keypoints[row], &straight = keyframe.features.undistorted[row];
    const std::array<double, 5> lens = DistortionOf(keyframe.distortion);
    const Intrinsics& of = keyframe.intrinsics;
    if (lens == std::array<double, 5>{} || std::hypot(seen.x - straight.x, seen.y - straight.y) < kFar) return;
    const Eigen::Vector2d place((straight.x - of.cx) / of.fx, (straight.y - of.cy) / of.fy);
    const Eigen::Vector2d bent = slamdb::detail::DistortBrown(lens.data(), place);
    bends.Ask(std::hypot(bent.x() * of.fx + of.cx - seen.x, bent.y() * of.fy + of.cy - seen.y) < kFar);
  }
  static std::array<double, 5> DistortionOf(const Matrix& matrix) {
    std::array<double, 5> lens{};
    const std::size_t count = std::min<std::size_t>(matrix.data.size() / sizeof(float), lens.size());
    for (std::size_t i = 0; matrix.type == slamdb::detail::kCv32F && i < count; ++i) {
      float number;
      std::memcpy(&number, matrix.data.data() + i * sizeof(float), sizeof number);
      lens[i] = number;
    }
    return lens;
  }

  // Where the IMU is, by the pose of the camera.
  void AskBody(const KeyFrame& keyframe) {
    const ImuCalibration& imu = keyframe.imu_calibration;
    if (!imu.is_set || !keyframe.imu_initialized) return;
    const Eigen::Vector3f body = keyframe.camera_from_world.Normalized().Inverse() * imu.camera_from_body.translation;
    constexpr float kNear = 0.01F;  // metres
    body_.Ask((body - keyframe.body_position).norm() < kNear * (1 + body.norm()));
  }

  // Keyframes that it refers to refer to it.
  void AskGraph(const KeyFrame& keyframe, const Reprojection& reprojection) {
    const auto back = [&](KeyFrameId id, const auto& refers) {
      const KeyFrame* other = id ? reprojection.Find(id) : nullptr;
      if (id) graph_.Ask(other != nullptr && refers(*other));
    };
    for (const auto edges : {&KeyFrame::loop_edges, &KeyFrame::merge_edges})
      for (const KeyFrameId edge : keyframe.*edges)
        back(edge, [&](const KeyFrame& other) {
          return std::ranges::find(other.*edges, keyframe.id) != (other.*edges).end();
        });
    back(keyframe.parent,
         [&](const KeyFrame& other) { return std::ranges::find(other.children, keyframe.id) != other.children.end(); });
    back(keyframe.previous, [&](const KeyFrame& other) { return other.next == keyframe.id; });
    if (keyframe.previous) order_.Ask(keyframe.previous < keyframe.id);
    if (keyframe.next) order_.Ask(keyframe.id < keyframe.next);
    for (const KeyFrameId child : keyframe.children)
      back(child, [&](const KeyFrame& other) { return other.parent == keyframe.id; });
    for (const Connection& connection : keyframe.connections)
      back(connection.keyframe, [&](const KeyFrame& other) {
        return std::ranges::find(other.connections, keyframe.id, &Connection::keyframe) != other.connections.end();
      });
  }

  void AskPoint(const MapPoint& point, const Reprojection& reprojection) {
    std::size_t sides = 0;
    std::vector<Eigen::Vector3f> centers;
    bool same_look = false, looked = false, is_reference = false;
    for (const Observation& observation : point.observations) {
      for (const std::int32_t side : {observation.left, observation.right}) sides += side >= 0;
      is_reference = is_reference || observation.keyframe == point.reference;
      const KeyFrame* keyframe = reprojection.Find(observation.keyframe);
      if (keyframe == nullptr) {
        matches_.Ask(false);
        continue;
      }
      centers.push_back(CameraCenter(*keyframe));
      const auto row = static_cast<std::size_t>(observation.left >= 0 ? observation.left : observation.right);
      const Column<Descriptor>& looks = keyframe->features.descriptors;
      looked = looked || row < looks.size();
      same_look = same_look || (row < looks.size() && looks[row] == point.descriptor);
      const Column<MapPointId>& matches = keyframe->features.map_points;
      matches_.Ask(row < matches.size() && matches[row] == point.id);
    }
    if (point.observations.empty()) return;
    counts_.Ask(point.observation_count >= static_cast<std::int32_t>(sides) &&
                point.observation_count <= 2 * static_cast<std::int32_t>(sides));
    reference_.Ask(is_reference);
    if (looked && point.has_descriptor()) looks_.Ask(same_look);
    AskPlace(point, centers, reprojection);
  }

  void AskProjections(const MapPoint& point, const Reprojection& reprojection) {
    std::size_t left = kMostObservations;
    for (const Observation& observation : point.observations) {
      const KeyFrame* keyframe = left > 0 ? reprojection.Find(observation.keyframe) : nullptr;
      if (keyframe == nullptr) continue;
      if (!atlas_.cameras.empty() && ObservedKeypoint(*keyframe, observation.right) != nullptr)
        right_.Ask(reprojection.Of(point, observation).right < kFarthest);
      if (ObservedKeypoint(*keyframe, observation.left) == nullptr) continue;
      --left;
      AskProjection(point, *keyframe, observation, reprojection);
    }
  }
  // Where the cameras are lost, by what the keyframe repeats of them: in the middle, where a fisheye distorts little.
  void AskProjection(const MapPoint& point, const KeyFrame& keyframe, const Observation& observation,
                     const Reprojection& reprojection) {
    if (!atlas_.cameras.empty()) return AskError(reprojection.Of(point, observation).left);
    if (keyframe.features.is_fisheye_stereo()) return;
    const Intrinsics& of = keyframe.intrinsics;
    const Keypoint& keypoint = *ObservedKeypoint(keyframe, observation.left);
    if (std::hypot((keypoint.x - of.cx) / of.fx, (keypoint.y - of.cy) / of.fy) > kMiddle) return;
    Camera camera{.model = CameraModel::kPinhole};
    camera.parameters = {of.fx, of.fy, of.cx, of.cy};
    const Rigid3f pose = keyframe.camera_from_world.Normalized();
    const auto pixel = Project(camera, pose.rotation * point.position + pose.translation);
    AskError(pixel ? (*pixel - Eigen::Vector2f(keypoint.x, keypoint.y)).norm() : kFarthest);
  }
  void AskError(float pixels) {
    projects_.Ask(pixels < kFarthest);
    sharp_.Ask(pixels < kFar);
    pixels_ += pixels < kFarthest ? pixels : kFarthest;  // which may be none
  }

  void AskPlace(const MapPoint& point, std::span<const Eigen::Vector3f> centers, const Reprojection& reprojection) {
    if (!centers.empty()) {
      const Eigen::Vector3f seen = MeanViewingDirection(point.position, centers);
      const float length = point.normal.norm();
      faces_.Ask(length > 0.2F && length < 1.01F && point.normal.dot(seen) > 0.7F * length * seen.norm());
    }
    if (const KeyFrame* reference = reprojection.Find(point.reference)) {
      const float distance = (point.position - CameraCenter(*reference)).norm();
      const std::vector<float>& factors = reference->pyramid.factors;
      const float range = factors.empty() ? 0 : factors.back() * point.min_distance;
      near_.Ask(distance >= point.min_distance / 2 && distance <= point.max_distance * 2 &&
                (range == 0 || std::abs(point.max_distance - range) < 0.02F * range));
    }
    const KeyFrame* first = reprojection.Find(KeyFrameId(static_cast<std::uint64_t>(point.first_keyframe)));
    if (first != nullptr) first_.Ask(static_cast<std::int64_t>(first->frame_id) == point.first_frame);
    if (point.first_keyframe >= 0) born_.Ask(point.first_keyframe <= point.first_frame);
  }

  // The camera's parameters begin with what the keyframe repeats.
  void AskCamera(const KeyFrame& keyframe) {
    const auto camera = std::ranges::find(atlas_.cameras, keyframe.camera, &Camera::id);
    if (camera == atlas_.cameras.end() || camera->parameters.size() < 4) return;
    const Intrinsics& of = keyframe.intrinsics;
    const std::array<float, 4> own = {of.fx, of.fy, of.cx, of.cy};
    camera_.Ask(std::equal(own.begin(), own.end(), camera->parameters.begin()));
  }
  // One that was never set is the identity, not half a turn about an axis.
  void AskUnset(const Rigid3f& pose) {
    unset_.Ask(std::abs(pose.rotation.x()) != 1 && std::abs(pose.rotation.z()) != 1);
  }

  static constexpr std::size_t kEnough = 5, kMostKeyFrames = 200, kMostKeypoints = 20, kMostPoints = 600,
                               kMostObservations = 6;
  static constexpr float kMiddle = 0.3F;            // of the focal length
  static constexpr float kFar = 5, kFarthest = 20;  // pixels

  const Atlas& atlas_;
  std::vector<Reprojection> reprojections_;  // of its maps
  double pixels_ = 0;                        // of all that projects_ was asked
  Question pose_{"orientations of keyframes are no rotations", {"KeyFrame.mTcw"}};
  Question unset_{"poses that were never set are half a turn", {}};
  Question camera_{"keyframes and cameras have other intrinsics", {"KeyFrame.fx", "KeyFrame.cx"}};
  Question times_{"times of keyframes do not rise, or are hours or no time apart",
                  {"KeyFrame.mTimeStamp", "KeyFrame.mnId"}};
  Question ticks_{"times of keyframes are whole seconds apart", {"KeyFrame.mTimeStamp"}, true};
  Question graph_{"keyframes do not refer to each other", {"KeyFrame.mBackupParentId", "KeyFrame.mvBackupChildrensId"}};
  Question order_{"keyframes do not come between the one before and the one after them",
                  {"KeyFrame.mBackupPrevKFId", "KeyFrame.mBackupNextKFId"}};
  Question sides_{"keypoints of both sides are not as many as all", {"KeyFrame.NLeft", "KeyFrame.NRight"}};
  Question depths_{"depths and columns in the right image do not fit", {"KeyFrame.mvDepth", "KeyFrame.mvuRight"}};
  Question lens_{"keypoints are not where the lens puts the undistorted ones",
                 {"KeyFrame.mvKeys", "KeyFrame.mvKeysUn"}};
  Question body_{"positions of bodies are not those of their cameras", {"KeyFrame.mOwb", "KeyFrame.mTcw"}};
  Question projects_{"map points are not where keyframes see them", {"KeyFrame.mTcw", "KeyFrame.mvKeysUn"}};
  Question right_{"map points are not where right eyes see them", {"KeyFrame.mTlr", "KeyFrame.mvKeysRight"}};
  Question sharp_{"map points are some pixels from where keyframes see them", {"KeyFrame.mTcw", "KeyFrame.mvKeysUn"}};
  Question faces_{"normals of map points do not face their keyframes", {"MapPoint.mNormalVector", "KeyFrame.mTcw"}};
  Question near_{"map points are out of the distances at which they are seen",
                 {"MapPoint.mfMinDistance", "MapPoint.mfMaxDistance", "MapPoint.mBackupRefKFId", "KeyFrame.mTcw"}};
  Question counts_{"counts of observations are others than there are", {"MapPoint.nObs"}};
  Question looks_{"descriptors of map points are none of their keypoints'",
                  {"MapPoint.mDescriptor", "KeyFrame.mDescriptors"}};
  Question matches_{"keyframes and map points do not refer to each other", {"KeyFrame.mvBackupMapPointsId"}};
  Question reference_{"map points are not seen by their reference keyframes", {"MapPoint.mBackupRefKFId"}};
  Question first_{"map points are of other frames than their first keyframes",
                  {"MapPoint.mnFirstKFid", "MapPoint.mnFirstFrame", "KeyFrame.mnFrameId"}};
  Question born_{"map points are of keyframes that came after their frames",
                 {"MapPoint.mnFirstKFid", "MapPoint.mnFirstFrame"}};
};

}  // namespace

layouts::Meaning MeaningOf(const Atlas& atlas, const ForkProgram& program) {
  Interview interview(atlas);
  interview.AskPoses();
  interview.AskRest();
  layouts::Meaning meaning = interview.Answer(program);
  for (std::string& doubt : DoubtsOfMissing(program)) meaning.doubts.push_back(std::move(doubt));
  return meaning;
}

std::vector<std::string> DoubtsOfMissing(const ForkProgram& program) {
  std::vector<std::string> doubts;
  for (const Needed& needed : kNeeded)
    if (program.Lacks(needed.member)) doubts.push_back(Concat("no member is ", needed.member, ": ", needed.instead));
  return doubts;
}

std::string DoubtOfPoses(const Atlas& atlas) {
  Interview interview(atlas);
  interview.AskPoses();
  return interview.AnswerOfPoses();
}

}  // namespace slamdb::orbslam3
