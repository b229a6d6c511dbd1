// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/colmap/detail/ids.h"
#include "slamdb/formats/colmap/detail/local_origin.h"
#include "slamdb/formats/colmap/detail/map_maker.h"
#include "slamdb/formats/colmap/detail/models.h"
#include "slamdb/formats/colmap/detail/unread.h"
#include "slamdb/formats/detail/select.h"
#include "slamdb/formats/import/detail/complete.h"

namespace slamdb::colmap {
namespace {

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

// Refuses what a file that was cut off behind its head leaves: references of which not one leads anywhere. Single ones
// that lead nowhere are left out later, and counted.
template <class Row, class IdOf, class Target>
void RequireSome(const std::vector<Row>& rows, std::string_view noun, const IdOf& id_of,
                 const std::vector<Target>& targets, std::string_view target, const std::string& path) {
  const auto known = RowsById(targets);
  if (rows.empty() || std::ranges::any_of(rows, [&](const Row& row) { return known.contains(id_of(row)); })) return;
  throw Error(ErrorKind::kDamaged, path, "",
              detail::Concat("has ", detail::Counted(rows.size(), noun), " and not one ", target,
                             " that they name; was the file of ", target, "s cut off?"));
}

bool SeesPoints(const Image& image) {
  return std::ranges::any_of(image.points, [](const Point2& keypoint) { return keypoint.point != kNoPoint; });
}

void RequireWhole(const NamedModel& named) {
  const Model& model = named.model;
  const auto camera_of = [](const Image& image) { return image.camera; };
  const auto rig_of = [](const Frame& frame) { return frame.rig; };
  RequireSome(model.images, "image", camera_of, model.cameras, "camera", named.path);
  RequireSome(model.frames, "frame", rig_of, model.rigs, "rig", named.path);
  const auto fail = [&](std::string_view what) {
    throw Error(ErrorKind::kDamaged, named.path, "", detail::Concat("has ", what, "; was their file cut off?"));
  };
  if (!model.rigs.empty() && model.frames.empty() && !model.images.empty()) fail("rigs and images, and no frames");
  const auto has_track = [](const Point& point) { return point.track_length > 0; };
  if (model.images.empty() && std::ranges::any_of(model.points, has_track))
    fail("points that images see, and no images");
  if (model.images.empty() && model.points.empty())
    throw Error(ErrorKind::kDamaged, named.path, "", "holds no image and no point; were its files cut off?");
  if (model.points.empty() && std::ranges::any_of(model.images, SeesPoints))
    fail("images that see points, and no points");
}

template <class Rows, class IdOf>
std::vector<std::uint64_t> IdsOf(const Rows& rows, const IdOf& id_of) {
  std::vector<std::uint64_t> ids;
  ids.reserve(rows.size());
  for (const auto& row : rows) ids.push_back(id_of(row.id));
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
    RequireWhole(named);
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
