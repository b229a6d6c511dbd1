// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/evaluate/evaluate.h"

namespace slamdb {
namespace {

constexpr std::size_t kBytesPerPose = 300;  // about

std::size_t CountPoses(const EvaluationReport& report) {
  std::size_t poses = 0;
  for (const TrajectoryEvaluation& evaluation : report.evaluations) poses += evaluation.poses.size();
  return poses;
}

void AppendAll(std::string& text, const Eigen::Vector3d& position, const Eigen::Quaterniond& rotation, char separator) {
  for (const double value :
       {position.x(), position.y(), position.z(), rotation.x(), rotation.y(), rotation.z(), rotation.w()}) {
    text += separator;
    detail::AppendNumber(text, value);
  }
}

// The map's id, where the estimate is one map.
std::string NameOf(const TrajectoryEvaluation& evaluation) {
  return evaluation.maps.size() == 1 ? std::to_string(evaluation.maps.front().value()) : std::string();
}

}  // namespace

std::string ErrorTable(const EvaluationReport& report) {
  std::string text =
      "map,timestamp,translation_error,rotation_error_degrees,x,y,z,qx,qy,qz,qw,reference_timestamp,reference_x,"
      "reference_y,reference_z,reference_qx,reference_qy,reference_qz,reference_qw\n";
  text.reserve(text.size() + kBytesPerPose * CountPoses(report));
  for (const TrajectoryEvaluation& evaluation : report.evaluations) {
    const std::string map = NameOf(evaluation);
    for (const PairedPose& pose : evaluation.poses) {
      text += map;
      text += ',';
      detail::AppendSeconds(text, pose.timestamp);
      for (const double error : {pose.translation_error, pose.rotation_error_degrees}) {
        text += ',';
        detail::AppendNumber(text, error);
      }
      AppendAll(text, pose.position, pose.rotation, ',');
      text += ',';
      detail::AppendSeconds(text, pose.reference_timestamp);
      AppendAll(text, pose.reference_position, pose.reference_rotation, ',');
      text += '\n';
    }
  }
  return text;
}

std::string AlignedTrajectory(const EvaluationReport& report) {
  std::string text = "# timestamp tx ty tz qx qy qz qw\n";
  text.reserve(text.size() + kBytesPerPose / 2 * CountPoses(report));
  for (const TrajectoryEvaluation& evaluation : report.evaluations) {
    if (report.evaluations.size() > 1) text += detail::Concat("# map ", NameOf(evaluation), '\n');
    for (const PairedPose& pose : evaluation.poses) {
      detail::AppendSeconds(text, pose.timestamp);
      AppendAll(text, pose.position, pose.rotation, ' ');
      text += '\n';
    }
  }
  return text;
}

}  // namespace slamdb
