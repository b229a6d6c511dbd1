// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/ply/detail/cameras.h"

#include "slamdb/formats/export/detail/frusta.h"

namespace slamdb::detail {

PlyCameras::PlyCameras(const Trajectories& trajectories, std::size_t first) : first_(first) {
  for (const KeyFrameTrajectory& trajectory : trajectories.maps) {
    const float depth = FrustumDepth(CentersOf(trajectory));
    for (const TimedPose& pose : trajectory.poses) {
      const auto centre = static_cast<std::uint32_t>(first_ + kVertices * cameras_.size());
      if (&pose != trajectory.poses.data()) edges_.push_back({centre - static_cast<std::uint32_t>(kVertices), centre});
      for (const auto& [from, to] : Frustum::kEdges) edges_.push_back({centre + from, centre + to});
      cameras_.push_back({trajectory.map, &pose, depth});
    }
  }
}

std::array<PlyVertex, PlyCameras::kVertices> PlyCameras::operator[](std::size_t camera) const {
  const auto& [map, pose, depth] = cameras_[camera];
  const Frustum frustum = FrustumOf(*pose->keyframe, depth);
  std::array<PlyVertex, kVertices> vertices;
  for (std::size_t i = 0; i < kVertices; ++i) {
    vertices[i].position = pose->world_from_it * frustum.vertices[i];
    vertices[i].normal = pose->world_from_it.rotation * Eigen::Vector3f::UnitZ();
    vertices[i].color = ColorOfMap(map->id);
    vertices[i].map = map->id.value();
    vertices[i].id = pose->keyframe->id.value();
    vertices[i].camera = i == 0 ? 1 : 2;
  }
  return vertices;
}

Color PlyCameras::ColorOf(const Edge& edge) const {
  return ColorOfMap(cameras_[(edge[0] - first_) / kVertices].map->id);
}

IdColumn PlyCameras::ColumnForIds() const {
  for (const Camera& camera : cameras_)
    if (!FitsUnsigned32(camera.pose->keyframe->id.value())) return IdColumn::kDouble;
  return IdColumn::kUnsigned32;
}

}  // namespace slamdb::detail
