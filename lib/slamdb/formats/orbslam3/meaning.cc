// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam3/detail/meaning.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/orbslam3/detail/fork.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/detail/is_pose.h"
#include "slamdb/model/reprojection.h"

namespace slamdb::orbslam3 {
namespace {

using detail::Concat;

constexpr double kWrong =
    60;  // a question to which all answers are wrong weighs as much as a member that is not like it
constexpr double kUnasked = 15;
constexpr double kMost = 0.5;  // of the answers: more that are wrong make a doubt

// One thing that holds of nearly all keyframes or points of a sound file.
struct Question {
  std::string_view doubt;                 // what is said where it does not
  std::vector<std::string_view> members;  // that it is about
  std::size_t asked = 0, wrong = 0;

  void Ask(bool right) {
    ++asked;
    wrong += !right;
  }
  double share() const { return asked == 0 ? 0 : static_cast<double>(wrong) / static_cast<double>(asked); }
};

class Interview {
 public:
  explicit Interview(const Atlas& atlas) : atlas_(atlas) {}

  void Run() {
    std::size_t points = 0;
    for (const Map& map : atlas_.maps) points += map.points.size();
    const std::size_t step = points / kMostPoints + 1;
    for (const Map& map : atlas_.maps) {
      const Reprojection reprojection(atlas_, map);
      AskKeyFrames(map, reprojection);
      for (std::size_t row = 0; row < map.points.size(); row += step) AskPoint(map.points[row], reprojection);
    }
  }

  layouts::Meaning Answer(const ForkProgram& program) const {
    layouts::Meaning meaning;
    for (const Question* question : {&pose_, &rest_, &camera_, &times_, &graph_, &projects_, &faces_, &near_, &counts_,
                                     &looks_, &matches_, &reference_, &first_}) {
      if (question->asked == 0 ||
          std::ranges::any_of(question->members, [&](std::string_view name) { return program.Lacks(name); })) {
        meaning.penalty += kUnasked;  // less than a wrong answer, but it must not pay to leave out what is asked about
        continue;
      }
      meaning.penalty += kWrong * question->share();
      if (question->share() > kMost) meaning.doubts.push_back(DoubtOf(*question));
    }
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

  void AskKeyFrames(const Map& map, const Reprojection& reprojection) {
    std::vector<const KeyFrame*> by_id;
    const std::size_t step = map.keyframes.size() / kMostKeyFrames + 1;
    for (std::size_t row = 0; row < map.keyframes.size(); ++row) {
      const KeyFrame& keyframe = map.keyframes[row];
      by_id.push_back(&keyframe);
      if (row % step == 0) AskKeyFrame(keyframe, reprojection);
    }
    std::ranges::sort(by_id, {}, [](const KeyFrame* keyframe) { return keyframe->id; });
    for (std::size_t i = 1; i < by_id.size(); ++i) {
      times_.Ask(IsTime(by_id[i]->timestamp) && Follows(by_id[i]->timestamp, by_id[i - 1]->timestamp));
    }
  }

  void AskKeyFrame(const KeyFrame& keyframe, const Reprojection& reprojection) {
    AskCamera(keyframe);
    for (const Rigid3f* pose : {&keyframe.camera_from_parent, &keyframe.left_from_right,
                                &keyframe.imu_calibration.camera_from_body, &keyframe.imu_calibration.body_from_camera})
      AskRest(*pose);
    pose_.Ask(slamdb::detail::IsUnit(keyframe.camera_from_world.rotation) &&
              keyframe.camera_from_world.translation.cwiseAbs().maxCoeff() < 1e7F);
    AskGraph(keyframe, reprojection);
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
    for (const KeyFrameId child : keyframe.children)
      back(child, [&](const KeyFrame& other) { return other.parent == keyframe.id; });
    for (const Connection& connection : keyframe.connections)
      back(connection.keyframe, [&](const KeyFrame& other) {
        return std::ranges::find(other.connections, keyframe.id, &Connection::keyframe) != other.connections.end();
      });
  }

  void AskPoint(const MapPoint& point, const Reprojection& reprojection) {
    std::size_t sides = 0, left = kMostObservations;
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
      if (left > 0 && ObservedKeypoint(*keyframe, observation.left) != nullptr) {
        --left;
        AskProjection(point, *keyframe, observation, reprojection);
      }
    }
    if (point.observations.empty()) return;
    counts_.Ask(point.observation_count >= static_cast<std::int32_t>(sides) &&
                point.observation_count <= 2 * static_cast<std::int32_t>(sides));
    reference_.Ask(is_reference);
    if (looked && point.has_descriptor()) looks_.Ask(same_look);
    AskPlace(point, centers, reprojection);
  }

  // Where the cameras are lost, by what the keyframe repeats of them: in the middle, where a fisheye distorts little.
  void AskProjection(const MapPoint& point, const KeyFrame& keyframe, const Observation& observation,
                     const Reprojection& reprojection) {
    if (!atlas_.cameras.empty()) return projects_.Ask(reprojection.Of(point, observation).left < kFarthest);
    if (keyframe.features.is_fisheye_stereo()) return;
    const Intrinsics& of = keyframe.intrinsics;
    const Keypoint& keypoint = *ObservedKeypoint(keyframe, observation.left);
    if (std::hypot((keypoint.x - of.cx) / of.fx, (keypoint.y - of.cy) / of.fy) > kMiddle) return;
    Camera camera{.model = CameraModel::kPinhole};
    camera.parameters = {of.fx, of.fy, of.cx, of.cy};
    const Rigid3f pose = keyframe.camera_from_world.Normalized();
    const auto pixel = Project(camera, pose.rotation * point.position + pose.translation);
    projects_.Ask(pixel && (*pixel - Eigen::Vector2f(keypoint.x, keypoint.y)).norm() < kFarthest);
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
  void AskRest(const Rigid3f& pose) { rest_.Ask(std::abs(pose.rotation.x()) != 1 && std::abs(pose.rotation.z()) != 1); }

  static constexpr std::size_t kEnough = 5, kMostKeyFrames = 200, kMostPoints = 600, kMostObservations = 6;
  static constexpr float kMiddle = 0.3F;  // of the focal length
  static constexpr float kFarthest = 20;  // pixels

  const Atlas& atlas_;
  Question pose_{"orientations of keyframes are no rotations", {"KeyFrame.mTcw"}};
  Question rest_{"poses that were never set are half a turn", {}};
  Question camera_{"keyframes and cameras have other intrinsics", {"KeyFrame.fx", "KeyFrame.cx"}};
  Question times_{"times of keyframes do not rise", {"KeyFrame.mTimeStamp", "KeyFrame.mnId"}};
  Question graph_{"keyframes do not refer to each other", {"KeyFrame.mBackupParentId", "KeyFrame.mvBackupChildrensId"}};
  Question projects_{"map points are not where keyframes see them", {"KeyFrame.mTcw", "KeyFrame.mvKeysUn"}};
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
};

}  // namespace

layouts::Meaning MeaningOf(const Atlas& atlas, const ForkProgram& program) {
  Interview interview(atlas);
  interview.Run();
  return interview.Answer(program);
}

std::string DoubtOfPoses(const Atlas& atlas) {
  Interview interview(atlas);
  interview.Run();
  return interview.AnswerOfPoses();
}

}  // namespace slamdb::orbslam3
