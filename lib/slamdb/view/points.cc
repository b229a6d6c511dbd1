// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "slamdb/base/detail/median.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/model/reprojection.h"
#include "slamdb/view/detail/encode.h"

namespace slamdb::view {
namespace {

constexpr std::size_t kRowsPerBlock = 4096, kBlocksPerTask = 8;
constexpr int kErrorStep = 2;  // of 254: more than colours can show
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

struct Block {
  const Column<MapPoint>* points;
  std::size_t first, count;  // rows of that list
  std::size_t row;           // of the scene
};

std::vector<Block> BlocksOf(const Scene& scene) {
  std::vector<Block> blocks;
  scene.ForEachMapOfPoints([&](const SceneAtlas& atlas, std::uint32_t map, std::size_t row, std::size_t count) {
    for (std::size_t first = 0; first < count; first += kRowsPerBlock)
      blocks.push_back({&atlas.atlas().maps[map].points, first, std::min(kRowsPerBlock, count - first), row + first});
  });
  return blocks;
}

// What a block of one axis is measured with.
struct Ruler {
  float origin = 0, step = 0;
  double low = 0, high = 0;  // what is beyond is far away from the block's bulk

  // Nine tenths of the values decide how long it is, so that one stray point does not coarsen all others, and how fine:
  // a block that fills a screen shows no step.
  static Ruler For(std::vector<float>& values) {
    constexpr double kTail = 0.05, kReach = 4, kSteps = 4096;
    if (values.empty()) return {};
    const auto [least, most] = std::ranges::minmax(values);
    const double low = detail::QuantileOf(values, kTail), high = detail::QuantileOf(values, 1 - kTail);
    const double reach = kReach * (high - low);
    Ruler ruler;
    ruler.low = std::max<double>(least, low - reach);
    ruler.high = std::min<double>(most, high + reach);
    ruler.origin = static_cast<float>(ruler.low);
    ruler.step = static_cast<float>(
        std::max((ruler.high - ruler.low) / std::numeric_limits<std::uint16_t>::max(), (high - low) / kSteps));
    return ruler;
  }

  bool Reaches(float value) const { return value >= low && value <= high; }
  std::uint16_t Measure(float value) const {
    if (step <= 0) return 0;
    const double steps = std::round((double{value} - double{origin}) / double{step});
    return static_cast<std::uint16_t>(std::clamp(steps, 0.0, 65535.0));
  }
};

// The positions of a block, on their way into the columns.
class BlockWriter {
 public:
  explicit BlockWriter(const Block& block) : block_(block) {
    std::vector<float> values;
    for (int axis = 0; axis < 3; ++axis) {
      values.clear();
      for (std::size_t i = 0; i < block.count; ++i)
        if (Position(i).allFinite()) values.push_back(Position(i)[axis]);
      rulers_[axis] = Ruler::For(values);
    }
  }

  void WriteFrame(char* frame) const {
    for (int axis = 0; axis < 3; ++axis) {
      std::memcpy(frame + 4 * axis, &rulers_[axis].origin, 4);
      std::memcpy(frame + 12 + 4 * axis, &rulers_[axis].step, 4);
    }
  }

  // Differences from row to row: low bytes of the block, then high bytes.
  void WriteAxis(int axis, char* bytes) const {
    std::uint16_t last = 0;
    for (std::size_t i = 0; i < block_.count; ++i) {
      const std::uint16_t value = IsNear(i) ? rulers_[axis].Measure(Position(i)[axis]) : std::uint16_t{0};
      const auto difference = static_cast<std::uint16_t>(value - last);
      bytes[i] = static_cast<char>(difference & 0xff);
      bytes[block_.count + i] = static_cast<char>(difference >> 8);
      last = value;
    }
  }

  void CollectFar(std::vector<std::uint32_t>& rows) const {
    for (std::size_t i = 0; i < block_.count; ++i)
      if (Position(i).allFinite() && !IsNear(i)) rows.push_back(static_cast<std::uint32_t>(block_.row + i));
  }

 private:
  const Eigen::Vector3f& Position(std::size_t i) const { return (*block_.points)[block_.first + i].position; }
  bool IsNear(std::size_t i) const {  // false for what is not finite, too
    const Eigen::Vector3f& position = Position(i);
    return rulers_[0].Reaches(position.x()) && rulers_[1].Reaches(position.y()) && rulers_[2].Reaches(position.z());
  }

  const Block& block_;
  std::array<Ruler, 3> rulers_;
};

void AddPositions(const Scene& scene, int threads, Columns& columns) {
  const std::vector<Block> blocks = BlocksOf(scene);
  std::string frame(24 * blocks.size(), '\0');
  std::array<std::string, 3> axes;
  axes.fill(std::string(2 * std::size_t{scene.points()}, '\0'));
  std::vector<std::vector<std::uint32_t>> far(blocks.size());
  detail::ParallelFor(blocks.size(), kBlocksPerTask, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const BlockWriter writer(blocks[i]);
      writer.WriteFrame(frame.data() + 24 * i);
      for (int axis = 0; axis < 3; ++axis) writer.WriteAxis(axis, axes[axis].data() + 2 * blocks[i].row);
      writer.CollectFar(far[i]);
    }
  });
  VarintColumn rows;
  std::string positions;
  for (std::size_t i = 0; i < blocks.size(); ++i)
    for (const std::uint32_t row : far[i]) {
      const Eigen::Vector3f& place = (*blocks[i].points)[blocks[i].first + (row - blocks[i].row)].position;
      rows.AddDifference(row);
      AppendBytes(positions, place.x(), place.y(), place.z());
    }
  columns.push_back({"points/frame", std::move(frame)});
  columns.push_back({"points/x", std::move(axes[0])});
  columns.push_back({"points/y", std::move(axes[1])});
  columns.push_back({"points/z", std::move(axes[2])});
  columns.push_back({"points/far_row", rows.Take()});
  columns.push_back({"points/far", std::move(positions)});
}

// By row; NaN where nothing can be projected.
std::vector<float> MeanErrors(const Scene& scene, int threads) {
  std::vector<float> errors(scene.points(), kUnknown);
  scene.ForEachMapOfPoints([&](const SceneAtlas& atlas, std::uint32_t map_row, std::size_t row, std::size_t count) {
    const Map& map = atlas.atlas().maps[map_row];
    const Reprojection reprojection(atlas.atlas(), map);
    detail::ParallelFor(count, kRowsPerBlock, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) errors[row + i] = reprojection.Mean(map.points[i]);
    });
  });
  return errors;
}

// All but the worst thousandth, which would take the steps from the others.
double LargestError(const std::vector<float>& errors) {
  std::vector<float> known;
  known.reserve(errors.size());
  std::ranges::copy_if(errors, std::back_inserter(known), [](float error) { return std::isfinite(error); });
  return detail::QuantileOf(known, 0.999);
}

std::string ErrorBytes(const std::vector<float>& errors, double largest) {
  std::string bytes(errors.size(), '\0');
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (std::isnan(errors[i])) continue;
    const double part = largest > 0 ? std::sqrt(std::min(1.0, errors[i] / largest)) : 0;
    bytes[i] = static_cast<char>(1 + kErrorStep * std::lround(254 / kErrorStep * part));
  }
  return bytes;
}

std::string IdBytes(const Scene& scene) {
  VarintColumn ids;
  ids.Reserve(2 * std::size_t{scene.points()});
  scene.ForEachPoint(
      [&](const SceneAtlas&, std::uint32_t, const MapPoint& point) { ids.AddDifference(point.id.value()); });
  return ids.Take();
}

std::string ReferenceBytes(const Scene& scene) {
  VarintColumn references;
  references.Reserve(2 * std::size_t{scene.points()});
  scene.ForEachPoint([&](const SceneAtlas& atlas, std::uint32_t map, const MapPoint& point) {
    references.AddDifference(static_cast<std::uint64_t>(atlas.KeyFrameRow(map, point.reference)));
  });
  return references.Take();
}

// Of each point its observers, ascending. A keyframe that is not in the map, or listed twice, is none more.
std::string SeenBytes(const Scene& scene) {
  VarintColumn seen;
  seen.Reserve(8 * std::size_t{scene.points()});
  std::vector<std::int64_t> rows;
  std::int64_t last_first = 0;
  scene.ForEachPoint([&](const SceneAtlas& atlas, std::uint32_t map, const MapPoint& point) {
    rows.clear();
    for (const Observation& observation : point.observations) {
      const std::int64_t row = atlas.KeyFrameRow(map, observation.keyframe);
      if (row >= 0) rows.push_back(row);
    }
    if (!std::ranges::is_sorted(rows, std::less_equal())) {  // files have them by id, which mostly is by row
      std::ranges::sort(rows);
      rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    }
    seen.Add(rows.size());
    if (rows.empty()) return;
    seen.AddSigned(rows.front() - last_first);
    last_first = rows.front();
    for (std::size_t i = 1; i < rows.size(); ++i) seen.Add(static_cast<std::uint64_t>(rows[i] - rows[i - 1]));
  });
  return seen.Take();
}

// Octahedral: the unit sphere folded onto a square (Meyer et al., On floating-point normal vectors, EGSR 2010).
std::string NormalBytes(const Scene& scene) {
  std::string bytes;
  bytes.reserve(2 * std::size_t{scene.points()});
  scene.ForEachPoint([&](const SceneAtlas&, std::uint32_t, const MapPoint& point) {
    Eigen::Vector3f n = point.normal;
    const float sum = n.cwiseAbs().sum();
    n = sum > 0 && std::isfinite(sum) ? Eigen::Vector3f(n / sum) : Eigen::Vector3f::UnitZ();
    float u = n.x(), v = n.y();
    if (n.z() < 0) {
      u = std::copysign(1 - std::abs(n.y()), n.x());
      v = std::copysign(1 - std::abs(n.x()), n.y());
    }
    bytes.push_back(static_cast<char>(std::lround(u * 127)));
    bytes.push_back(static_cast<char>(std::lround(v * 127)));
  });
  return bytes;
}

// Empty when no point is bad or nowhere.
std::string HiddenBytes(const Scene& scene) {
  std::string bytes(scene.points(), '\0');
  std::size_t row = 0;
  bool any = false;
  scene.ForEachPoint([&](const SceneAtlas&, std::uint32_t, const MapPoint& point) {
    const char hidden = !point.position.allFinite() ? 1 : point.bad ? 2 : 0;
    any = any || hidden != 0;
    bytes[row++] = hidden;
  });
  return any ? bytes : std::string();
}

}  // namespace

PointColumns EncodePoints(const Scene& scene, bool normals, int threads) {
  PointColumns result;
  AddPositions(scene, threads, result.columns);
  const std::vector<float> errors = MeanErrors(scene, threads);
  result.error_max = LargestError(errors);
  std::vector<std::pair<const char*, std::function<std::string()>>> rest = {
      {"points/seen", [&] { return SeenBytes(scene); }},
      {"points/id", [&] { return IdBytes(scene); }},
      {"points/reference", [&] { return ReferenceBytes(scene); }},
      {"points/error", [&] { return ErrorBytes(errors, result.error_max); }},
      {"points/hidden", [&] { return HiddenBytes(scene); }},
  };
  if (normals) rest.emplace_back("points/normal", [&] { return NormalBytes(scene); });
  const std::size_t first = result.columns.size();
  for (const auto& [name, encode] : rest) result.columns.push_back({name, {}});
  detail::ParallelFor(rest.size(), 1, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) result.columns[first + i].bytes = rest[i].second();
  });
  return result;
}

}  // namespace slamdb::view
