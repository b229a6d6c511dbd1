// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/stella/detail/outgoing.h"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <span>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/export/detail/maps.h"
#include "slamdb/formats/import/detail/keypoints.h"
#include "slamdb/formats/stella/detail/cameras.h"
#include "slamdb/formats/stella/detail/lens.h"
#include "slamdb/model/detail/is_pose.h"

namespace slamdb::stella {
namespace {

using detail::Concat;
using detail::Counted;

constexpr std::uint64_t kMostIds = std::uint64_t{1} << 31;  // links are signed, of 32 bits

// Sorts by id, and makes the table of rows.
template <class Items, class IdOf>
IdTable SortById(Items& items, const IdOf& id_of, const std::string& path) {
  if (items.empty()) return {};
  if (!std::ranges::is_sorted(items, {}, id_of)) std::ranges::stable_sort(items, {}, id_of);
  const std::uint64_t highest = id_of(items.back()).value();
  if (highest >= kMostIds)
    throw Error(
        ErrorKind::kNotPossible, path, "",
        Concat(id_of(items.back()), " does not fit: ids of stella_vslam have 31 bits; renumber the atlas first"));
  IdTable rows(id_of(items.front()).value(), highest, items.size());
  for (std::size_t row = 0; row < items.size(); ++row)
    if (rows.Insert(id_of(items[row]).value(), static_cast<std::uint32_t>(row)) != kNoRow)
      throw Error(ErrorKind::kNotPossible, path, "",
                  Concat(id_of(items[row]),
                         " is there twice, and all that is in one file of stella_vslam needs ids of its own; write one "
                         "map alone, or renumber the atlas first"));
  return rows;
}

KeyFrameId IdOf(const OutgoingKeyFrame& written) { return written.keyframe->id; }
MapPointId IdOfPoint(const OutgoingPoint& written) { return written.point->id; }

// The next id to hand out: the recorded one where it is one.
template <class Items, class GetId>
std::uint64_t NextId(const Items& items, const GetId& id_of, std::uint64_t recorded) {
  const std::uint64_t least = items.empty() ? 0 : id_of(items.back()).value() + 1;
  return recorded >= least && recorded < kMostIds ? recorded : least;
}

bool HasStereo(const Features& features) {
  if (features.is_fisheye_stereo()) return false;
  return std::ranges::any_of(features.right_x, [](float x) { return x >= 0; }) ||
         std::ranges::any_of(features.depth, [](float depth) { return depth > 0; });
}

std::span<const float> Padded(const Column<float>& column, std::size_t rows, Column<float>& padded) {
  if (column.size() >= rows) return std::span(column).first(rows);
  padded = column;
  padded.resize(rows, -1.0F);
  return padded;
}

// As in every map of stella_vslam. Keyframes learn where theirs is now.
template <class Named>
void SortByName(std::vector<Named>& items, std::vector<OutgoingKeyFrame>& keyframes,
                std::size_t OutgoingKeyFrame::*row) {
  std::vector<std::size_t> order(items.size()), places(items.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t item) { return items[item].name; });
  std::vector<Named> sorted;
  for (const std::size_t item : order) {
    places[item] = sorted.size();
    sorted.push_back(std::move(items[item]));
  }
  items = std::move(sorted);
  for (OutgoingKeyFrame& keyframe : keyframes) keyframe.*row = places[keyframe.*row];
}

}  // namespace

std::int64_t FirstKeyFrameOf(const MapPoint& point) {
  return point.first_keyframe >= 0 && point.first_keyframe < static_cast<std::int64_t>(kMostIds) ? point.first_keyframe
                                                                                                 : -1;
}

Outgoing::Outgoing(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices)
    : path_(target.path) {
  const std::vector<const Map*> maps = detail::ChooseMaps(atlas, options, target);
  CollectKeyFrames(maps);
  CollectPoints(maps);
  FindSlots(options.threads);
  KeepSeenPoints();
  FindTree();
  FindCameras(atlas);
  FindOrbParams();
  next_keyframe_ = NextId(keyframes_, IdOf, atlas.next_ids.keyframe);
  next_point_ = NextId(points_, IdOfPoint, atlas.next_ids.map_point);
  losses_.Tell(notices);
  if (!atlas.vocabulary.name.empty() || !atlas.vocabulary.checksum.empty())
    notices.Lose("the name and checksum of the vocabulary are left out");
}

void Outgoing::CollectKeyFrames(const std::vector<const Map*>& maps) {
  for (const Map* map : maps)
    for (const KeyFrame& keyframe : map->keyframes) {
      if (!keyframe.bad && detail::IsPose(keyframe.camera_from_world)) {
        CountRows(keyframes_.emplace_back(OutgoingKeyFrame{.keyframe = &keyframe}));
        continue;
      }
      ++(keyframe.bad ? losses_.bad_keyframes : losses_.without_pose);
      left_out_.emplace(keyframe.id, keyframe.parent);
    }
  keyframe_rows_ = SortById(keyframes_, IdOf, path_);
}

// Keypoints of the left camera, as many as all columns have.
void Outgoing::CountRows(OutgoingKeyFrame& written) {
  const Features& features = written.keyframe->features;
  written.rows = std::min(features.undistorted.size(), features.map_points.size());
  if (features.is_fisheye_stereo()) {
    written.rows = std::min(features.keypoints.size(), features.map_points.size());
    losses_.right_keypoints += features.right_keypoints.size();
  }
  losses_.rows += (features.is_fisheye_stereo() ? features.keypoints : features.undistorted).size() - written.rows;
  losses_.without_descriptor += written.rows - std::min(written.rows, features.descriptors.size());
  losses_.merges += written.keyframe->merge_edges.size();
}

void Outgoing::CollectPoints(const std::vector<const Map*>& maps) {
  for (const Map* map : maps)
    for (const MapPoint& point : map->points) {
      if (point.bad)
        ++losses_.bad_points;
      else if (!point.position.allFinite())
        ++losses_.without_position;
      else
        points_.push_back({.point = &point, .reference = point.reference});
    }
  point_rows_ = SortById(points_, IdOfPoint, path_);
}

// What points say, and then what keypoints say of points that say nothing.
void Outgoing::FindSlots(int threads) {
  for (OutgoingKeyFrame& written : keyframes_) written.points.assign(written.rows, -1);
  for (const OutgoingPoint& written : points_) PlacePoint(*written.point);
  std::atomic<std::uint64_t> lost = 0, told = 0;
  detail::ParallelFor(keyframes_.size(), 1, threads, [&](std::size_t begin, std::size_t end) {
    for (OutgoingKeyFrame& written : std::span(keyframes_).subspan(begin, end - begin)) {
      const SlotCounts counts = PlaceSlots(written);
      lost += counts.lost;
      told += counts.told;
    }
  });
  losses_.slots = lost;
  losses_.told = told;
}

// Of several points that are one keypoint, it stays the one that it knows.
void Outgoing::PlacePoint(const MapPoint& point) {
  const auto id = static_cast<std::int32_t>(point.id.value());
  for (const Observation& observation : point.observations) {
    const std::uint32_t row = keyframe_rows_.Find(observation.keyframe.value());
    if (row == kNoRow || observation.left < 0) continue;
    OutgoingKeyFrame& written = keyframes_[row];
    const auto keypoint = static_cast<std::size_t>(observation.left);
    const bool is_there = keypoint < written.rows;
    const bool is_free = is_there && written.points[keypoint] < 0;
    if (!is_free) ++losses_.observations;
    if (is_free || (is_there && written.keyframe->features.map_points[keypoint] == point.id))
      written.points[keypoint] = id;
  }
}

// ORB-SLAM3 leaves keypoints that say they see a point which knows better.
Outgoing::SlotCounts Outgoing::PlaceSlots(OutgoingKeyFrame& written) const {
  SlotCounts counts;
  for (std::size_t row = 0; row < written.rows; ++row) {
    const MapPointId id = written.keyframe->features.map_points[row];
    std::int32_t& seen = written.points[row];
    if (seen >= 0 ? id == MapPointId(static_cast<std::uint64_t>(seen)) : !id) continue;
    counts.told += seen >= 0 ? 1 : 0;
    const std::uint32_t point = id ? point_rows_.Find(id.value()) : kNoRow;
    if (point == kNoRow) continue;
    if (seen < 0 && points_[point].point->observations.empty())
      seen = static_cast<std::int32_t>(id.value());
    else
      ++counts.lost;
  }
  return counts;
}

// stella_vslam needs a keyframe that sees a point, to describe it.
void Outgoing::KeepSeenPoints() {
  std::vector<KeyFrameId> seen_by(points_.size());  // the reference, or the first of them
  for (const OutgoingKeyFrame& written : keyframes_) {
    const KeyFrameId keyframe = IdOf(written);
    for (const std::int32_t id : written.points) {
      if (id < 0) continue;
      const std::uint32_t point = point_rows_.Find(static_cast<std::uint64_t>(id));
      if (!seen_by[point] || points_[point].reference == keyframe) seen_by[point] = keyframe;
    }
  }
  for (std::size_t row = 0; row < points_.size(); ++row) points_[row].reference = seen_by[row];
  losses_.unseen_points = std::erase_if(points_, [](const OutgoingPoint& point) { return !point.reference; });
}

// Of those that are left out the next above, so that the map does not fall apart.
KeyFrameId Outgoing::ParentOf(const KeyFrame& keyframe) {
  std::vector<KeyFrameId> passed;
  KeyFrameId parent = keyframe.parent;
  while (!IsWritten(parent)) {
    const auto above = left_out_.find(parent);
    if (above == left_out_.end()) break;
    passed.push_back(parent);
    parent = std::exchange(above->second, KeyFrameId());  // so that a circle ends
  }
  for (const KeyFrameId id : passed) left_out_[id] = parent;
  return parent;
}

// Parents lead to a root, as stella_vslam follows them without end; children are what parents say.
void Outgoing::FindTree() {
  std::vector<std::uint32_t> parents(keyframes_.size(), kNoRow), seen_from(keyframes_.size(), kNoRow);
  for (std::size_t row = 0; row < keyframes_.size(); ++row)
    if (const KeyFrameId parent = ParentOf(*keyframes_[row].keyframe); IsWritten(parent))
      parents[row] = keyframe_rows_.Find(parent.value());
  for (std::uint32_t start = 0; start < keyframes_.size(); ++start) {
    std::uint32_t row = start;
    while (seen_from[row] == kNoRow) {
      seen_from[row] = start;
      if (parents[row] == kNoRow) break;
      if (seen_from[parents[row]] == start) {
        parents[row] = kNoRow;  // a circle
        ++losses_.cut_loops;
        break;
      }
      row = parents[row];
    }
  }
  for (std::uint32_t row = 0; row < keyframes_.size(); ++row) {
    OutgoingKeyFrame& written = keyframes_[row];
    if (parents[row] != kNoRow) {
      written.parent = IdOf(keyframes_[parents[row]]);
      keyframes_[parents[row]].children.push_back(IdOf(written));
    }
    for (const KeyFrameId other : written.keyframe->loop_edges)
      if (IsWritten(other)) written.loop_edges.push_back(other);
    std::ranges::sort(written.loop_edges);
  }
}

void Outgoing::FindCameras(const Atlas& atlas) {
  std::map<CameraId, const Camera*> recorded;
  for (const Camera& camera : atlas.cameras) recorded.emplace(camera.id, &camera);
  std::map<LensCamera, std::size_t> rows;  // without setups
  std::map<std::string, int> names;
  for (OutgoingKeyFrame& written : keyframes_) {
    const KeyFrame& keyframe = *written.keyframe;
    const auto found = keyframe.camera ? recorded.find(keyframe.camera) : recorded.end();
    LensCamera lens = LensOf(keyframe, found == recorded.end() ? nullptr : found->second);
    if (!SetSize(lens, keyframe.bounds)) ++losses_.sizes;
    // Names keep apart what the atlas does.
    lens.name = Concat("camera ", keyframe.camera ? std::to_string(keyframe.camera.value()) : "none");
    const auto [row, is_new] = rows.try_emplace(lens, cameras_.size());
    written.camera = row->second;
    if (is_new) {
      const int twins = names[lens.name]++;
      if (twins > 0) lens.name += Concat(" (", twins + 1, ")");
      cameras_.push_back(std::move(lens));
    }
    LensCamera& camera = cameras_[written.camera];
    if (camera.setup == Setup::kMonocular && camera.focal_x_baseline > 0 && HasStereo(keyframe.features))
      camera.setup = Setup::kStereo;
  }
  SortByName(cameras_, keyframes_, &OutgoingKeyFrame::camera);
  for (OutgoingKeyFrame& written : keyframes_) written.has_stereo = cameras_[written.camera].setup != Setup::kMonocular;
}

void Outgoing::FindOrbParams() {
  std::map<OrbParams, std::size_t> rows;
  for (OutgoingKeyFrame& written : keyframes_) {
    const OrbParams params = OrbParams::Of(written.keyframe->pyramid);
    const auto [row, is_new] = rows.try_emplace(params, orb_params_.size());
    written.orb_params = row->second;
    if (is_new) orb_params_.push_back(params);
  }
  SortByName(orb_params_, keyframes_, &OutgoingKeyFrame::orb_params);
}

OutgoingFeatures Outgoing::FeaturesOf(const OutgoingKeyFrame& written) const {
  const Features& features = written.keyframe->features;
  const Column<Keypoint>& seen = features.is_fisheye_stereo() ? features.keypoints : features.undistorted;
  OutgoingFeatures out;
  out.undistorted = std::span(seen).first(written.rows);
  // ORB-SLAM3 leaves keypoints of fisheye cameras as they were detected.
  if (cameras_[written.camera].model == Model::kFisheye) {
    out.changed = Undistorted(cameras_[written.camera], seen);
    out.undistorted = std::span(out.changed).first(written.rows);
  }
  if (written.has_stereo) {
    out.right_x = Padded(features.right_x, written.rows, out.padded_right_x);
    out.depth = Padded(features.depth, written.rows, out.padded_depth);
  }
  return out;
}

std::uint64_t CountShapes(const OutgoingKeyFrame& written) {
  const Features& features = written.keyframe->features;
  const Column<Keypoint>& keypoints = features.is_fisheye_stereo() ? features.keypoints : features.undistorted;
  const ScalePyramid& pyramid = written.keyframe->pyramid;
  std::vector<float> patches;
  for (std::size_t level = 0; level < pyramid.factors.size(); ++level)
    patches.push_back(detail::PatchAt(static_cast<std::int32_t>(level), pyramid));
  std::uint64_t count = 0;
  for (std::size_t row = 0; row < written.rows; ++row) {
    const Keypoint& keypoint = keypoints[row];
    const auto level = static_cast<std::size_t>(keypoint.octave);
    const float usual = level < patches.size() ? patches[level] : detail::PatchAt(keypoint.octave, pyramid);
    count += keypoint.response != 0 || keypoint.size != usual ? 1 : 0;
  }
  return count;
}

void Outgoing::Losses::Tell(Notices& notices) const {
  const auto lose = [&](std::uint64_t count, std::string_view noun, std::string_view what) {
    if (count > 0) notices.Lose(Concat(Counted(count, noun), what));
  };
  lose(bad_keyframes, "keyframe", " flagged bad: left out");
  lose(without_pose, "keyframe", " whose pose is none, or not finite: left out");
  lose(bad_points, "point", " flagged bad: left out");
  lose(without_position, "point", " whose position is not finite: left out");
  lose(unseen_points, "point", " that no keyframe sees: left out, since stella_vslam could not load them");
  lose(right_keypoints, "keypoint", " of the right camera of a fisheye pair: left out, as stella_vslam has none such");
  lose(rows, "keypoint", " in columns of different lengths: left out");
  lose(slots, "keypoint",
       " that see a point which is observed elsewhere in their picture, or not at all: they see none");
  lose(observations, "observation", " of a keypoint that is not there, or sees another point: left out");
  lose(merges, "merge edge", ": left out, as stella_vslam has none");
  lose(cut_loops, "keyframe", " whose parents go round in a circle: made a root");
  if (told > 0)
    notices.Warn(
        Concat("points of which their keyframe does not know are seen by it now: ", Counted(told, "observation")));
  if (without_descriptor > 0)
    notices.Warn(
        Concat(Counted(without_descriptor, "keypoint"), " without a descriptor of 32 bytes: zeros stand for it"));
  if (sizes > 0)
    notices.Warn(
        Concat("the size of the picture is a guess from its undistorted corners: ", Counted(sizes, "keyframe")));
}

}  // namespace slamdb::stella
