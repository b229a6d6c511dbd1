// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/mcap/detail/mcap.h"

#include <algorithm>
#include <array>
#include <set>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/export/detail/maps.h"
#include "slamdb/formats/export/detail/point_colors.h"
#include "slamdb/formats/export/detail/points.h"
#include "slamdb/formats/export/detail/raw.h"
#include "slamdb/formats/export/detail/rows.h"
#include "slamdb/formats/mcap/detail/graph.h"
#include "slamdb/formats/mcap/detail/messages.h"
#include "slamdb/formats/mcap/detail/timeline.h"
#include "slamdb/formats/mcap/detail/writer.h"
#include "slamdb/formats/trajectory/detail/poses.h"
#include "slamdb/model/up.h"

namespace slamdb::detail {
namespace {

constexpr std::size_t kRowsPerBlock = 8192;

// The maps with unique names: `map_0`; a second one of the same id is `map_0_1`, by its row.
std::vector<McapMap> MapsOf(const PointRows& points, const Trajectories& trajectories) {
  std::vector<McapMap> maps;
  std::set<std::string> names;
  std::size_t ignored = 0;
  const std::vector<Up> ups = UpsOf(points.maps());
  for (std::size_t row = 0; row < points.maps().size(); ++row) {
    const Map* map = points.maps()[row];
    std::string name = map->id ? Concat("map_", map->id.value()) : "map_none";
    if (!names.insert(name).second) name = Concat(name, '_', row);
    McapMap& added =
        maps.emplace_back(McapMap{.row = row, .frame = std::move(name), .map = map, .up = ups[row].direction});
    added.has_points = points.begins()[row] < points.begins()[row + 1];
    added.trajectory = trajectories.Find(*map);
    if (added.trajectory != nullptr) added.begin = LogTime(added.trajectory->poses.front().timestamp, ignored);
  }
  return maps;
}

// The points of one map, as one message.
class Cloud {
 public:
  Cloud(const McapMap& map, const PointRows& points, const PointColors& colors)
      : points_(points),
        colors_(colors),
        begin_(points.begins()[map.row]),
        count_(points.begins()[map.row + 1] - begin_),
        ids_(ColumnForPointIds(points)),
        head_(CloudHead(map.begin, map.frame, count_, ids_)) {}

  std::uint64_t size() const { return head_.size() + count_ * PointStride(ids_); }

  void Write(AtomicFile& file, const WriteOptions& options) const {
    file.Write(head_);
    WriteRows(file, count_, kRowsPerBlock, options, [this](std::size_t begin, std::size_t end, std::string& out) {
      for (std::size_t row = begin; row < end; ++row) AppendRow(out, begin_ + row);
    });
  }

 private:
  void AppendRow(std::string& out, std::size_t row) const {
    const MapPoint& point = *points_[row].point;
    for (const float value : point.position) AppendRaw(out, value);
    for (const float value : point.normal) AppendRaw(out, value);
    for (const std::uint8_t value : colors_[row]) AppendRaw(out, value);
    AppendRaw(out, std::uint8_t{255});
    AppendRaw(out, static_cast<std::uint32_t>(point.observations.size()));
    AppendRaw(out, points_.mean_error(points_[row]));
    AppendRawId(out, point.id.value(), ids_);
  }

  const PointRows& points_;
  const PointColors& colors_;
  std::size_t begin_, count_;
  IdColumn ids_;
  std::string head_;
};

void WriteCloud(McapWriter& writer, const TimedMessage& message, const Cloud& cloud, const Target& target,
                const WriteOptions& options) {
  constexpr std::uint64_t kMost = (std::uint64_t{2} << 30) - 1;  // of protobuf
  if (cloud.size() > kMost)
    throw Error(ErrorKind::kNotPossible, target.path, "",
                "a message of protobuf has at most 2 GiB, and the points of a map take more; write fewer points");
  WriteOptions silent = options;
  silent.progress = {};
  bool counted = false;
  writer.WriteLong(message.channel, message.time, cloud.size(), [&](AtomicFile& to) {
    cloud.Write(to, counted ? options : silent);
    counted = true;
  });
}

void WarnOfTimes(const Trajectories& trajectories, Notices& notices) {
  std::size_t outside = 0;
  for (const KeyFrameTrajectory& trajectory : trajectories.maps)
    for (const TimedPose& pose : trajectory.poses) LogTime(pose.timestamp, outside);
  if (outside > 0)
    notices.Warn(
        "times before 1970 or beyond 2262 are written as the nearest that there is (were they recorded in seconds?): " +
        Counted(outside, "keyframe"));
}

void WarnOfEdges(const Trajectories& trajectories, Notices& notices) {
  std::size_t outside = 0;
  for (const KeyFrameTrajectory& trajectory : trajectories.maps) outside += CountEdgesOutside(trajectory);
  WarnOfEdgesOutside(outside, notices);
}

void WriteMcap(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  AtomicFile file(target, FileOptions(options));
  const PointRows points(atlas, target, options, Positions::kFinite);
  const PointColors colors(points, options);
  const Trajectories trajectories = CollectTrajectories(atlas, target, options, notices, Rounded::kIsTaken);
  WarnOfSeveralFrames(points.maps(), "frames and topics tell them apart", notices);
  WarnOfTimes(trajectories, notices);
  WarnOfEdges(trajectories, notices);
  points.WarnOfNotFinite(notices);
  const AtlasIndex index(atlas);
  McapWriter writer(file);
  const McapChannels channels(writer);
  const std::vector<McapMap> maps = MapsOf(points, trajectories);
  std::vector<TimedMessage> messages;
  for (const McapMap& map : maps) AddMessages(map, index, channels, writer, messages);
  std::ranges::stable_sort(messages, {}, &TimedMessage::time);
  for (const TimedMessage& message : messages) {
    if (message.cloud == TimedMessage::kNoCloud)
      writer.Write(message.channel, message.time, message.message);
    else
      WriteCloud(writer, message, Cloud(maps[message.cloud], points, colors), target, options);
  }
  writer.Finish();
  file.Commit();
  colors.Tell(notices);
  notices.Tell(points.Summary() + "; " + trajectories.Summary(),
               WrittenCounts{.keyframes = trajectories.Count().poses, .points = points.size()});
}

// Others are recordings. Behind the magic stands the header, with its length, an empty profile, and our name.
bool SniffMcap(const Probe& probe) {
  constexpr std::string_view kHeader("\0\0\0\0\6\0\0\0slamdb", 14);
  return probe.head.starts_with("\x89MCAP0\r\n") && std::string_view(probe.head).find(kHeader) == 17;
}

constexpr std::array<std::string_view, 1> kSuffixes = {".mcap"};

}  // namespace

const Format kMcapFormat = {.id = "mcap",
                            .title = "Foxglove recording (MCAP)",
                            .suffixes = kSuffixes,
                            .kind = FileKind::kBinary,
                            .chooses_maps = true,
                            .has_colors = true,
                            .is_export = true,
                            .writes = Content::kPoints | Content::kNormals | Content::kPoses | Content::kGraph |
                                      Content::kCameras | Content::kMaps,
                            .sniff = SniffMcap,
                            .write = WriteMcap};

}  // namespace slamdb::detail
