// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/trajectory/detail/pose_text.h"

#include <algorithm>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/formats/export/detail/maps.h"
#include "slamdb/formats/export/detail/rows.h"
#include "slamdb/formats/trajectory/detail/poses.h"
#include "slamdb/model/detail/camera_in_world.h"

namespace slamdb::detail {

Atlas ReadPoses(const Source& source, PoseLayout layout, const ReadOptions& options, Notices& notices) {
  PoseAtlas atlas;
  PositionRounding rounding;
  for (const MapText& map : ReadTrajectoryText(source, layout, options, notices)) {
    atlas.BeginMap(map.id);
    for (const PoseText& pose : map.poses)
      rounding.Add(pose.translation,
                   ExactCenter(atlas.Add(pose.timestamp, pose.quaternion, pose.translation).camera_from_world));
  }
  rounding.Tell("rounded", notices);
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

void WriteMapLines(const std::vector<MapLines>& maps, std::string_view header, const PoseCount& count,
                   const Target& target, const WriteOptions& options, Notices& notices) {
  WarnOfSeveralFrames(maps.size(), "lines `# map N` tell them apart", notices);
  AtomicFile file(target, FileOptions(options));
  file.Write(header);
  for (const auto& [id, lines] : maps) {
    if (maps.size() > 1) file.Write(Concat("# map ", id.value(), '\n'));
    file.Write(lines);
  }
  file.Commit();
  notices.Tell(count.Summary(), WrittenCounts{.keyframes = count.poses});
}

}  // namespace slamdb::detail
