// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/trajectory/detail/pose_text.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/formats/export/detail/rows.h"
#include "slamdb/formats/trajectory/detail/poses.h"

namespace slamdb::detail {
namespace {

// What single precision makes of positions; a rounding that nobody would see is none.
class Rounding {
 public:
  void Add(const Eigen::Vector3d& position, const KeyFrame& keyframe) {
    const Rigid3f& pose = keyframe.camera_from_world;
    const Eigen::Vector3d center =
        -(pose.rotation.cast<double>().normalized().conjugate() * pose.translation.cast<double>());
    const double error = (center - position).norm();
    constexpr double kSeen = 5e-4;  // metres
    if (error <= kSeen) return;
    ++poses_;
    worst_ = std::max(worst_, error);
    farthest_ = std::max(farthest_, position.cwiseAbs().maxCoeff());
  }

  void Tell(Notices& notices) const {
    if (poses_ == 0) return;
    notices.Lose(Concat("positions reach ", Fixed(farthest_, 0), ", where single precision has steps of ",
                        Digits(farthest_ * std::numeric_limits<float>::epsilon(), 1), ": rounded by up to ",
                        Digits(worst_, 2), ": ", Counted(poses_, "pose")));
  }

 private:
  std::size_t poses_ = 0;
  double worst_ = 0, farthest_ = 0;
};

}  // namespace

Atlas ReadPoses(const Source& source, PoseLayout layout, const ReadOptions& options, Notices& notices) {
  PoseAtlas atlas;
  Rounding rounding;
  for (const MapText& map : ReadTrajectoryText(source, layout, options, notices)) {
    atlas.BeginMap(map.id);
    for (const PoseText& pose : map.poses)
      rounding.Add(pose.translation, atlas.Add(pose.timestamp, pose.quaternion, pose.translation));
  }
  rounding.Tell(notices);
  return atlas.Finish(options);
}

void Select(TrajectoryText& maps, const Selection& selection) {
  std::uint64_t next = 0;
  for (MapText& map : maps) {
    std::erase_if(map.poses, [&](const PoseText& pose) {
      const std::uint64_t id = next++;
      return id < selection.first_keyframe || id > selection.last_keyframe || pose.timestamp < selection.begin_time ||
             pose.timestamp > selection.end_time;
    });
    std::ranges::stable_sort(map.poses, {}, &PoseText::timestamp);
  }
  std::erase_if(maps,
                [&](const MapText& map) { return map.poses.empty() || (selection.map && map.id != *selection.map); });
}

void SetText(PoseText& pose, const Eigen::Vector3f& position,
             const Eigen::Quaternion<float, Eigen::DontAlign>& rotation) {
  for (int i = 0; i < 3; ++i) AppendNumber(pose.position[static_cast<std::size_t>(i)], position[i]);
  for (int i = 0; i < 4; ++i) AppendNumber(pose.rotation[static_cast<std::size_t>(i)], rotation.coeffs()[i]);
}

void WriteMapLines(const Target& target, const WriteOptions& options, std::string_view header,
                   const std::vector<MapLines>& maps) {
  AtomicFile file(target, FileOptions(options));
  file.Write(header);
  for (const auto& [id, lines] : maps) {
    if (maps.size() > 1) file.Write(Concat("# map ", id.value(), '\n'));
    file.Write(lines);
  }
  file.Commit();
}

}  // namespace slamdb::detail
