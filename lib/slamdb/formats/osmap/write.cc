// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <bit>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <set>

#include "slamdb/base/atomic_folder.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/links.h"
#include "slamdb/formats/detail/dry_run.h"
#include "slamdb/formats/export/detail/maps.h"
#include "slamdb/formats/export/detail/protobuf.h"
#include "slamdb/formats/export/detail/rows.h"
#include "slamdb/formats/export/options.h"
#include "slamdb/formats/osmap/detail/header.h"
#include "slamdb/formats/osmap/detail/osmap.h"
#include "slamdb/model/detail/is_pose.h"
#include "slamdb/model/index.h"

namespace slamdb::osmap {
namespace {

namespace fs = std::filesystem;

using detail::Concat;
using detail::Counted;
using detail::ProtoAppender;

constexpr std::size_t kMostInMessage = 1'000'000;  // features; more are several messages, as readers bound them
constexpr std::size_t kPointGrain = 1024;          // points

// The map that is written: osmap has one world frame. Of several the one with the most points.
const Map& ChooseMap(const std::vector<const Map*>& maps, Notices& notices) {
  static const Map kEmpty;
  if (maps.empty()) return kEmpty;
  const Map& largest = **std::ranges::max_element(maps, {}, [](const Map* map) { return map->points.size(); });
  for (const Map* map : maps)
    if (map != &largest && !map->keyframes.empty())
      notices.Lose(Concat("osmap holds one map: left out is ", map->id, " with ",
                          Counted(map->keyframes.size(), "keyframe"), " and ",
                          Counted(map->points.size(), "map point")));
  return largest;
}

// Whether a file is a header, of whatever suffix, and one of these is what it would be read with.
bool NamesAnyOf(const std::string& header, const std::set<fs::path>& files) try {
  if (!IsHeader(Probe::Of(header))) return false;
  const WholeFile file{Source(header)};
  const Header names = ParseHeader(file.text(), header);
  return std::ranges::any_of(std::array{names.points, names.keyframes, names.features}, [&](const Side& side) {
    std::error_code failed;
    return !side.file.empty() && files.contains(fs::weakly_canonical(PathOf(header, side), failed));
  });
} catch (const Error&) {
  return false;  // nobody can read it
}

// Another header of the files that are written would be read with the new ones.
void RefuseOtherHeaders(const std::string& header, const Header& written) {
  std::error_code failed, missing;
  std::set<fs::path> files;
  for (const Side* side : {&written.points, &written.keyframes, &written.features})
    files.insert(fs::weakly_canonical(detail::FolderOf(header) / side->file, failed));
  for (fs::directory_iterator entry(detail::FolderOf(header), failed), end; !failed && entry != end;
       entry.increment(failed)) {
    const std::string other = entry->path().string();
    const bool is_it = entry->path().filename() == fs::path(header).filename() ||
                       (entry->is_symlink(missing) && fs::equivalent(other, header, missing));
    if (!is_it && entry->is_regular_file(missing) && NamesAnyOf(other, files))
      throw Error(ErrorKind::kAlreadyExists, other, "",
                  Concat("is a header of ", written.points.file,
                         " and what goes with it, and would be read with what is written; remove it, or name another "
                         "output"));
  }
}

bool IsHeld(const KeyFrame& keyframe) { return !keyframe.bad && detail::IsPose(keyframe.camera_from_world); }
bool IsHeld(const MapPoint& point) { return !point.bad && point.position.allFinite(); }

class MapWriter {
 public:
  MapWriter(const Map& map, const WriteOptions& options) : options_(options) {
    for (const KeyFrame& keyframe : map.keyframes)
      if (IsHeld(keyframe)) keyframes_.push_back(&keyframe);
    for (const MapPoint& point : map.points)
      if (IsHeld(point)) points_.push_back(&point);
    std::ranges::stable_sort(keyframes_, {}, [](const KeyFrame* keyframe) { return keyframe->id; });
    std::ranges::stable_sort(points_, {}, [](const MapPoint* point) { return point->id; });
    ListCameras();
    for (const KeyFrame* keyframe : keyframes_) features_ += RowsOf(*keyframe);
    if (features_ > kMostInMessage) header_.options |= kDelimited;
  }

  void Write(const Target& target) {
    AtomicFiles files(target, detail::FileOptions(options_));
    const fs::path base = fs::path(files.target()).stem();
    const auto write = [&](Side& side, std::size_t count, const char* suffix, auto&& append) {
      side = {.file = base.string() + suffix, .count = count};
      const std::unique_ptr<AtomicFile> file = files.Make(side.file);
      append(*file);
      file->Commit();
    };
    write(header_.points, points_.size(), ".mappoints", [this](AtomicFile& file) { WritePoints(file); });
    write(header_.keyframes, keyframes_.size(), ".keyframes", [this](AtomicFile& file) { WriteKeyFrames(file); });
    write(header_.features, features_, ".features", [this](AtomicFile& file) { WriteFeatures(file); });
    const std::unique_ptr<AtomicFile> header = files.MakeTarget();
    header->Write(HeaderText(header_));
    header->Commit();
    RefuseOtherHeaders(files.target(), header_);
    files.Commit();
  }

 private:
  static std::size_t RowsOf(const KeyFrame& keyframe) { return keyframe.features.undistorted.size(); }

  static std::uint32_t NarrowId(std::uint64_t id, const std::string& name) {
    if (id <= std::numeric_limits<std::uint32_t>::max()) return static_cast<std::uint32_t>(id);
    throw Error(ErrorKind::kNotPossible, Concat(name, ": ids of osmap have 32 bits; RenumberAtlas makes them small"));
  }

  using MatrixBits = std::array<std::uint32_t, 4>;
  static MatrixBits BitsOf(const KeyFrame& keyframe) {
    const Intrinsics& it = keyframe.intrinsics;
    return std::bit_cast<MatrixBits>(CameraMatrix{it.fx, it.fy, it.cx, it.cy});
  }
  void ListCameras() {
    for (const KeyFrame* keyframe : keyframes_) {
      const MatrixBits bits = BitsOf(*keyframe);
      if (camera_rows_.emplace(bits, header_.cameras.size()).second)
        header_.cameras.push_back(std::bit_cast<CameraMatrix>(bits));
    }
  }

  static void AppendDescriptor(ProtoAppender& message, int field, const Descriptor& descriptor) {
    message.Message(field, [&](ProtoAppender& words) {
      words.Head(1, descriptor.size());
      words.Raw(std::as_bytes(std::span(descriptor)));
    });
  }
  // Fields of their default are left out, as everybody's writer of proto3 does; -0 is none.
  static void AppendFloat(ProtoAppender& message, int field, float value) {
    if (std::bit_cast<std::uint32_t>(value) != 0) message.Float(field, value);
  }
  static void AppendNumber(ProtoAppender& message, int field, std::uint64_t value) {
    if (value != 0) message.Varint(field, value);
  }

  static void AppendPoint(ProtoAppender& message, const MapPoint& point) {
    AppendNumber(message, 1, NarrowId(point.id.value(), ToString(point.id)));
    message.Message(2, [&](ProtoAppender& position) {
      for (int axis = 0; axis < 3; ++axis) AppendFloat(position, axis + 1, point.position[axis]);
    });
    if (point.visible_count != MapPoint::kNoCount) AppendFloat(message, 3, static_cast<float>(point.visible_count));
    if (point.found_count != MapPoint::kNoCount) AppendFloat(message, 4, static_cast<float>(point.found_count));
    if (point.has_descriptor()) AppendDescriptor(message, 5, point.descriptor);
  }

  void AppendKeyFrame(ProtoAppender& message, const KeyFrame& keyframe) const {
    AppendNumber(message, 1, NarrowId(keyframe.id.value(), ToString(keyframe.id)));
    message.Message(2, [&](ProtoAppender& pose) {
      Eigen::Matrix<float, 3, 4, Eigen::RowMajor> matrix;
      const Eigen::Quaterniond rotation = Eigen::Quaternionf(keyframe.camera_from_world.rotation).cast<double>();
      matrix.leftCols<3>() = rotation.normalized().toRotationMatrix().cast<float>();
      matrix.col(3) = keyframe.camera_from_world.translation;
      pose.Head(1, sizeof(float) * 12);
      pose.Raw(std::as_bytes(std::span(matrix.data(), 12)));
    });
    AppendNumber(message, 4, camera_rows_.at(BitsOf(keyframe)));
    for (const KeyFrameId edge : keyframe.loop_edges)
      if (edge < keyframe.id) message.Varint(5, edge.value());
    if (std::bit_cast<std::uint64_t>(keyframe.timestamp) != 0) message.Double(6, keyframe.timestamp);
  }

  // 0 is no point.
  static std::uint64_t PointOf(const Features& features, std::size_t row) {
    if (row >= features.map_points.size() || !features.map_points[row]) return 0;
    return NarrowId(features.map_points[row].value(), ToString(features.map_points[row]));
  }

  static void AppendFeature(ProtoAppender& message, const Features& features, std::size_t row) {
    AppendNumber(message, 2, PointOf(features, row));
    message.Message(3, [&](ProtoAppender& point) {
      const Keypoint& keypoint = features.undistorted[row];
      AppendFloat(point, 1, keypoint.x);
      AppendFloat(point, 2, keypoint.y);
      AppendFloat(point, 3, keypoint.angle);
      AppendFloat(point, 4, static_cast<float>(keypoint.octave));
    });
    if (row < features.descriptors.size()) AppendDescriptor(message, 4, features.descriptors[row]);
  }

  static void AppendFeatures(std::string& out, const KeyFrame& keyframe) {
    ProtoAppender array(out);
    std::string inner;
    ProtoAppender message(inner);
    AppendNumber(message, 1, NarrowId(keyframe.id.value(), ToString(keyframe.id)));
    for (std::size_t row = 0; row < RowsOf(keyframe); ++row)
      message.Message(2, [&](ProtoAppender& feature) { AppendFeature(feature, keyframe.features, row); });
    array.Text(1, inner);
  }

  void WritePoints(AtomicFile& file) const {
    detail::WriteRows(file, points_.size(), kPointGrain, options_,
                      [this](std::size_t begin, std::size_t end, std::string& out) {
                        ProtoAppender array(out);
                        for (std::size_t row = begin; row < end; ++row)
                          array.Message(1, [&](ProtoAppender& message) { AppendPoint(message, *points_[row]); });
                      });
  }
  void WriteKeyFrames(AtomicFile& file) const {
    std::string out;
    ProtoAppender array(out);
    for (const KeyFrame* keyframe : keyframes_)
      array.Message(1, [&](ProtoAppender& message) { AppendKeyFrame(message, *keyframe); });
    file.Write(out);
  }
  void WriteFeatures(AtomicFile& file) const {
    const bool delimited = (header_.options & kDelimited) != 0;
    detail::WriteRows(file, keyframes_.size(), 1, options_, [&](std::size_t begin, std::size_t end, std::string& out) {
      for (std::size_t row = begin; row < end; ++row) {
        std::string message;
        AppendFeatures(message, *keyframes_[row]);
        if (delimited) ProtoAppender::AppendVarint(out, message.size());
        out += message;
      }
    });
  }
  const WriteOptions& options_;
  std::vector<const KeyFrame*> keyframes_;
  std::vector<const MapPoint*> points_;
  std::size_t features_ = 0;
  Header header_;
  std::map<MatrixBits, std::size_t> camera_rows_;  // of Header::cameras
};

bool Sees(const KeyFrame& keyframe, std::int32_t row, MapPointId point) {
  const Column<MapPointId>& points = keyframe.features.map_points;
  return row >= 0 && static_cast<std::size_t>(row) < points.size() && points[static_cast<std::size_t>(row)] == point;
}

// What osmap has no place for, beyond whole kinds of content.
void TellLosses(const Atlas& atlas, const Map& map, Notices& notices) {
  std::uint64_t bad = 0, without_pose = 0, without_position = 0, depth = 0, of_point_0 = 0, right = 0, graph = 0;
  for (const KeyFrame& keyframe : map.keyframes) {
    const Features& features = keyframe.features;
    bad += keyframe.bad ? 1 : 0;
    without_pose += keyframe.bad || IsHeld(keyframe) ? 0 : 1;
    graph += keyframe.merge_edges.size();
    depth += static_cast<std::uint64_t>(std::ranges::count_if(features.depth, [](float value) { return value > 0; }));
    right += features.right_keypoints.size();
    of_point_0 += static_cast<std::uint64_t>(std::ranges::count(features.map_points, MapPointId(0)));
  }
  std::uint64_t one_sided = 0;
  const IdTable rows = KeyFrameTable(map);
  for (const MapPoint& point : map.points) {
    bad += point.bad ? 1 : 0;
    without_position += point.bad || IsHeld(point) ? 0 : 1;
    for (const Observation& observation : point.observations) {
      const std::uint32_t row = rows.Find(observation.keyframe.value());
      one_sided += row == kNoRow || !Sees(map.keyframes[row], observation.left, point.id) ? 1 : 0;
    }
  }
  const bool fisheye =
      std::ranges::any_of(atlas.cameras, [](const Camera& camera) { return camera.model != CameraModel::kPinhole; });
  const auto lose = [&](std::uint64_t count, std::string_view what) {
    if (count > 0) notices.Lose(Concat("osmap cannot hold ", what, " (", detail::Thousands(count), ")"));
  };
  lose(bad, "keyframes and map points flagged bad");
  lose(without_pose, "keyframes whose pose is none, or not finite");
  lose(without_position, "map points whose position is not finite");
  lose(depth, "depths of keypoints: it is monocular");
  lose(right, "keypoints of right images");
  lose(graph, "merge edges");
  lose(one_sided, "observations that the keyframe does not record, too");
  lose(of_point_0, "observations of mp 0, whose id means none there");
  if (fisheye) notices.Lose("osmap cannot hold fisheye cameras: keypoints stand on a pinhole's image plane there");
  if (!map.keyframes.empty())
    notices.Lose(
        "osmap keeps of keypoints the undistorted position, angle and octave alone, and no spanning tree, flags, "
        "counters and name of the vocabulary");
}

}  // namespace

void Write(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  if (!detail::HasFile(target, options) || IsSpecialFile(target.path))
    throw Error(ErrorKind::kUsage, target.path, "", "an osmap map is four files: give the path of its .yaml file");
  const Map& map = ChooseMap(detail::ChooseMaps(atlas, options, target), notices);
  TellLosses(atlas, map, notices);
  MapWriter(map, options).Write(target);
}

}  // namespace slamdb::osmap
