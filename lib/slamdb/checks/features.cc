// SPDX-License-Identifier: BSD-3-Clause
// Features of keyframes: column lengths, scale tables, grids, bags of words. Keypoints: keypoints.cc.
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

// visit(name, actual, expected) for every column whose length follows from the counts.
template <class Visit>
void ForEachColumn(const KeyFrame& keyframe, const Visit& visit) {
  const Features& features = keyframe.features;
  const bool fisheye_stereo = features.is_fisheye_stereo();
  const std::int64_t left = LeftRows(features);
  visit("keypoints", features.keypoints.size(), left);
  visit("undistorted keypoints", features.undistorted.size(), left);
  visit("right coordinates", features.right_x.size(), left);
  visit("depths", features.depth.size(), left);
  visit("descriptors", DescriptorRows(keyframe), features.count);
  visit("map point slots", features.map_points.size(), features.count);
  visit("left-to-right matches", features.right_of_left.size(), fisheye_stereo ? left : 0);
  visit("right-to-left matches", features.left_of_right.size(), fisheye_stereo ? features.right_count : 0);
  if (fisheye_stereo) visit("right keypoints", features.right_keypoints.size(), features.right_count);
  visit("word weights", features.bag_of_words.weights.size(),
        static_cast<std::int64_t>(features.bag_of_words.words.size()));
  const FeatureVector& vector = features.feature_vector;
  visit("feature vector nodes", vector.nodes.size(), static_cast<std::int64_t>(vector.sizes.size()));
  visit("feature vector entries", vector.features.size(),
        std::accumulate(vector.sizes.begin(), vector.sizes.end(), std::int64_t{0}));
}

// visit(side, keypoints, grid) for the columns that ORB-SLAM3 looks up by grid.
template <class Visit>
void ForEachGrid(const KeyFrame& keyframe, const Visit& visit) {
  const Features& features = keyframe.features;
  visit("", features.is_fisheye_stereo() ? features.keypoints : features.undistorted, features.grid);
  if (features.is_fisheye_stereo()) visit("right ", features.right_keypoints, features.right_grid);
}

bool GridFits(const FeatureGrid& grid, const ImageBounds& bounds) {
  const auto columns = static_cast<std::uint64_t>(std::max(bounds.grid_columns, 0));
  const auto rows = static_cast<std::uint64_t>(std::max(bounds.grid_rows, 0));
  const std::uint64_t entries = std::accumulate(grid.cell_sizes.begin(), grid.cell_sizes.end(), std::uint64_t{0});
  return grid.column_sizes.size() == columns && grid.cell_sizes.size() == columns * rows &&
         entries == grid.keypoints.size() &&
         std::ranges::all_of(grid.column_sizes, [&](std::uint32_t size) { return size == rows; });
}

bool GridIndicesFit(const FeatureGrid& grid, const Column<Keypoint>& keypoints) {
  return std::ranges::all_of(grid.keypoints, [&](std::uint64_t row) { return row < keypoints.size(); });
}

// Where a keypoint is in the grid, in cells along one axis, and how far that may be off: ORB-SLAM3 bins keypoints with
// the exact bounds of the undistorted image, and stores them truncated to whole pixels.
struct GridAxis {
  float origin, cells_per_pixel, cells, slack;

  GridAxis(std::int32_t low, float inverse, std::int32_t count)
      : origin(static_cast<float>(low)),
        cells_per_pixel(inverse),
        cells(static_cast<float>(count)),
        slack(inverse + 1e-3F) {}

  float Position(float pixel) const { return (pixel - origin) * cells_per_pixel; }
  bool MayHold(std::size_t cell, float pixel) const {
    return std::abs(Position(pixel) - static_cast<float>(cell)) <= 0.5F + slack;
  }
  bool MustHold(float pixel) const {
    return Position(pixel) >= slack - 0.5F && Position(pixel) <= cells - 0.5F - slack;
  }
};

// Whether a grid that fits holds each keypoint of the image once, in its cell or, at the border of a cell, next to it.
bool GridHoldsKeypoints(const FeatureGrid& grid, const Column<Keypoint>& keypoints, const ImageBounds& bounds) {
  const GridAxis x(bounds.min_x, bounds.inverse_cell_width, bounds.grid_columns);
  const GridAxis y(bounds.min_y, bounds.inverse_cell_height, bounds.grid_rows);
  const auto rows = static_cast<std::size_t>(std::max(bounds.grid_rows, 1));
  std::vector<bool> held(keypoints.size(), false);
  std::size_t entry = 0;
  for (std::size_t cell = 0; cell < grid.cell_sizes.size(); ++cell)
    for (const std::size_t end = entry + grid.cell_sizes[cell]; entry < end; ++entry) {
      const std::size_t row = grid.keypoints[entry];
      if (held[row] || !x.MayHold(cell / rows, keypoints[row].x) || !y.MayHold(cell % rows, keypoints[row].y))
        return false;
      held[row] = true;
    }
  for (std::size_t row = 0; row < keypoints.size(); ++row)
    if (!held[row] && x.MustHold(keypoints[row].x) && y.MustHold(keypoints[row].y)) return false;
  return true;
}

bool Near(float a, float b, float tolerance) { return std::abs(a - b) <= tolerance * std::max(1.0F, std::abs(b)); }

// True when the tables hold what DerivePyramid makes, to rounding.
bool IsDerivedPyramid(const ScalePyramid& pyramid) {
  constexpr float kTolerance = 1e-3F;
  double factor = 1;
  for (std::size_t level = 0; level < pyramid.factors.size(); ++level, factor *= pyramid.factor) {
    const auto expected = static_cast<float>(factor);
    if (!Near(pyramid.factors[level], expected, kTolerance)) return false;
    if (!Near(pyramid.sigma2[level], expected * expected, kTolerance)) return false;
    if (!Near(pyramid.inverse_sigma2[level] * pyramid.sigma2[level], 1, kTolerance)) return false;
  }
  return Near(pyramid.log_factor, std::log(pyramid.factor), kTolerance);
}

bool TablesFit(const ScalePyramid& pyramid) {
  const auto levels = static_cast<std::size_t>(std::max(pyramid.levels, 0));
  return pyramid.levels > 0 && pyramid.factors.size() == levels && pyramid.sigma2.size() == levels &&
         pyramid.inverse_sigma2.size() == levels;
}

}  // namespace

void CheckFeatureCount(const Subject& subject, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t, const Map& map, const KeyFrame& keyframe) {
    const Features& features = keyframe.features;
    const std::int64_t left = features.left_count, right = features.right_count, count = features.count;
    const bool one_image = left == -1 && right == -1;
    if (count < 0) findings.Add(PlaceOf(map, keyframe), "has N = ", count, " features");
    if (!one_image && (left < 0 || right < 0 || left + right != count))
      findings.Add(PlaceOf(map, keyframe), "has N = ", count, " features, but NLeft = ", left, " and NRight = ", right);
  });
}

void CheckColumnLength(const Subject& subject, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t, const Map& map, const KeyFrame& keyframe) {
    ForEachColumn(keyframe, [&](const char* column, std::size_t size, std::int64_t expected) {
      if (static_cast<std::int64_t>(size) != expected)
        findings.Add(PlaceOf(map, keyframe), "has ", size, " ", column, " instead of ", expected);
    });
  });
}

void CheckPyramidTables(const Subject& subject, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t, const Map& map, const KeyFrame& keyframe) {
    const ScalePyramid& pyramid = keyframe.pyramid;
    if (!TablesFit(pyramid))
      findings.Add(PlaceOf(map, keyframe), "has ", pyramid.levels, " pyramid levels, but tables of ",
                   pyramid.factors.size(), ", ", pyramid.sigma2.size(), " and ", pyramid.inverse_sigma2.size());
  });
}

void CheckPyramidScale(const Subject& subject, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t, const Map& map, const KeyFrame& keyframe) {
    if (TablesFit(keyframe.pyramid) && !IsDerivedPyramid(keyframe.pyramid))
      findings.Add(PlaceOf(map, keyframe), "the scale tables are not the powers of ", keyframe.pyramid.factor);
  });
}

void CheckGridShape(const Subject& subject, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t, const Map& map, const KeyFrame& keyframe) {
    const ImageBounds& bounds = keyframe.bounds;
    ForEachGrid(keyframe, [&](const char* side, const Column<Keypoint>&, const FeatureGrid& grid) {
      if (!GridFits(grid, bounds))
        findings.Add(PlaceOf(map, keyframe), "the ", side, "grid has ", grid.column_sizes.size(), " columns of ",
                     grid.column_sizes.empty() ? 0 : grid.column_sizes[0], " cells instead of ", bounds.grid_columns,
                     " of ", bounds.grid_rows);
    });
    if (!keyframe.features.is_fisheye_stereo() && !keyframe.features.right_grid.empty())
      findings.Add(PlaceOf(map, keyframe), "has a right grid without right features");
  });
}

void CheckGridIndex(const Subject& subject, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t, const Map& map, const KeyFrame& keyframe) {
    ForEachGrid(keyframe, [&](const char* side, const Column<Keypoint>& keypoints, const FeatureGrid& grid) {
      for (const std::uint64_t row : grid.keypoints)
        if (row >= keypoints.size())
          findings.Add(PlaceOf(map, keyframe), "the ", side, "grid holds keypoint ", row, " of ", keypoints.size());
    });
  });
}

void CheckGridCell(const Subject& subject, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t, const Map& map, const KeyFrame& keyframe) {
    ForEachGrid(keyframe, [&](const char* side, const Column<Keypoint>& keypoints, const FeatureGrid& grid) {
      if (IsDerivedGrid(grid, keypoints, keyframe.bounds)) return;
      if (!GridFits(grid, keyframe.bounds) || !GridIndicesFit(grid, keypoints)) return;
      if (!GridHoldsKeypoints(grid, keypoints, keyframe.bounds))
        findings.Add(PlaceOf(map, keyframe), "the ", side, "grid does not hold each keypoint in its cell");
    });
  });
}

// A right grid without right features goes too.
std::size_t RebuildGrids(Atlas& atlas) {
  std::size_t rebuilt = 0;
  const auto rebuild = [&](FeatureGrid& grid, const Column<Keypoint>& keypoints, const ImageBounds& bounds) {
    if (IsDerivedGrid(grid, keypoints, bounds)) return;
    const bool fits = GridFits(grid, bounds) && GridIndicesFit(grid, keypoints);
    if (fits && GridHoldsKeypoints(grid, keypoints, bounds)) return;
    grid = DeriveGrid(keypoints, bounds);
    ++rebuilt;
  };
  for (Map& map : atlas.maps)
    for (KeyFrame& keyframe : map.keyframes) {
      Features& features = keyframe.features;
      const bool fisheye_stereo = features.is_fisheye_stereo();
      rebuild(features.grid, fisheye_stereo ? features.keypoints : features.undistorted, keyframe.bounds);
      if (fisheye_stereo)
        rebuild(features.right_grid, features.right_keypoints, keyframe.bounds);
      else
        rebuild(features.right_grid, {}, {});
    }
  return rebuilt;
}

void CheckImageBounds(const Subject& subject, Findings& findings) {
  const auto agrees = [](std::int32_t cells, std::int32_t low, std::int32_t high, float inverse) {
    return high > low && cells > 0 &&
           Near(inverse * (static_cast<float>(high) - static_cast<float>(low)) / static_cast<float>(cells), 1, 0.02F);
  };
  ForEachKeyFrame(subject.atlas, [&](std::size_t, const Map& map, const KeyFrame& keyframe) {
    const ImageBounds& bounds = keyframe.bounds;
    if (!agrees(bounds.grid_columns, bounds.min_x, bounds.max_x, bounds.inverse_cell_width))
      findings.Add(PlaceOf(map, keyframe), "the image reaches from x = ", bounds.min_x, " to ", bounds.max_x, ", but ",
                   bounds.grid_columns, " grid columns measure 1/", bounds.inverse_cell_width, " pixels");
    if (!agrees(bounds.grid_rows, bounds.min_y, bounds.max_y, bounds.inverse_cell_height))
      findings.Add(PlaceOf(map, keyframe), "the image reaches from y = ", bounds.min_y, " to ", bounds.max_y, ", but ",
                   bounds.grid_rows, " grid rows measure 1/", bounds.inverse_cell_height, " pixels");
  });
}

void CheckFeatureVectorIndex(const Subject& subject, Findings& findings) {
  std::vector<bool> seen;
  ForEachKeyFrame(subject.atlas, [&](std::size_t, const Map& map, const KeyFrame& keyframe) {
    const Features& features = keyframe.features;
    seen.assign(DescriptorRows(keyframe), false);
    for (const std::uint32_t row : features.feature_vector.features) {
      if (row >= seen.size())
        findings.Add(PlaceOf(map, keyframe), "the feature vector holds feature ", row, " of ", seen.size());
      else if (seen[row])
        findings.Add(PlaceOf(map, keyframe), "the feature vector holds feature ", row, " more than once");
      else
        seen[row] = true;
    }
  });
}

void CheckBagOfWordsPaired(const Subject& subject, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t, const Map& map, const KeyFrame& keyframe) {
    const bool words = !keyframe.features.bag_of_words.words.empty();
    const bool nodes = !keyframe.features.feature_vector.nodes.empty();
    if (words != nodes)
      findings.Add(PlaceOf(map, keyframe),
                   words ? "has a bag of words, but no feature vector" : "has a feature vector, but no bag of words");
  });
}

// Without either, ORB-SLAM3 computes both again.
std::size_t ClearHalfBags(Atlas& atlas) {
  std::size_t cleared = 0;
  for (Map& map : atlas.maps)
    for (KeyFrame& keyframe : map.keyframes) {
      Features& features = keyframe.features;
      if (features.bag_of_words.words.empty() == features.feature_vector.nodes.empty()) continue;
      features.bag_of_words = {};
      features.feature_vector = {};
      ++cleared;
    }
  return cleared;
}

void CheckBagOfWordsWeight(const Subject& subject, Findings& findings) {
  ForEachKeyFrame(subject.atlas, [&](std::size_t, const Map& map, const KeyFrame& keyframe) {
    const Column<double>& weights = keyframe.features.bag_of_words.weights;
    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    if (!weights.empty() && !(std::abs(sum - 1) <= 1e-6))
      findings.Add(PlaceOf(map, keyframe), "the weights of its words add up to ", sum);
  });
}

void CheckBagOfWordsSorted(const Subject& subject, Findings& findings) {
  const auto rises = [](const Column<std::uint32_t>& keys) {
    return std::ranges::adjacent_find(keys, std::greater_equal<>()) == keys.end();
  };
  ForEachKeyFrame(subject.atlas, [&](std::size_t, const Map& map, const KeyFrame& keyframe) {
    if (!rises(keyframe.features.bag_of_words.words))
      findings.Add(PlaceOf(map, keyframe), "the words of its bag do not ascend");
    if (!rises(keyframe.features.feature_vector.nodes))
      findings.Add(PlaceOf(map, keyframe), "the nodes of its feature vector do not ascend");
  });
}

// Of a vocabulary that is neither given nor known, the bags themselves tell how far words go.
void CheckWordRange(const Subject& subject, Findings& findings) {
  std::optional<std::uint64_t> words = subject.options.vocabulary_words;
  if (!words) words = KnownWords(subject.atlas.vocabulary);
  const std::optional<std::uint64_t> end = words ? words : WordsFarAbove(subject.atlas);
  if (!end) return;
  ForEachKeyFrame(subject.atlas, [&](std::size_t, const Map& map, const KeyFrame& keyframe) {
    for (const std::uint32_t word : keyframe.features.bag_of_words.words) {
      if (word < *end) continue;
      if (words)
        findings.Add(PlaceOf(map, keyframe), "has word ", word, " of a vocabulary of ", *words, " words");
      else
        findings.Add(PlaceOf(map, keyframe), "has word ", word, ", far above the words of the other keyframes, below ",
                     *end);
    }
  });
}

}  // namespace slamdb::detail
