// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <limits>
#include <unordered_set>

#include "slamdb/base/atomic_file.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/formats/export/detail/maps.h"
#include "slamdb/formats/export/detail/rows.h"
#include "slamdb/formats/g2o/detail/edges.h"
#include "slamdb/formats/g2o/detail/g2o.h"
#include "slamdb/formats/g2o/detail/similarity_log.h"
#include "slamdb/formats/g2o/options.h"

namespace slamdb {
namespace {

using detail::Concat;
using detail::Counted;

constexpr std::size_t kGrain = 32;  // edges
constexpr std::array<std::string_view, 1> kSuffixes{".g2o"};

void AppendNumbers(std::string& out, const auto& numbers) {
  for (const double number : numbers) {
    out += ' ';
    detail::AppendNumber(out, number + 0.0);  // no -0
  }
}

template <int size>
void AppendUpper(std::string& out, const Eigen::Matrix<double, size, size>& matrix) {
  for (int row = 0; row < size; ++row) AppendNumbers(out, matrix.row(row).tail(size - row));
}

// The shortest decimals of floats are those of what was recorded; an inverse is rounded to floats for that.
Similarity3d WorldFromCamera(const KeyFrame& keyframe) {
  const Rigid3f& pose = keyframe.camera_from_world;
  const Eigen::Quaterniond rotation = Eigen::Quaternionf(pose.rotation).cast<double>().normalized().conjugate();
  return {1, rotation, -(rotation * pose.translation.cast<double>())};
}

class MapText {
 public:
  MapText(const Atlas& atlas, const Map& map, const WriteOptions& options)
      : map_(map), similarities_(options.of<G2oWriteOptions>().similarities), graph_(g2o::EssentialGraphOf(map)) {
    for (std::uint32_t row = 0; row < map.keyframes.size(); ++row) {
      const KeyFrame& keyframe = map.keyframes[row];
      if (g2o::IsVertex(keyframe)) rows_.push_back(row);
      poses_.push_back(WorldFromCamera(keyframe));
    }
    const auto id = [&](std::uint32_t row) { return map.keyframes[row].id; };
    std::ranges::stable_sort(rows_, {}, id);
    const auto same = [&](std::uint32_t a, std::uint32_t b) { return id(a) == id(b); };
    rows_.erase(std::unique(rows_.begin(), rows_.end(), same), rows_.end());
    views_.emplace(atlas, map);
  }

  const std::vector<std::uint32_t>& rows() const { return rows_; }
  std::size_t edges() const { return graph_.edges.size(); }
  std::size_t outside() const { return graph_.outside; }
  std::size_t guessed() const { return guessed_; }

  void Write(AtomicFile& file, const WriteOptions& options, std::uint64_t id_shift) {
    shift_ = id_shift;
    std::string text;
    for (const std::uint32_t row : rows_) AppendVertex(text, row);
    for (const std::uint32_t row : rows_) {
      text += Concat("# TIME ", Id(row), " ");
      detail::AppendSeconds(text, map_.keyframes[row].timestamp);
      text += '\n';
    }
    if (!rows_.empty()) text += Concat("FIX ", Id(Root()), "\n");
    file.Write(text);
    std::vector<std::uint8_t> guessed(edges(), 0);
    detail::WriteRows(file, edges(), kGrain, options, [&](std::size_t begin, std::size_t end, std::string& out) {
      for (std::size_t i = begin; i < end; ++i) AppendEdge(out, graph_.edges[i], guessed[i]);
    });
    guessed_ = static_cast<std::size_t>(std::ranges::count(guessed, 1));
  }

 private:
  std::uint64_t Id(std::uint32_t row) const { return map_.keyframes[row].id.value() + shift_; }

  // The keyframe that holds the world still.
  std::uint32_t Root() const {
    for (const KeyFrameId id : {map_.initial_keyframe, map_.first_keyframe})
      for (const std::uint32_t row : rows_)
        if (map_.keyframes[row].id == id) return row;
    return rows_.front();
  }

  void AppendVertex(std::string& out, std::uint32_t row) const {
    const Similarity3d& pose = poses_[row];
    out += Concat(similarities_ ? "VERTEX_SIM3:EXPMAP " : "VERTEX_SE3:QUAT ", Id(row));
    if (!similarities_) {
      AppendNumbers(out, pose.translation);
      AppendNumbers(out, pose.rotation.coeffs());
    } else {
      const Intrinsics& it = map_.keyframes[row].intrinsics;
      AppendNumbers(out, g2o::LogOf(pose));
      AppendNumbers(out, std::array<double, 4>{it.fx, it.fy, it.cx, it.cy});
    }
    out += '\n';
  }

  void AppendEdge(std::string& out, const g2o::Edge& edge, std::uint8_t& guessed) const {
    const Similarity3d first_from_second = poses_[edge.first].Inverse() * poses_[edge.second];
    const double weight = std::max(edge.weight, 1);
    const auto known = views_->InformationOf(edge.first, edge.second);
    guessed = known ? 0 : 1;
    const g2o::Matrix6d information = known.value_or(weight * g2o::Matrix6d::Identity());
    out += Concat(similarities_ ? "EDGE_SIM3:EXPMAP " : "EDGE_SE3:QUAT ", Id(edge.first), " ", Id(edge.second));
    if (!similarities_) {
      AppendNumbers(out, first_from_second.translation);
      AppendNumbers(out, first_from_second.rotation.coeffs());
      // g2o measures a turn by the vector part of its quaternion, which is half its angle.
      Eigen::Matrix<double, 6, 1> halves;
      halves << 1, 1, 1, 2, 2, 2;
      AppendUpper<6>(out, known ? g2o::Matrix6d(halves.asDiagonal() * information * halves.asDiagonal()) : information);
    } else {
      AppendNumbers(out, g2o::LogOf(first_from_second));
      Eigen::Matrix<double, 7, 7> similar = Eigen::Matrix<double, 7, 7>::Zero();
      similar.topLeftCorner<3, 3>() = information.bottomRightCorner<3, 3>();
      similar.block<3, 3>(3, 3) = information.topLeftCorner<3, 3>();
      similar.block<3, 3>(0, 3) = information.bottomLeftCorner<3, 3>();
      similar.block<3, 3>(3, 0) = information.topRightCorner<3, 3>();
      similar(6, 6) = weight;  // pixels do not tell the scale of a step
      AppendUpper<7>(out, similar);
    }
    out += '\n';
  }

  const Map& map_;
  const bool similarities_;
  g2o::EssentialGraph graph_;
  std::vector<std::uint32_t> rows_;  // of vertices, by id
  std::vector<Similarity3d> poses_;  // world from camera, by row
  std::optional<g2o::SharedViews> views_;
  std::uint64_t shift_ = 0;
  std::size_t guessed_ = 0;
};

// Keyframes that are no vertices, and edges to such.
struct LeftOut {
  std::size_t bad = 0, without_pose = 0, without_id = 0, repeated = 0, edges = 0;

  void Add(const Map& map, std::size_t vertices, std::size_t edges_outside) {
    edges += edges_outside;
    std::size_t kept = 0;
    for (const KeyFrame& keyframe : map.keyframes) {
      if (keyframe.bad)
        ++bad;
      else if (!keyframe.id)
        ++without_id;
      else if (!g2o::IsVertex(keyframe))
        ++without_pose;
      else
        ++kept;
    }
    repeated += kept - vertices;
  }
  void Tell(Notices& notices) const {
    const auto warn = [&](std::size_t count, std::string_view why) {
      if (count > 0) notices.Warn(Concat("left out because ", why, ": ", Counted(count, "keyframe")));
    };
    warn(without_pose, "the pose is none, or not finite");
    warn(without_id, "they have no id");
    warn(repeated, "another keyframe has their id");
    detail::WarnOfEdgesOutside(edges, notices);
  }
};

// Gives each map ids that no map before it has.
class Ids {
 public:
  // What to add to the ids of this map.
  std::uint64_t Take(const Map& map, const std::vector<std::uint32_t>& rows) {
    constexpr std::uint64_t kMost = std::numeric_limits<std::int32_t>::max();
    bool clash = false;
    std::uint64_t largest = 0;
    for (const std::uint32_t row : rows) {
      const std::uint64_t id = map.keyframes[row].id.value();
      clash |= !taken_.insert(id).second;
      largest = std::max(largest, id);
    }
    const std::uint64_t shift = clash ? next_ : 0;
    if (largest > kMost || shift > kMost - largest)
      throw Error(ErrorKind::kNotPossible,
                  Concat("kf ", largest, ": ids of g2o have 31 bits; RenumberAtlas makes them small"));
    if (clash)
      for (const std::uint32_t row : rows) taken_.insert(map.keyframes[row].id.value() + shift);
    next_ = std::max(next_, largest + shift + 1);
    return shift;
  }

 private:
  std::unordered_set<std::uint64_t> taken_;
  std::uint64_t next_ = 0;
};

void Write(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  const std::vector<const Map*> maps = detail::ChooseMaps(atlas, options, target);
  AtomicFile file(target, detail::FileOptions(options));
  Ids ids;
  LeftOut left_out;
  std::size_t vertices = 0, edges = 0, guessed = 0;
  for (const Map* map : maps) {
    MapText text(atlas, *map, options);
    const std::uint64_t shift = ids.Take(*map, text.rows());
    if (shift > 0)
      notices.Warn(
          Concat("ids of keyframes of ", map->id, " are those of another map: written with ", shift, " added to them"));
    text.Write(file, options, shift);
    left_out.Add(*map, text.rows().size(), text.outside());
    vertices += text.rows().size();
    edges += text.edges();
    guessed += text.guessed();
  }
  file.Commit();
  detail::WarnOfSeveralFrames(maps, "each has a FIX line of its own, and no edge leads to another", notices);
  if (guessed > 0)
    notices.Note(Concat("the points of ", guessed, " of ", Counted(edges, "edge"),
                        " do not tell how sure they are: their information is the number of shared points"));
  left_out.Tell(notices);
  notices.Tell(Concat(detail::CountWritten(vertices, "keyframe", left_out.bad), ", ", Counted(edges, "edge")),
               WrittenCounts{.keyframes = vertices});
}

}  // namespace

const Format detail::kG2oFormat{.id = "g2o",
                                .title = "g2o pose graph",
                                .suffixes = kSuffixes,
                                .chooses_maps = true,
                                .is_export = true,
                                .reads = Content::kPoses | Content::kGraph,
                                .writes = Content::kPoses | Content::kGraph,
                                .sniff = detail::SniffG2o,
                                .read = detail::ReadG2o,
                                .write = Write};

}  // namespace slamdb
