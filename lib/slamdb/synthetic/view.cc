// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/synthetic/detail/view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "slamdb/model/derive.h"
#include "slamdb/synthetic/detail/random.h"
#include "slamdb/synthetic/detail/words.h"

namespace slamdb::synthetic {
namespace {

constexpr std::size_t kClutter = std::numeric_limits<std::size_t>::max();
constexpr int kLevels = 8;
constexpr double kFactor = 1.2;
constexpr int kNearer = 2;     // octaves that a point may grow from RoomPlan::safe_distance to the nearest camera
constexpr double kPatch = 31;  // pixels: what ORB describes at octave 0
constexpr double kRightOnly = 0.25, kLeftOnly = 0.45;  // of the points that a fisheye pair could see with both
constexpr double kWithDepth = 0.85;

// What all keyframes agree on about a point; clutter has a look of its own.
struct Look {
  Descriptor descriptor;
  std::uint32_t word;
  int octave;  // seen from RoomPlan::safe_distance
  double angle;
};

struct Slot {
  std::size_t point;  // row of Room::points, or kClutter
  Keypoint keypoint;
  float right_x = -1, depth = -1;
  Descriptor descriptor;
  std::uint32_t word;
};

// The extractor spreads features over levels in proportion to factor^-level.
int DrawOctave(Random& random, int levels) {
  double whole = 0, share = 1;
  for (int level = 0; level < levels; ++level, share /= kFactor) whole += share;
  double rest = random.Uniform() * whole;
  share = 1;
  for (int level = 0; level + 1 < levels; ++level, share /= kFactor) {
    if (rest < share) return level;
    rest -= share;
  }
  return levels - 1;
}

Look DrawLook(Random& random, int levels) {
  Look look;
  for (std::size_t i = 0; i < look.descriptor.size(); i += 8) {
    const std::uint64_t bits = random.Bits();
    for (std::size_t byte = 0; byte < 8; ++byte)
      look.descriptor[i + byte] = static_cast<std::uint8_t>(bits >> 8 * byte);
  }
  look.word = static_cast<std::uint32_t>(random.Below(kSyntheticWords));
  look.octave = DrawOctave(random, levels);
  look.angle = random.Uniform(0, 360);
  return look;
}

// The nearer a point, the larger it looks: one octave for each factor in distance. Beyond the levels it is not
// found: negative too small, kLevels and up too large.
int OctaveFrom(double nearness, int octave) {
  const double half_step = std::sqrt(kFactor);
  for (; nearness > half_step; nearness /= kFactor) ++octave;
  for (; nearness < 1 / half_step; nearness *= kFactor) --octave;
  return octave;
}

void FlipBits(Descriptor& descriptor, int most, Random& random) {
  for (std::uint64_t flips = random.Below(static_cast<std::uint64_t>(most) + 1); flips > 0; --flips) {
    const std::uint64_t bit = random.Below(256);
    descriptor[bit / 8] = static_cast<std::uint8_t>(descriptor[bit / 8] ^ 1U << bit % 8);
  }
}

// One keyframe in the making.
class Looking {
 public:
  Looking(const View& view, std::size_t index)
      : view_(view),
        random_({view.options.seed, view.map, kView, index}),
        turn_(view.room.plan.step * static_cast<double>(index)),
        camera_from_room_(view.room.RoomFromCamera(kKeyframeInterval * static_cast<double>(index)).Inverse()) {}

  Features Run() {
    LookAtPoints();
    AddClutter();
    for (std::vector<Slot>& slots : images_) {
      std::stable_sort(slots.begin(), slots.end(),
                       [](const Slot& a, const Slot& b) { return a.keypoint.octave < b.keypoint.octave; });
    }
    return Columns();
  }

 private:
  // Points are sorted by angle, so the ones that may be seen are one or two ranges of rows.
  void LookAtPoints() {
    const RoomPlan& plan = view_.room.plan;
    for (double lap = std::floor(turn_ / (2 * kPi)) - 1; lap <= std::floor(turn_ / (2 * kPi)) + 1; ++lap) {
      const double middle = turn_ - lap * 2 * kPi;
      const auto begin =
          std::lower_bound(view_.room.angles.begin(), view_.room.angles.end(), middle - plan.visible_arc);
      const auto end = std::upper_bound(begin, view_.room.angles.end(), middle + plan.visible_arc);
      for (auto angle = begin; angle < end; ++angle)
        LookAt(static_cast<std::size_t>(angle - view_.room.angles.begin()));
    }
  }

  void LookAt(std::size_t point) {
    const Eigen::Vector3d x_left = camera_from_room_ * view_.room.points[point];
    auto left = view_.rig.Project(0, x_left);
    std::optional<Eigen::Vector2d> right;
    if (view_.rig.is_fisheye()) {
      right = view_.rig.Project(1, view_.rig.left_from_right.Inverse() * x_left);
      if (left && right) {
        const double draw = random_.Uniform();
        if (draw < kRightOnly) left.reset();
        if (draw >= 1 - kLeftOnly) right.reset();
      }
    }
    if (!left && !right) return;
    Random look_random = view_.room.origins[point].Draw(view_.options.seed, kLook);
    Look look = DrawLook(look_random, kLevels - kNearer);
    look.octave = OctaveFrom(view_.room.plan.safe_distance / Norm(x_left), look.octave);
    if (look.octave < 0 || look.octave >= kLevels) return;
    if (left) images_[0].push_back(SeePoint(point, look, *left, x_left.z()));
    if (right) images_[1].push_back(SeePoint(point, look, *right, x_left.z()));
  }

  // A point, or something else that was taken for it.
  Slot SeePoint(std::size_t point, const Look& look, const Eigen::Vector2d& pixel, double depth) {
    if (view_.options.outliers == 0 || !random_.Chance(view_.options.outliers))
      return MakeSlot(point, look, pixel, depth);
    Look other = DrawLook(random_, kLevels);
    other.octave = look.octave;
    const Eigen::Vector2d elsewhere = AnyPixel();
    return MakeSlot(point, other, elsewhere, random_.Uniform(2, 8));
  }

  Eigen::Vector2d AnyPixel() {
    const ImageBounds& bounds = view_.rig.bounds;
    const double x = random_.Uniform(bounds.min_x + kImageMargin, bounds.max_x - kImageMargin);
    const double y = random_.Uniform(bounds.min_y + kImageMargin, bounds.max_y - kImageMargin);
    return {x, y};
  }

  void AddClutter() {
    const std::size_t most = view_.options.features;
    const std::size_t seen = images_[0].size() + images_[1].size();
    const std::size_t wanted = most - random_.Below(most / 20 + 1);
    const std::size_t images = view_.rig.is_fisheye() ? 2 : 1;
    for (std::size_t i = seen; i < wanted; ++i) {
      const Look look = DrawLook(random_, kLevels);
      const Eigen::Vector2d pixel = AnyPixel();
      images_[i % images].push_back(MakeSlot(kClutter, look, pixel, random_.Uniform(2, 8)));
    }
  }

  Slot MakeSlot(std::size_t point, const Look& look, const Eigen::Vector2d& pixel, double depth) {
    const ScalePyramid& pyramid = view_.rig.pyramid;
    const double scale = pyramid.factors[static_cast<std::size_t>(look.octave)];
    const double noise = point == kClutter ? 0 : view_.options.pixel_noise * scale;
    Slot slot;
    slot.point = point;
    const double angle = look.angle + 2 * random_.Normal();
    slot.keypoint.angle = static_cast<float>(angle < 0 ? angle + 360 : angle);
    if (slot.keypoint.angle >= 360) slot.keypoint.angle -= 360;
    slot.keypoint.response = static_cast<float>(random_.Uniform(20, 120));
    slot.keypoint.size = static_cast<float>(kPatch * scale);
    const ImageBounds& bounds = view_.rig.bounds;
    slot.keypoint.x = static_cast<float>(std::clamp(pixel.x() + noise * random_.Normal(), 0.0, bounds.max_x - 1.0));
    slot.keypoint.y = static_cast<float>(std::clamp(pixel.y() + noise * random_.Normal(), 0.0, bounds.max_y - 1.0));
    slot.keypoint.class_id = -1;
    slot.keypoint.octave = look.octave;
    slot.descriptor = look.descriptor;
    FlipBits(slot.descriptor, view_.options.flipped_bits, random_);
    const bool mistaken = random_.Chance(0.1);
    slot.word = WordOf(mistaken ? static_cast<std::uint32_t>(random_.Below(kSyntheticWords)) : look.word);
    if (view_.rig.has_depth() && random_.Chance(kWithDepth)) Measure(slot, depth);
    return slot;
  }

  // What the vocabulary at hand calls a word of the first one.
  std::uint32_t WordOf(std::uint32_t word) const {
    const std::uint64_t vocabulary = view_.options.vocabulary;
    if (vocabulary == 0) return word;
    return static_cast<std::uint32_t>(Random({vocabulary, kWord, word}).Below(kSyntheticWords));
  }

  // A stereo pair measures the column in the right image, a depth camera the depth; the other follows.
  void Measure(Slot& slot, double depth) {
    const double baseline_fx = view_.rig.intrinsics.baseline_fx;
    const double noise = view_.options.pixel_noise * random_.Normal();
    const double disparity = std::max(baseline_fx / depth + noise / 2, 0.01);
    const double right_x = slot.keypoint.x - disparity;
    if (right_x < 0) return;
    slot.right_x = static_cast<float>(right_x);
    slot.depth = static_cast<float>(baseline_fx / disparity);
  }

  Features Columns() const {
    Features features;
    const std::vector<Slot>&left = images_[0], &right = images_[1];
    features.count = static_cast<std::int32_t>(left.size() + right.size());
    std::vector<std::uint32_t> words;
    words.reserve(left.size() + right.size());
    features.descriptors.reserve(left.size() + right.size());
    features.map_points.reserve(left.size() + right.size());
    for (const std::vector<Slot>& slots : images_) {
      for (const Slot& slot : slots) {
        const bool is_mapped = view_.room.IsMapped(slot.point);
        features.map_points.push_back(is_mapped ? MapPointId(view_.first_point_id + slot.point - view_.room.before)
                                                : MapPointId());
        features.descriptors.push_back(slot.descriptor);
        words.push_back(slot.word);
      }
    }
    features.keypoints = Keypoints(left);
    features.undistorted = features.keypoints;
    features.right_x.reserve(left.size());
    features.depth.reserve(left.size());
    for (const Slot& slot : left) {
      features.right_x.push_back(slot.right_x);
      features.depth.push_back(slot.depth);
    }
    features.grid = DeriveGrid(features.undistorted, view_.rig.bounds);
    if (view_.rig.is_fisheye()) AddRightImage(features);
    if (view_.rig.sensor == Sensor::kStereo) features.right_keypoints = RectifiedRight(left);
    features.bag_of_words = CountWords(words);
    features.feature_vector = GroupByNode(words);
    return features;
  }

  static Column<Keypoint> Keypoints(const std::vector<Slot>& slots) {
    Column<Keypoint> keypoints;
    keypoints.reserve(slots.size());
    for (const Slot& slot : slots) keypoints.push_back(slot.keypoint);
    return keypoints;
  }

  // ORB-SLAM3 stores the keypoints of a rectified right image too, though it reads them no more.
  static Column<Keypoint> RectifiedRight(const std::vector<Slot>& slots) {
    Column<Keypoint> keypoints;
    for (const Slot& slot : slots) {
      if (slot.right_x < 0) continue;
      keypoints.push_back(slot.keypoint);
      keypoints.back().x = slot.right_x;
    }
    return keypoints;
  }

  void AddRightImage(Features& features) const {
    const std::vector<Slot>&left = images_[0], &right = images_[1];
    features.left_count = static_cast<std::int32_t>(left.size());
    features.right_count = static_cast<std::int32_t>(right.size());
    features.right_keypoints = Keypoints(right);
    features.right_grid = DeriveGrid(features.right_keypoints, view_.rig.bounds);
    features.right_of_left.resize(left.size(), -1);
    features.left_of_right.resize(right.size(), -1);
    std::vector<std::pair<std::size_t, std::size_t>> rows;  // of the right image, by point
    for (std::size_t row = 0; row < right.size(); ++row)
      if (right[row].point != kClutter) rows.emplace_back(right[row].point, row);
    std::sort(rows.begin(), rows.end());
    for (std::size_t row = 0; row < left.size(); ++row) {
      const auto found = std::lower_bound(rows.begin(), rows.end(), std::pair(left[row].point, std::size_t{0}));
      if (found == rows.end() || found->first != left[row].point) continue;
      features.right_of_left[row] = static_cast<std::int32_t>(found->second);
      features.left_of_right[found->second] = static_cast<std::int32_t>(row);
      const double depth = (camera_from_room_ * view_.room.points[left[row].point]).z();
      features.depth[row] = static_cast<float>(depth);
    }
  }

  const View& view_;
  Random random_;
  double turn_;
  Pose camera_from_room_;
  std::array<std::vector<Slot>, 2> images_;  // left, right
};

}  // namespace

Features View::See(std::size_t index) const { return Looking(*this, index).Run(); }

}  // namespace slamdb::synthetic
