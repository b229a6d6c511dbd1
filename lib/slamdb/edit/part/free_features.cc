// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/part/detail/free_features.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include "slamdb/base/detail/parallel.h"
#include "slamdb/model/index.h"

namespace slamdb::detail {
namespace {

constexpr std::size_t kKeyFrameGrain = 16, kPointGrain = 4096;
constexpr std::int32_t kDropped = -1;

using Rows = std::vector<std::int32_t>;  // old row -> new row, or kDropped

bool ColumnsAgree(const Features& features) {
  const auto rows = static_cast<std::size_t>(std::max(features.count, 0));
  if (features.map_points.size() != rows || features.descriptors.size() != rows) return false;
  const bool fisheye = features.is_fisheye_stereo();
  if (fisheye && features.left_count + features.right_count != features.count) return false;
  const std::size_t left = fisheye ? static_cast<std::size_t>(features.left_count) : rows;
  for (const std::size_t size :
       {features.keypoints.size(), features.undistorted.size(), features.right_x.size(), features.depth.size()})
    if (size != left) return false;
  return !fisheye || (features.right_keypoints.size() == rows - left && features.right_of_left.size() == left &&
                      features.left_of_right.size() == rows - left);
}

// Keeps the elements whose new row is one; `offset` is the row of the first element.
template <class T>
void Compact(Column<T>& column, const Rows& rows, std::size_t offset = 0) {
  std::size_t to = 0;
  for (std::size_t from = 0; from < column.size(); ++from)
    if (rows[offset + from] != kDropped) column[to++] = column[from];
  column.erase(column.begin() + static_cast<std::ptrdiff_t>(to), column.end());
}

// Keeps the entries of lists, one behind the other with `sizes` each, whose row stays. Entries are rows relative to
// `offset`, and become so relative to `new_offset`.
template <class Entry>
void CompactLists(Column<std::uint32_t>& sizes, Column<Entry>& entries, const Rows& rows, std::size_t offset,
                  std::int32_t new_offset) {
  std::size_t from = 0, to = 0;
  for (std::uint32_t& size : sizes) {
    const std::size_t end = std::min(from + size, entries.size()), begin = to;
    for (; from < end; ++from) {
      const std::size_t row = offset + static_cast<std::size_t>(entries[from]);
      if (row < rows.size() && rows[row] != kDropped) entries[to++] = static_cast<Entry>(rows[row] - new_offset);
    }
    size = static_cast<std::uint32_t>(to - begin);
  }
  entries.erase(entries.begin() + static_cast<std::ptrdiff_t>(to), entries.end());
}

void CompactFeatureVector(FeatureVector& vector, const Rows& rows) {
  CompactLists(vector.sizes, vector.features, rows, 0, 0);
  std::size_t to = 0;
  for (std::size_t from = 0; from < std::min(vector.sizes.size(), vector.nodes.size()); ++from) {
    if (vector.sizes[from] == 0) continue;
    vector.sizes[to] = vector.sizes[from];
    vector.nodes[to++] = vector.nodes[from];
  }
  vector.sizes.resize(to);
  vector.nodes.resize(to);
}

// Matches are rows relative to the other image, which begins at `offset`, and will begin at `new_offset`.
void RenameMatches(Column<std::int32_t>& matches, const Rows& rows, std::size_t offset, std::int32_t new_offset) {
  for (std::int32_t& match : matches) {
    const auto row = offset + static_cast<std::size_t>(std::max(match, 0));
    const bool stays = match >= 0 && row < rows.size() && rows[row] != kDropped;
    match = stays ? rows[row] - new_offset : -1;
  }
}

void CompactFeatures(Features& features, const Rows& rows) {
  const bool fisheye = features.is_fisheye_stereo();
  const std::size_t left = fisheye ? static_cast<std::size_t>(features.left_count) : rows.size();
  const auto is_kept = [](std::int32_t row) { return row != kDropped; };
  const auto new_left =
      static_cast<std::int32_t>(std::count_if(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(left), is_kept));
  Compact(features.keypoints, rows);
  Compact(features.undistorted, rows);
  Compact(features.right_x, rows);
  Compact(features.depth, rows);
  Compact(features.descriptors, rows);
  Compact(features.map_points, rows);
  CompactLists(features.grid.cell_sizes, features.grid.keypoints, rows, 0, 0);
  CompactFeatureVector(features.feature_vector, rows);
  features.count = static_cast<std::int32_t>(features.map_points.size());
  if (!fisheye) {
    features.right_keypoints.clear();
    return;
  }
  Compact(features.right_keypoints, rows, left);
  Compact(features.right_of_left, rows);
  RenameMatches(features.right_of_left, rows, left, new_left);
  Compact(features.left_of_right, rows, left);
  RenameMatches(features.left_of_right, rows, 0, 0);
  CompactLists(features.right_grid.cell_sizes, features.right_grid.keypoints, rows, left, new_left);
  features.left_count = new_left;
  features.right_count = features.count - new_left;
}

// New rows of each keyframe's features; empty where nothing is dropped.
std::vector<Rows> NumberRows(const Map& map, const IdTable& keyframes) {
  std::vector<Rows> rows(map.keyframes.size());
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const Features& features = map.keyframes[row].features;
    if (!ColumnsAgree(features)) continue;
    rows[row].assign(features.map_points.size(), kDropped);
    for (std::size_t slot = 0; slot < rows[row].size(); ++slot)
      if (features.map_points[slot]) rows[row][slot] = 0;
  }
  for (const MapPoint& point : map.points)
    for (const Observation& observation : point.observations)
      if (const std::uint32_t observer = keyframes.Find(observation.keyframe.value()); observer != kNoRow)
        for (const std::int32_t row : {observation.left, observation.right})
          if (row >= 0 && static_cast<std::size_t>(row) < rows[observer].size())
            rows[observer][static_cast<std::size_t>(row)] = 0;
  for (Rows& each : rows) {
    std::int32_t next = 0;
    for (std::int32_t& row : each)
      if (row != kDropped) row = next++;
    if (next == 0) each.clear();
  }
  return rows;
}

}  // namespace

std::uint64_t DropFreeFeatures(Atlas& atlas, int threads) {
  std::uint64_t dropped = 0;
  for (Map& map : atlas.maps) {
    const IdTable keyframes = KeyFrameTable(map);
    const std::vector<Rows> rows = NumberRows(map, keyframes);
    for (const Rows& each : rows) dropped += static_cast<std::uint64_t>(std::ranges::count(each, kDropped));
    ParallelFor(map.keyframes.size(), kKeyFrameGrain, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = begin; row < end; ++row)
        if (!rows[row].empty()) CompactFeatures(map.keyframes[row].features, rows[row]);
    });
    ParallelFor(map.points.size(), kPointGrain, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t point = begin; point < end; ++point)
        for (Observation& observation : map.points[point].observations) {
          const std::uint32_t observer = keyframes.Find(observation.keyframe.value());
          if (observer == kNoRow) continue;
          for (std::int32_t* row : {&observation.left, &observation.right})
            if (*row >= 0 && static_cast<std::size_t>(*row) < rows[observer].size())
              *row = rows[observer][static_cast<std::size_t>(*row)];
        }
    });
  }
  return dropped;
}

FeatureSizes SizesOf(const Features& features) {
  if (!ColumnsAgree(features)) return {};
  const std::uint64_t rows = features.map_points.size();
  std::uint64_t all = 28 * (features.keypoints.size() + features.undistorted.size());
  all += 4 * (features.right_x.size() + features.depth.size()) + (32 + 8) * rows;
  all += 8 * (features.grid.keypoints.size() + features.right_grid.keypoints.size());
  all += 4 * features.feature_vector.features.size();
  constexpr std::uint64_t kInAll = 32 + 8 + 8 + 4;  // descriptor, slot, entries in a grid and in the feature vector
  constexpr std::uint64_t kLeft = 2 * 28 + 2 * 4 + kInAll, kRight = 28 + kInAll;
  if (!features.is_fisheye_stereo()) return {all, kLeft, 28 * features.right_keypoints.size()};
  constexpr std::uint64_t kMatches = 2 * 4;
  all += 28 * features.right_keypoints.size() + 4 * rows;
  return {all, kLeft + kRight + kMatches, 0};
}

}  // namespace slamdb::detail
