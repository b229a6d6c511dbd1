// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/csv/detail/csv.h"

#include <algorithm>
#include <array>
#include <unordered_set>
#include <utility>
#include <vector>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/formats/export/detail/maps.h"
#include "slamdb/formats/export/detail/points.h"
#include "slamdb/formats/export/detail/pose.h"
#include "slamdb/formats/export/detail/rows.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/detail/is_pose.h"

namespace slamdb::detail {
namespace {

constexpr std::string_view kPointsHeader =
    "x,y,z,nx,ny,nz,observations,reprojection_error,map,id,reference_keyframe,min_distance,max_distance\n";
constexpr std::string_view kKeyFramesHeader =
    "map,id,timestamp,frame_id,x,y,z,qx,qy,qz,qw,camera,parent,children,connections,loop_edges,merge_edges,keypoints,"
    "map_points,vx,vy,vz\n";
constexpr std::string_view kObservationsHeader =
    "map,point,keyframe,left,x,y,octave,error,right,right_x,right_y,right_octave,right_error\n";

// Appends the cells of one line.
class Line {
 public:
  explicit Line(std::string& out) : out_(out) {}

  template <class Number>
  void Add(Number value) {
    Separate();
    AppendNumber(out_, value);
  }
  template <class Entity>
  void Add(Id<Entity> id) {
    Separate();
    if (id) AppendNumber(out_, id.value());
  }
  void AddSeconds(double seconds) {
    Separate();
    AppendSeconds(out_, seconds);
  }
  void Skip(int cells = 1) {
    for (; cells > 0; --cells) Separate();
  }
  void End() { out_ += '\n'; }

 private:
  void Separate() {
    if (!first_) out_ += ',';
    first_ = false;
  }
  std::string& out_;
  bool first_ = true;
};

void AppendPoint(std::string& out, const PointRows& points, std::size_t row) {
  const MapPoint& point = *points[row].point;
  Line line(out);
  for (const float value : point.position) line.Add(value);
  for (const float value : point.normal) line.Add(value);
  line.Add(point.observations.size());
  line.Add(points.mean_error(points[row]));
  line.Add(points.map_id(points[row]));
  line.Add(point.id);
  line.Add(point.reference);
  line.Add(point.min_distance);
  line.Add(point.max_distance);
  line.End();
}

void WritePoints(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  AtomicFile file(target, FileOptions(options));
  const PointRows points(atlas, target, options);
  WarnOfSeveralFrames(points.maps(), "the column `map` tells them apart", notices);
  file.Write(kPointsHeader);
  WriteRows(file, points.size(), 4096, options, [&](std::size_t begin, std::size_t end, std::string& out) {
    for (std::size_t row = begin; row < end; ++row) AppendPoint(out, points, row);
  });
  file.Commit();
  notices.Tell(points.Summary(), WrittenCounts{.points = points.size()});
}

void AppendKeyFrame(std::string& out, MapId map, const KeyFrame& keyframe) {
  const Rigid3f pose = PoseInWorld(keyframe, PoseFrame::kCamera);
  const auto& slots = keyframe.features.map_points;
  Line line(out);
  line.Add(map);
  line.Add(keyframe.id);
  line.AddSeconds(keyframe.timestamp);
  line.Add(keyframe.frame_id);
  for (const float value : pose.translation) line.Add(value);
  for (const float value : pose.rotation.coeffs()) line.Add(value);
  line.Add(keyframe.camera);
  line.Add(keyframe.parent);
  line.Add(keyframe.children.size());
  line.Add(keyframe.connections.size());
  line.Add(keyframe.loop_edges.size());
  line.Add(keyframe.merge_edges.size());
  line.Add(keyframe.features.count);
  line.Add(std::count_if(slots.begin(), slots.end(), [](MapPointId id) { return id.has_value(); }));
  if (keyframe.has_velocity)
    for (const float value : keyframe.velocity) line.Add(value);
  else
    line.Skip(3);
  line.End();
}

void WriteKeyFrames(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  AtomicFile file(target, FileOptions(options));
  const std::vector<const Map*> maps = ChooseMaps(atlas, options, target);
  WarnOfSeveralFrames(maps, "the column `map` tells them apart", notices);
  file.Write(kKeyFramesHeader);
  std::vector<std::pair<MapId, const KeyFrame*>> rows;
  std::size_t all = 0, without_pose = 0;
  for (const Map* map : maps) {
    all += map->keyframes.size();
    for (const KeyFrame& keyframe : map->keyframes) {
      if (keyframe.bad) continue;
      rows.emplace_back(map->id, &keyframe);
      without_pose += IsPose(keyframe.camera_from_world) ? 0 : 1;
    }
  }
  WriteRows(file, rows.size(), 256, options, [&rows](std::size_t begin, std::size_t end, std::string& out) {
    for (std::size_t row = begin; row < end; ++row) AppendKeyFrame(out, rows[row].first, *rows[row].second);
  });
  file.Commit();
  if (without_pose > 0)
    notices.Warn("in the table all the same, though their pose is none, or not finite: " +
                 Counted(without_pose, "keyframe"));
  notices.Tell(CountWritten(rows.size(), "keyframe", all - rows.size()), WrittenCounts{.keyframes = rows.size()});
}

// The cells of one side: row, place and octave of the keypoint, error.
void AppendSide(Line& line, const KeyFrame* keyframe, std::int32_t row, float error) {
  if (row < 0) return line.Skip(5);  // not seen on this side, or no entry for it
  line.Add(row);
  const Keypoint* keypoint = keyframe == nullptr ? nullptr : ObservedKeypoint(*keyframe, row);
  if (keypoint == nullptr) return line.Skip(4);
  line.Add(keypoint->x);
  line.Add(keypoint->y);
  line.Add(keypoint->octave);
  line.Add(error);
}

void AppendObservations(std::string& out, const PointRows& points, const PointRows::Row& row) {
  const Reprojection& reprojection = points.reprojection(row);
  for (const Observation& observation : row.point->observations) {
    const KeyFrame* keyframe = reprojection.Find(observation.keyframe);
    const Reprojection::Errors errors = reprojection.Of(*row.point, observation);
    Line line(out);
    line.Add(points.map_id(row));
    line.Add(row.point->id);
    line.Add(observation.keyframe);
    AppendSide(line, keyframe, observation.left, errors.left);
    AppendSide(line, keyframe, observation.right, errors.right);
    line.End();
  }
}

// Rows, and the keyframes and points that have any.
struct ObservationCounts {
  std::uint64_t rows = 0, keyframes = 0, points = 0;
};

ObservationCounts CountObservations(const PointRows& points) {
  ObservationCounts counts;
  for (std::size_t map = 0; map < points.maps().size(); ++map) {
    std::unordered_set<std::uint64_t> keyframes;
    for (std::size_t row = points.begins()[map]; row < points.begins()[map + 1]; ++row) {
      const auto& observations = points[row].point->observations;
      counts.rows += observations.size();
      counts.points += observations.empty() ? 0 : 1;
      for (const Observation& observation : observations) keyframes.insert(observation.keyframe.value());
    }
    counts.keyframes += keyframes.size();
  }
  return counts;
}

void WriteObservations(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  AtomicFile file(target, FileOptions(options));
  const PointRows points(atlas, target, options);
  file.Write(kObservationsHeader);
  WriteRows(file, points.size(), 1024, options, [&](std::size_t begin, std::size_t end, std::string& out) {
    for (std::size_t row = begin; row < end; ++row) AppendObservations(out, points, points[row]);
  });
  file.Commit();
  const ObservationCounts counts = CountObservations(points);
  notices.Tell(Concat(Counted(counts.rows, "observation"), " by ", Counted(counts.keyframes, "keyframe"), " of ",
                      CountWritten(counts.points, "point", points.bad())),
               WrittenCounts{.keyframes = counts.keyframes, .points = counts.points});
}

template <const std::string_view& kHeader>
bool Sniff(const Probe& probe) {
  return probe.head.starts_with(kHeader);
}

constexpr std::array<std::string_view, 1> kPointsSuffixes = {".csv"};
constexpr std::array<std::string_view, 1> kKeyFramesSuffixes = {".keyframes.csv"};
constexpr std::array<std::string_view, 1> kObservationsSuffixes = {".observations.csv"};

}  // namespace

const Format kCsvFormat = {.id = "csv",
                           .title = "CSV table of map points",
                           .suffixes = kPointsSuffixes,
                           .chooses_maps = true,
                           .is_export = true,
                           .writes = Content::kPoints | Content::kNormals | Content::kMaps,
                           .sniff = Sniff<kPointsHeader>,
                           .write = WritePoints};

const Format kCsvKeyFramesFormat = {.id = "csv-keyframes",
                                    .title = "CSV table of keyframes",
                                    .suffixes = kKeyFramesSuffixes,
                                    .chooses_maps = true,
                                    .is_export = true,
                                    .writes = Content::kPoses | Content::kMaps,
                                    .sniff = Sniff<kKeyFramesHeader>,
                                    .write = WriteKeyFrames};

const Format kCsvObservationsFormat = {.id = "csv-observations",
                                       .title = "CSV table of observations",
                                       .suffixes = kObservationsSuffixes,
                                       .chooses_maps = true,
                                       .is_export = true,
                                       .writes = Content::kObservations | Content::kMaps,
                                       .sniff = Sniff<kObservationsHeader>,
                                       .write = WriteObservations};

}  // namespace slamdb::detail
