// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "slamdb/edit/diff/detail/diff_match.h"
#include "slamdb/view/page.h"

// All that is on the page: the maps of all atlases one behind the other.
namespace slamdb::view {

// One atlas of the scene, and which rows are its own.
struct SceneAtlas {
  SceneAtlas(const ViewInput& shown, std::uint32_t map, std::uint32_t keyframe, std::uint32_t point,
             std::uint32_t camera)
      : input(shown),
        numbered(*shown.atlas),
        first_map(map),
        first_keyframe(keyframe),
        first_point(point),
        first_camera(camera) {}

  const Atlas& atlas() const { return numbered.atlas(); }

  // Rows of the scene, -1 where there is none.
  std::int64_t KeyFrameRow(std::uint32_t map, KeyFrameId id) const {
    const std::uint32_t number = numbered.FindKeyFrame(map, id);
    return number == kNoRow ? -1 : std::int64_t{first_keyframe} + number;
  }
  std::int64_t PointRow(std::uint32_t map, MapPointId id) const {
    const std::uint32_t number = numbered.FindPoint(map, id);
    return number == kNoRow ? -1 : std::int64_t{first_point} + number;
  }

  const ViewInput& input;
  detail::NumberedAtlas numbered;
  std::uint32_t first_map, first_keyframe, first_point, first_camera;
};

class Scene {
 public:
  explicit Scene(std::span<const ViewInput> inputs);

  const std::deque<SceneAtlas>& atlases() const { return atlases_; }
  std::uint32_t maps() const { return maps_; }
  std::uint32_t keyframes() const { return keyframes_; }
  std::uint32_t points() const { return points_; }

  // visit(atlas, row of the map in it, its first row of the scene, how many) for each map, in order.
  template <class Visit>
  void ForEachMapOfPoints(const Visit& visit) const {
    for (const SceneAtlas& atlas : atlases_)
      for (std::uint32_t map = 0; map < atlas.atlas().maps.size(); ++map)
        visit(atlas, map, atlas.first_point + atlas.numbered.FirstPoint(map),
              static_cast<std::uint32_t>(atlas.atlas().maps[map].points.size()));
  }

  // visit(atlas, row of the map in it, keyframe) in the order of the rows.
  template <class Visit>
  void ForEachKeyFrame(const Visit& visit) const {
    for (const SceneAtlas& atlas : atlases_)
      for (std::uint32_t map = 0; map < atlas.atlas().maps.size(); ++map)
        for (const KeyFrame& keyframe : atlas.atlas().maps[map].keyframes) visit(atlas, map, keyframe);
  }
  // The same of points.
  template <class Visit>
  void ForEachPoint(const Visit& visit) const {
    for (const SceneAtlas& atlas : atlases_)
      for (std::uint32_t map = 0; map < atlas.atlas().maps.size(); ++map)
        for (const MapPoint& point : atlas.atlas().maps[map].points) visit(atlas, map, point);
  }

 private:
  std::deque<SceneAtlas> atlases_;
  std::uint32_t maps_ = 0, keyframes_ = 0, points_ = 0;
};

// What the second atlas changed of the first, by row of the scene.
struct SceneDiff {
  enum Status : std::uint8_t { kSame, kAdded, kRemoved, kMoved, kChanged };
  struct Kind {
    std::vector<Status> status;             // of each row
    std::vector<std::uint32_t> moved_from;  // for each row of the second that moved: that in the first
    std::uint64_t added = 0, removed = 0, moved = 0, changed = 0;
  };
  Kind keyframes, points;
};
// Throws Error (kUsage) when the scene has other than two atlases.
SceneDiff CompareAtlases(const Scene& scene, int threads);

}  // namespace slamdb::view
