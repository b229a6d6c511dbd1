// SPDX-License-Identifier: BSD-3-Clause
// 1. The transform: given, or solved from what both maps have in common.
// 2. The second map is moved by it.
// 3. The pair of keyframes by which the maps are linked.
// 4. The second tree is turned round and hung on; lists and flags of the second map go into the first.
// 5. Points that are there twice are fused.
#include "slamdb/edit/merge/join.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <string>
#include <unordered_map>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/steps.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/frame/detail/unit.h"
#include "slamdb/edit/frame/transform.h"
#include "slamdb/edit/ids/detail/references.h"
#include "slamdb/edit/landmarks/landmarks.h"
#include "slamdb/edit/merge/detail/mixture.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/detail/spanning_tree.h"
#include "slamdb/model/index.h"
#include "slamdb/model/umeyama.h"

namespace slamdb {
namespace {

constexpr std::size_t kMostCompared = 4096;  // keyframes of each map among which the linked pair is sought

std::size_t RowOfMap(const Atlas& atlas, MapId id) {
  std::string ids;
  for (std::size_t row = 0; row < atlas.maps.size(); ++row) {
    if (atlas.maps[row].id != id) {
      ids += (ids.empty() ? "" : ", ") + std::to_string(atlas.maps[row].id.value());
      continue;
    }
    if (atlas.maps[row].keyframes.empty() && atlas.maps[row].landmarks.empty())
      throw Error(ErrorKind::kNotPossible,
                  ToString(id) + " has neither keyframes nor landmarks, so there is nothing to join");
    return row;
  }
  throw Error(ErrorKind::kNotPossible, "there is no " + ToString(id) + "; maps are " + (ids.empty() ? "none" : ids));
}

std::uint32_t RowOfKeyFrame(const Map& map, const IdTable& rows, KeyFrameId id) {
  const std::uint32_t row = rows.Find(id.value());
  if (row == kNoRow) throw Error(ErrorKind::kNotPossible, ToString(id) + " is not in " + ToString(map.id));
  return row;
}

// ---- the transform

struct Correspondences {
  std::vector<Eigen::Vector3d> first, second;
};

Correspondences Gather(const Map& first, const Map& second, const JoinOptions& options) {
  Correspondences pairs;
  const IdTable first_rows = KeyFrameTable(first), second_rows = KeyFrameTable(second);
  for (const KeyFramePair& anchor : options.anchors) {
    const auto a = RowOfKeyFrame(first, first_rows, anchor.first);
    const auto b = RowOfKeyFrame(second, second_rows, anchor.second);
    pairs.first.emplace_back(CameraCenter(first.keyframes[a]).cast<double>());
    pairs.second.emplace_back(CameraCenter(second.keyframes[b]).cast<double>());
  }
  for (const PlacePair& place : options.places) {
    pairs.first.push_back(place.first);
    pairs.second.push_back(place.second);
  }
  return pairs;
}

// Landmarks alone are in one frame unless told otherwise, as MRPT's fuseWith takes them.
bool IsOfLandmarks(const Map& map) { return map.keyframes.empty(); }

Similarity3d Solve(const Map& first, const Map& second, const JoinOptions& options, JoinReport& report) {
  const Correspondences pairs = Gather(first, second, options);
  if (pairs.first.empty()) {
    if (IsOfLandmarks(first) && IsOfLandmarks(second)) return {};
    throw Error(ErrorKind::kUsage, "joining needs a transform, or anchors to solve it from");
  }
  UmeyamaOptions umeyama;
  umeyama.with_scale =
      options.with_scale.value_or(detail::HasArbitraryScale(first) || detail::HasArbitraryScale(second));
  umeyama.outlier_distance = options.outlier_distance.value_or(umeyama.outlier_distance);
  UmeyamaResult solved = SolveUmeyama(pairs.second, pairs.first, umeyama);
  if (auto poor = PoorFitWarning(solved.rms, solved.spread)) report.warnings.push_back(*std::move(poor));
  AnchorFit fit{.rms = solved.rms};
  for (std::size_t i = 0; i < solved.residuals.size(); ++i)
    if (solved.inliers[i]) fit.max = std::max(fit.max, solved.residuals[i]);
  fit.residuals = std::move(solved.residuals);
  fit.inliers = std::move(solved.inliers);
  report.fit = std::move(fit);
  return solved.target_from_source;
}

// What does not go together; throws for what makes the joined map wrong.
void Compare(const Map& first, const Map& second, const JoinOptions& options, JoinReport& report) {
  const detail::NamedMap a{&first, ToString(first.id)}, b{&second, ToString(second.id)};
  const double scale = report.first_from_second.scale;
  const std::string problem = detail::ScaleProblem(a, b, scale), warning = detail::ScaleWarning(a, b, scale);
  if (!problem.empty() && !options.force)
    throw Error(ErrorKind::kNotPossible, problem +
                                             (scale == 1 ? "; give another scale, or solve it from anchors"
                                                         : "; give a transform without scale, or solve one") +
                                             "; where both are of one scale all the same, JoinOptions::force joins");
  for (const std::string& sentence : {problem, warning})
    if (!sentence.empty()) report.warnings.push_back(sentence);
  for (detail::Mixture& mixture : detail::MixturesOf(a, b, detail::Together::kJoined))
    report.warnings.push_back(std::move(mixture.sentence));
}

// ---- the link

struct View {
  KeyFrameId id;
  Eigen::Vector3f center, direction;
};

// Evenly spaced keyframes of a map, all of them when they are few.
std::vector<View> ViewsOf(const Map& map) {
  const std::size_t step = map.keyframes.size() / kMostCompared + 1;
  std::vector<View> views;
  for (std::size_t row = 0; row < map.keyframes.size(); row += step) {
    const KeyFrame& keyframe = map.keyframes[row];
    if (keyframe.bad) continue;
    const Quaternionf world_from_camera = keyframe.camera_from_world.rotation.normalized().conjugate();
    views.push_back({keyframe.id, CameraCenter(keyframe), world_from_camera * Eigen::Vector3f::UnitZ()});
  }
  return views;
}

// The mean distance of points from their reference keyframes; 1 when there is none.
float SceneDepth(const Map& map) {
  const IdTable rows = KeyFrameTable(map);
  double sum = 0, count = 0;
  for (const MapPoint& point : map.points) {
    const std::uint32_t row = rows.Find(point.reference.value());
    if (row == kNoRow || !point.position.allFinite()) continue;
    sum += static_cast<double>((point.position - CameraCenter(map.keyframes[row])).norm());
    ++count;
  }
  return count > 0 && sum > 0 ? static_cast<float>(sum / count) : 1;
}

// The pair whose images differ least: by the baseline against the depth of the scene, and by the viewing direction.
KeyFramePair FindLink(const Map& first, const Map& second) {
  const std::vector<View> first_views = ViewsOf(first), second_views = ViewsOf(second);
  const float closeness = 1 / SceneDepth(first);
  KeyFramePair best{first.keyframes.front().id, second.keyframes.front().id};
  float least = std::numeric_limits<float>::infinity();
  for (const View& a : first_views)
    for (const View& b : second_views) {
      const float cost = ((a.center - b.center) * closeness).squaredNorm() + (a.direction - b.direction).squaredNorm();
      if (!(cost < least)) continue;
      least = cost;
      best = {a.id, b.id};
    }
  return best;
}

KeyFramePair ChooseLink(const Map& first, const Map& second, const JoinOptions& options, const JoinReport& report) {
  if (options.anchors.empty()) return FindLink(first, second);
  if (!report.fit) return options.anchors.front();
  const auto end = report.fit->residuals.begin() + static_cast<std::ptrdiff_t>(options.anchors.size());
  return options.anchors[static_cast<std::size_t>(std::min_element(report.fit->residuals.begin(), end) -
                                                  report.fit->residuals.begin())];
}

void AddMergeEdge(KeyFrame& keyframe, KeyFrameId other) {
  keyframe.not_erase = true;
  if (std::ranges::find(keyframe.merge_edges, other) == keyframe.merge_edges.end())
    keyframe.merge_edges.push_back(other);
}

void AddMergeEdges(Map& first, Map& second, const KeyFramePair& pair) {
  const std::uint32_t a = KeyFrameTable(first).Find(pair.first.value()),
                      b = KeyFrameTable(second).Find(pair.second.value());
  if (a == kNoRow || b == kNoRow) return;
  AddMergeEdge(first.keyframes[a], pair.second);
  AddMergeEdge(second.keyframes[b], pair.first);
}

// The diagonal of the box around its camera centres.
double Extent(const Map& map) {
  Eigen::AlignedBox3f box;
  for (const KeyFrame& keyframe : map.keyframes) box.extend(CameraCenter(keyframe));
  return static_cast<double>(box.diagonal().norm());
}

void WarnIfFarApart(const Map& first, const Map& second, JoinReport& report) {
  const double extent = std::max(Extent(first), Extent(second));
  if (report.link_distance <= extent) return;
  report.warnings.push_back(
      detail::Concat("the maps lie far apart: ", detail::Digits(report.link_distance, 3),
                     " between the keyframes that link them, where the larger map spans ", detail::Digits(extent, 3),
                     "; see whether the transform takes the second map to the first, and not back"));
}

// Hangs the second tree, turned round to the linked keyframe, on the first.
void Link(Map& first, Map& second, const KeyFramePair& link, JoinReport& report) {
  detail::RerootTree(second, link.second);
  KeyFrame& parent = first.keyframes[KeyFrameTable(first).Find(link.first.value())];
  KeyFrame& child = second.keyframes[KeyFrameTable(second).Find(link.second.value())];
  child.parent = parent.id;
  parent.children.push_back(child.id);
  for (KeyFrame& keyframe : second.keyframes)
    if (keyframe.parent) keyframe.first_connection = false;
  AddMergeEdges(first, second, link);
  report.link = link;
  report.link_distance = static_cast<double>((CameraCenter(parent) - CameraCenter(child)).norm());
}

// ---- one map of both

template <class Entity>
void MoveList(Column<Entity>& from, Column<Entity>& to) {
  to.reserve(to.size() + from.size());
  std::ranges::move(from, std::back_inserter(to));
  from.clear();
}

void Absorb(Map& first, Map& second, JoinReport& report) {
  report.keyframes = second.keyframes.size();
  report.points = second.points.size();
  report.left_inertial = first.inertial != second.inertial;
  first.max_keyframe_id = std::max(first.max_keyframe_id, second.max_keyframe_id);
  first.big_change_index = std::max(first.big_change_index, second.big_change_index) + 1;
  MoveList(second.keyframes, first.keyframes);
  MoveList(second.points, first.points);
  first.lowest_keyframe = detail::SmallestKeyFrame(first);
  first.inertial = first.inertial && second.inertial;
  first.imu_initialized = first.imu_initialized && second.imu_initialized;
  first.imu_ba1 = first.imu_ba1 && second.imu_ba1;
  first.imu_ba2 = first.imu_ba2 && second.imu_ba2;
}

FuseReport Fuse(Map& map, std::size_t second, const JoinOptions& options) {
  FuseOptions fuse = *options.fuse;
  fuse.threads = options.threads;
  fuse.progress = options.progress;
  return FusePoints(map, second, fuse);
}

// Landmarks follow the points that they stand for, of which some went into others; those of maps that have no points
// are compared themselves.
void AbsorbLandmarks(Map& first, Map& second, const JoinOptions& options, JoinReport& report) {
  report.landmarks = second.landmarks.size();
  const std::size_t own = first.landmarks.size();
  if (report.fused) {
    std::unordered_map<std::uint64_t, MapPointId> survivors;
    for (const auto& [gone, survivor] : report.fused->replaced) survivors.emplace(gone.value(), survivor);
    for (Landmark& landmark : second.landmarks)
      if (const auto found = survivors.find(landmark.id.value()); found != survivors.end())
        landmark.id = LandmarkId(found->second.value());
  }
  report.fused_landmarks = TakeLandmarks(first.landmarks, second.landmarks);
  if (!options.fuse || !first.points.empty()) return;
  report.alike =
      FuseAlikeLandmarks(first.landmarks, own, {.hamming = options.fuse->hamming, .threads = options.threads});
  report.fused_landmarks += report.alike->fused;
}

// Lists with null pointers and repetitions name rows of lists that are about to change, and of two entities with one id
// one would be lost.
void RefuseIrregular(const Atlas& atlas) {
  bool irregular = !atlas.repeated_maps.empty();
  for (const Map& map : atlas.maps) irregular |= !map.repeated_keyframes.empty() || !map.repeated_points.empty();
  if (irregular)
    throw Error(ErrorKind::kNotPossible, "lists hold null pointers or repetitions; `RepairAtlas` drops them");
  const AtlasIndex index(atlas);
  if (!index.duplicate_keyframes().empty() || !index.duplicate_points().empty())
    throw Error(ErrorKind::kNotPossible, "ids are there more than once; `CheckAtlas` lists them");
}

}  // namespace

JoinReport JoinMaps(Atlas& atlas, const JoinOptions& options) {
  detail::Steps steps(options.progress, "joining", 2);
  RefuseIrregular(atlas);
  const std::size_t first_row = RowOfMap(atlas, options.first), second_row = RowOfMap(atlas, options.second);
  if (first_row == second_row)
    throw Error(ErrorKind::kUsage, ToString(options.first) + " cannot be joined with itself");
  Map &first = atlas.maps[first_row], &second = atlas.maps[second_row];
  Gather(first, second, options);  // anchors must be there, whether they are needed for the transform or not
  JoinReport report{.first = options.first, .second = options.second};
  report.first_from_second =
      options.first_from_second ? *options.first_from_second : Solve(first, second, options, report);
  Compare(first, second, options, report);
  std::ranges::move(TransformWarnings(second, report.first_from_second), std::back_inserter(report.warnings));
  if (auto loss = CoarseningLoss(second, report.first_from_second)) report.warnings.push_back(*std::move(loss));
  TransformMap(second, report.first_from_second, options.threads);
  if (!IsOfLandmarks(first) && !IsOfLandmarks(second)) {
    Link(first, second, ChooseLink(first, second, options, report), report);
    for (const KeyFramePair& pair : options.merge_edges) AddMergeEdges(first, second, pair);
    WarnIfFarApart(first, second, report);
  }
  const std::size_t own_points = first.points.size();
  Absorb(first, second, report);
  steps.Next();
  if (options.fuse && own_points > 0 && report.points > 0) report.fused = Fuse(first, own_points, options);
  AbsorbLandmarks(first, second, options, report);
  atlas.maps.erase(atlas.maps.begin() + static_cast<std::ptrdiff_t>(second_row));
  steps.Next();
  return report;
}

}  // namespace slamdb
