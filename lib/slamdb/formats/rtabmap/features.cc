// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <unordered_map>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/rtabmap/detail/keyframes.h"
#include "slamdb/formats/sqlite/detail/foreign.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/detail/matrix_types.h"

namespace slamdb::rtabmap {
namespace {

using detail::Concat;
using sqlite::Database;
using sqlite::Statement;

constexpr std::int32_t kMostLevels = 16;
constexpr float kFarthest = 1 << 20;  // pixels
constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();

// OpenCV packs octave and layer of SIFT into one number, the octave in its lowest byte, -1 for the doubled picture.
std::int32_t OctaveOf(std::int64_t recorded) {
  if (recorded >= 0 && recorded < kMostLevels) return static_cast<std::int32_t>(recorded);
  const auto octave = static_cast<std::int8_t>(recorded & 0xff);
  return octave >= 0 && octave < kMostLevels ? octave : 0;
}

float Real(const Statement& statement, int column) { return static_cast<float>(statement.Real(column)); }

// Descriptors that are not ORB's.
struct Other {
  std::size_t bytes = 0;  // of each; 0: there are none
  bool has_floats = false;
  Column<std::byte> data;
};

class FeatureReader {
 public:
  FeatureReader(Database& database, Shots& shots) : database_(database), shots_(shots) {
    for (const Shot& shot : shots.list) from_base_.push_back(BaseOf(shot).inverse().cast<float>());
    lacking_.resize(shots.list.size());
    others_.resize(shots.list.size());
  }

  FeatureCounts Run(const ReadOptions& options) {
    // Map_Node_Word until 0.12.
    const char* table = sqlite::ColumnsOf(database_, "Feature").empty() ? "Map_Node_Word" : "Feature";
    const std::string place = Concat("table ", table);
    Statement statement(
        database_,
        sqlite::SelectColumns(database_, table,
                              {"node_id", "word_id", "pos_x", "pos_y", "size", "dir", "response", "octave", "depth_x",
                               "depth_y", "depth_z", "descriptor_size", "descriptor"}),
        place);
    constexpr std::uint64_t kStep = 100'000;
    const auto total = static_cast<double>(database_.Integer(Concat("SELECT count(*) FROM ", table)));
    for (std::uint64_t features = 0; statement.Step(); ++features) {
      Add(statement);
      if (options.progress && features % kStep == 0)
        options.progress("reading features", static_cast<double>(features) / total);
    }
    CarryOthers();
    FillByWords();
    return counts_;
  }

 private:
  static Pose BaseOf(const Shot& shot) {
    return shot.node->cameras.empty() ? Pose::Identity() : shot.node->cameras[shot.camera].base_from_camera;
  }

  void Add(const Statement& statement) {
    const std::int64_t node = statement.Integer(0);
    float x = Real(statement, 2);
    const std::uint32_t row = node > 0 ? shots_.Find(static_cast<std::uint64_t>(node), x) : kNoRow;
    if (row == kNoRow) {
      ++counts_.without_node;
      return;
    }
    Shot& shot = shots_.list[row];
    Features& features = shot.keyframe.features;
    const std::int64_t word = statement.Integer(1);
    shot.words.push_back(word > 0 && word <= std::numeric_limits<std::int32_t>::max() ? static_cast<std::int32_t>(word)
                                                                                      : 0);
    counts_.highest_word = std::max(counts_.highest_word, shot.words.back());
    features.keypoints.push_back({.angle = Real(statement, 5),
                                  .response = Real(statement, 6),
                                  .size = static_cast<float>(statement.Integer(4)),
                                  .x = x,
                                  .y = Real(statement, 3),
                                  .class_id = -1,
                                  .octave = OctaveOf(statement.Integer(7))});
    AddPlace(shot, from_base_[row], {Real(statement, 8), Real(statement, 9), Real(statement, 10)});
    AddDescriptor(row, statement.Integer(11), statement.Blob(12));
  }

  // In the frame of the robot's base.
  static void AddPlace(Shot& shot, const Eigen::Isometry3f& camera_from_base, const Eigen::Vector3f& in_base) {
    const Eigen::Vector3f place = camera_from_base * in_base;
    const bool is_seen = place.allFinite() && place.z() > 0;
    shot.places.push_back(is_seen ? place : Eigen::Vector3f::Constant(kMissing));
    const Intrinsics& intrinsics = shot.keyframe.intrinsics;
    Features& features = shot.keyframe.features;
    features.depth.push_back(is_seen ? place.z() : -1);
    features.right_x.push_back(is_seen ? features.keypoints.back().x - intrinsics.baseline_fx / place.z() : -1);
    if (features.right_x.back() < 0) features.depth.back() = features.right_x.back() = -1;
  }

  // `size`: of numbers, which are bytes or floats.
  void AddDescriptor(std::uint32_t row, std::int64_t size, Bytes blob) {
    Column<Descriptor>& descriptors = shots_.list[row].keyframe.features.descriptors;
    Descriptor descriptor{};
    const bool has_floats = size > 0 && blob.size() == static_cast<std::uint64_t>(size) * sizeof(float);
    if (blob.size() == descriptor.size() && !has_floats)
      std::memcpy(descriptor.data(), blob.data(), blob.size());
    else if (blob.empty())
      lacking_[row].push_back(static_cast<std::uint32_t>(descriptors.size()));
    else
      AddOther(others_[row], descriptors.size(), has_floats, blob);
    descriptors.push_back(descriptor);
  }

  // All of a picture are of one kind.
  void AddOther(Other& other, std::size_t keypoint, bool has_floats, Bytes blob) {
    if (other.bytes == 0) other = {.bytes = blob.size(), .has_floats = has_floats, .data = {}};
    if (other.bytes != blob.size() || other.has_floats != has_floats) {
      ++counts_.other_descriptors;
      return;
    }
    other.data.resize(keypoint * other.bytes, std::byte{0});
    other.data.insert(other.data.end(), blob.begin(), blob.end());
  }

  void CarryOthers() {
    for (std::size_t row = 0; row < shots_.list.size(); ++row) {
      Other& other = others_[row];
      if (other.bytes == 0) continue;
      KeyFrame& keyframe = shots_.list[row].keyframe;
      const std::size_t rows = keyframe.features.keypoints.size();
      other.data.resize(rows * other.bytes, std::byte{0});
      Matrix& matrix = keyframe.carried.Make().descriptors;
      matrix.rows = static_cast<std::int32_t>(rows);
      matrix.columns = static_cast<std::int32_t>(other.has_floats ? other.bytes / sizeof(float) : other.bytes);
      matrix.type = other.has_floats ? detail::kCv32F : detail::kCv8U;
      matrix.continuous = true;
      matrix.data = std::move(other.data);
      keyframe.features.descriptors.clear();
      lacking_[row].clear();
    }
  }

  // Where a file keeps no descriptors of features, those of their words stand for them.
  void FillByWords() {
    if (std::ranges::all_of(lacking_, [](const auto& rows) { return rows.empty(); })) return;
    std::unordered_map<std::int32_t, Descriptor> words;
    Statement statement(database_, sqlite::SelectColumns(database_, "Word", {"id", "descriptor"}), "table Word");
    while (statement.Step()) {
      const Bytes blob = statement.Blob(1);
      if (blob.size() != sizeof(Descriptor)) continue;
      std::memcpy(words[static_cast<std::int32_t>(statement.Integer(0))].data(), blob.data(), blob.size());
    }
    for (std::size_t row = 0; row < shots_.list.size(); ++row)
      for (const std::uint32_t keypoint : lacking_[row]) {
        const auto word = words.find(shots_.list[row].words[keypoint]);
        if (word == words.end()) continue;
        shots_.list[row].keyframe.features.descriptors[keypoint] = word->second;
        ++counts_.by_word;
      }
  }

  Database& database_;
  Shots& shots_;
  std::vector<Other> others_;  // of each shot
  std::vector<Eigen::Isometry3f> from_base_;
  std::vector<std::vector<std::uint32_t>> lacking_;  // keypoints without descriptor, of each shot
  FeatureCounts counts_;
};

void SetPyramid(KeyFrame& keyframe, double scale_factor) {
  std::int32_t levels = 8;
  for (const Keypoint& keypoint : keyframe.features.keypoints) levels = std::max(levels, keypoint.octave + 1);
  keyframe.pyramid = DerivePyramid(levels, static_cast<float>(scale_factor));
}

}  // namespace

std::uint32_t Shots::Find(std::uint64_t node, float& x) const {
  const std::uint32_t first = first_of_node.Find(node);
  if (first == kNoRow || !(std::abs(x) < kFarthest)) return kNoRow;
  const auto count = static_cast<std::int32_t>(list[first].node->cameras.size());
  const std::int32_t width = list[first].node->cameras[0].width;
  if (count == 1 || width <= 0) return first;
  const std::int32_t camera = std::clamp(static_cast<std::int32_t>(x) / width, 0, count - 1);
  x -= static_cast<float>(camera * width);
  return first + static_cast<std::uint32_t>(camera);
}

FeatureCounts ReadFeatures(Database& database, Shots& shots, double scale_factor, const ReadOptions& options) {
  const FeatureCounts counts = FeatureReader(database, shots).Run(options);
  for (Shot& shot : shots.list) {
    Features& features = shot.keyframe.features;
    features.undistorted = features.keypoints;
    features.map_points.assign(features.keypoints.size(), MapPointId());
    SetPyramid(shot.keyframe, scale_factor);
    const bool has_depth = std::ranges::any_of(features.depth, [](float depth) { return depth > 0; });
    if (!has_depth && !shot.node->cameras.empty() && shot.node->cameras[shot.camera].baseline == 0)
      SetBaseline(shot.keyframe, 0);
  }
  return counts;
}

}  // namespace slamdb::rtabmap
