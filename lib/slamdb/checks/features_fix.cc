// SPDX-License-Identifier: BSD-3-Clause
// What can be made good in features: counts that the columns tell, tables that are derived, entries of bags that are
// too many.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "slamdb/checks/detail/catalogue.h"
#include "slamdb/checks/detail/visit.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/vocabulary.h"

namespace slamdb::detail {
namespace {

template <class Change>
std::size_t ChangeKeyFrames(Atlas& atlas, const Change& change) {
  std::size_t changed = 0;
  for (Map& map : atlas.maps)
    for (KeyFrame& keyframe : map.keyframes)
      if (!keyframe.bad) changed += change(keyframe);
  return changed;
}
template <class Change>
std::size_t ChangeFeatures(Atlas& atlas, const Change& change) {
  return ChangeKeyFrames(atlas, [&](KeyFrame& keyframe) { return change(keyframe.features); });
}

bool CountsAgree(const Features& features) {
  const std::int64_t left = features.left_count, right = features.right_count, count = features.count;
  return count >= 0 && ((left == -1 && right == -1) || (left >= 0 && right >= 0 && left + right == count));
}

bool Rises(const Column<std::uint32_t>& keys) {
  return std::ranges::adjacent_find(keys, std::greater_equal<>()) == keys.end();
}

bool DropWords(Features& features) {
  features.bag_of_words = {};
  features.feature_vector = {};
  return true;
}

// Whether the nodes' entries are all there.
bool IsWhole(const FeatureVector& vector) {
  return vector.nodes.size() == vector.sizes.size() &&
         std::accumulate(vector.sizes.begin(), vector.sizes.end(), std::uint64_t{0}) == vector.features.size();
}

// Takes entries that are no row, or one that stood before, out of a feature vector; nodes without entries go too.
std::size_t EraseWild(FeatureVector& vector, std::size_t rows) {
  if (!IsWhole(vector)) return 0;
  std::vector<bool> seen(rows, false);
  FeatureVector kept;
  std::size_t entry = 0;
  for (std::size_t node = 0; node < vector.nodes.size(); ++node) {
    const std::size_t before = kept.features.size();
    for (const std::size_t end = entry + vector.sizes[node]; entry < end; ++entry) {
      const std::uint32_t row = vector.features[entry];
      if (row >= rows || seen[row]) continue;
      seen[row] = true;
      kept.features.push_back(row);
    }
    if (kept.features.size() == before && vector.sizes[node] > 0) continue;
    kept.nodes.push_back(vector.nodes[node]);
    kept.sizes.push_back(static_cast<std::uint32_t>(kept.features.size() - before));
  }
  const std::size_t erased = vector.features.size() - kept.features.size();
  if (erased > 0) vector = std::move(kept);
  return erased;
}

}  // namespace

// Only where all columns agree.
std::size_t RecountFeatures(Atlas& atlas) {
  return ChangeKeyFrames(atlas, [](KeyFrame& keyframe) {
    Features& features = keyframe.features;
    const bool matched = !features.right_of_left.empty() || !features.left_of_right.empty();
    const std::size_t left = features.keypoints.size(), right = matched ? features.right_keypoints.size() : 0;
    if (CountsAgree(features) || DescriptorRows(keyframe) != left + right) return false;
    if (features.map_points.size() != left + right || features.undistorted.size() != left) return false;
    features.count = static_cast<std::int32_t>(left + right);
    features.left_count = matched ? static_cast<std::int32_t>(left) : -1;
    features.right_count = matched ? static_cast<std::int32_t>(right) : -1;
    return true;
  });
}

std::size_t RebuildPyramids(Atlas& atlas) {
  constexpr std::int32_t kMostLevels = 64;
  std::size_t rebuilt = 0;
  for (Map& map : atlas.maps)
    for (KeyFrame& keyframe : map.keyframes) {
      ScalePyramid& pyramid = keyframe.pyramid;
      const bool derivable =
          pyramid.levels > 0 && pyramid.levels <= kMostLevels && pyramid.factor >= 1 && std::isfinite(pyramid.factor);
      const auto levels = static_cast<std::size_t>(std::max(pyramid.levels, 0));
      const bool fits = pyramid.factors.size() == levels && pyramid.sigma2.size() == levels &&
                        pyramid.inverse_sigma2.size() == levels;
      if (keyframe.bad || fits || !derivable) continue;
      pyramid = DerivePyramid(pyramid.levels, pyramid.factor);
      ++rebuilt;
    }
  return rebuilt;
}

std::size_t ClearWildMatches(Atlas& atlas) {
  return ChangeFeatures(atlas, [](Features& features) {
    std::size_t cleared = 0;
    const auto clear = [&](Column<std::int32_t>& matches, std::int32_t count) {
      for (std::int32_t& match : matches) {
        if (match >= -1 && match < count) continue;
        match = -1;
        ++cleared;
      }
    };
    if (!features.is_fisheye_stereo()) return cleared;
    clear(features.right_of_left, features.right_count);
    clear(features.left_of_right, features.left_count);
    return cleared;
  });
}

std::size_t EraseWildFeatures(Atlas& atlas) {
  return ChangeKeyFrames(
      atlas, [](KeyFrame& keyframe) { return EraseWild(keyframe.features.feature_vector, DescriptorRows(keyframe)); });
}

// What a file holds out of order was never written so, and sorting would hide it. Without words ORB-SLAM3 does not find
// the keyframe by its looks, until they are computed anew.
std::size_t DropUnsortedBags(Atlas& atlas) {
  return ChangeFeatures(atlas, [](Features& features) {
    return !(Rises(features.bag_of_words.words) && Rises(features.feature_vector.nodes)) && DropWords(features);
  });
}

std::size_t DropWildBags(Atlas& atlas) {
  const std::optional<std::uint64_t> end = WordsEnd(atlas);
  if (!end) return 0;
  return ChangeFeatures(atlas, [&](Features& features) {
    const auto wild = [&](std::uint32_t word) { return word >= *end; };
    return std::ranges::any_of(features.bag_of_words.words, wild) && DropWords(features);
  });
}

}  // namespace slamdb::detail
