// SPDX-License-Identifier: BSD-3-Clause
// Which poses are so far apart. For frames, metres and degrees this is what evo takes; seconds are ours.
#include "slamdb/evaluate/detail/relative_pairs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"

namespace slamdb {
namespace {

constexpr double kRadiansPerDegree = std::numbers::pi / 180;

struct UnitName {
  std::string_view name;
  DeltaUnit unit;
};
constexpr std::array kUnits = {
    UnitName{"f", DeltaUnit::kFrames},      UnitName{"frame", DeltaUnit::kFrames},
    UnitName{"frames", DeltaUnit::kFrames}, UnitName{"m", DeltaUnit::kMetres},
    UnitName{"s", DeltaUnit::kSeconds},     UnitName{"d", DeltaUnit::kDegrees},
    UnitName{"deg", DeltaUnit::kDegrees},   UnitName{"degrees", DeltaUnit::kDegrees},
};

void RequireDelta(const Delta& delta) {
  const bool is_whole =
      delta.unit != DeltaUnit::kFrames || (delta.value == std::floor(delta.value) && delta.value < 1e15);
  const bool is_angle = delta.unit != DeltaUnit::kDegrees || delta.value <= 180;
  if (!(delta.value > 0) || !std::isfinite(delta.value) || !is_whole || !is_angle)
    throw Error(ErrorKind::kUsage, detail::Concat("no poses are ", ToString(delta),
                                                  " apart; expected a number above 0, "
                                                  "whole for frames, at most 180 for degrees"));
}

}  // namespace

std::string ToString(const Delta& delta) {
  std::string text = detail::Digits(delta.value, 15);
  switch (delta.unit) {
    case DeltaUnit::kFrames:
      return text + (delta.value == 1 ? " frame" : " frames");
    case DeltaUnit::kMetres:
      return text + " m";
    case DeltaUnit::kSeconds:
      return text + " s";
    case DeltaUnit::kDegrees:
      break;
  }
  return text + " degrees";
}

Delta ParseDelta(std::string_view text) {
  const std::size_t end = std::min(text.find_last_of("0123456789.") + 1, text.size());
  const auto value = detail::ParseNumber<double>(detail::Trimmed(text.substr(0, end)));
  const auto unit = std::ranges::find(kUnits, detail::Trimmed(text.substr(end)), &UnitName::name);
  if (!value || unit == kUnits.end())
    throw Error(ErrorKind::kUsage,
                detail::Concat("expected a number and its unit, as 1m, 2s, 10f (frames) or 90deg, found `", text, "`"));
  const Delta delta{*value, unit->unit};
  RequireDelta(delta);
  return delta;
}

namespace detail {
namespace {

// Along a path, from its first pose: never less than before.
std::vector<double> DistancesOf(const Path& path) {
  std::vector<double> distances(path.positions.size());
  for (std::size_t i = 1; i < distances.size(); ++i)
    distances[i] = distances[i - 1] + (path.positions[i] - path.positions[i - 1]).norm();
  return distances;
}

IndexPairs PairsByFrames(std::size_t count, std::size_t delta, bool all) {
  IndexPairs pairs;
  for (std::size_t i = 0; delta < count && i < count - delta; i += all ? 1 : delta) pairs.emplace_back(i, i + delta);
  return pairs;
}

// From the first pose behind which `delta` was gone; `gone(i)` is the way from pose i - 1 to pose i.
template <class Gone>
IndexPairs PairsByWay(std::size_t count, double delta, std::optional<std::size_t> from, const Gone& gone) {
  IndexPairs pairs;
  double way = 0;
  for (std::size_t i = 1; i < count; ++i) {
    way += gone(i);
    if (way < delta) continue;
    if (from) pairs.emplace_back(*from, i);
    from = i;
    way = 0;
  }
  return pairs;
}

// The first of the places behind `from` whose distance from it is nearest to `delta`, if it is within `tolerance`.
std::optional<std::size_t> NearestBehind(const std::vector<double>& distances, std::size_t from, double delta,
                                         double tolerance) {
  const auto away = [&](std::size_t place) { return distances[place] - distances[from]; };
  const auto first_at_least = [&](std::size_t begin, std::size_t end, double least) {
    while (begin < end) {
      const std::size_t middle = begin + (end - begin) / 2;
      if (away(middle) < least)
        begin = middle + 1;
      else
        end = middle;
    }
    return begin;
  };
  const std::size_t behind = from + 1, count = distances.size();
  if (behind == count) return std::nullopt;
  std::size_t nearest = first_at_least(behind, count, delta);
  if (nearest > behind) {
    const std::size_t before = first_at_least(behind, nearest, away(nearest - 1));
    if (nearest == count || delta - away(before) <= away(nearest) - delta) nearest = before;
  }
  return std::abs(away(nearest) - delta) <= tolerance ? std::optional(nearest) : std::nullopt;
}

IndexPairs PairsToNearest(const std::vector<double>& distances, double delta, double tolerance, bool all) {
  IndexPairs pairs;
  for (std::size_t i = 0; i < distances.size();) {
    const auto nearest = NearestBehind(distances, i, delta, tolerance);
    if (nearest) pairs.emplace_back(i, *nearest);
    i = nearest && !all ? *nearest : i + 1;
  }
  return pairs;
}

IndexPairs AllPairsByAngle(const std::vector<Eigen::Quaterniond>& rotations, double delta, double tolerance) {
  constexpr std::size_t kMost = 4'000;
  if (rotations.size() > kMost)
    throw Error(ErrorKind::kUsage, Concat("all pairs of ", Counted(rotations.size(), "pose"),
                                          " that are turned so far are too many; they are looked for among ",
                                          Thousands(kMost), " at most"));
  IndexPairs pairs;
  for (std::size_t i = 0; i < rotations.size(); ++i)
    for (std::size_t j = i + 1; j < rotations.size(); ++j) {
      const double angle = AngleOf(rotations[i].conjugate() * rotations[j]);
      if (delta - tolerance <= angle && angle <= delta + tolerance) pairs.emplace_back(i, j);
    }
  return pairs;
}

}  // namespace

double AngleOf(const Eigen::Quaterniond& rotation) {
  return 2 * std::atan2(rotation.vec().norm(), std::abs(rotation.w()));
}

IndexPairs PairsApart(const Path& path, const Delta& delta, const EvaluationOptions& options) {
  RequireDelta(delta);
  const std::size_t count = path.positions.size();
  const double tolerance = options.delta_tolerance * delta.value;
  switch (delta.unit) {
    case DeltaUnit::kFrames:
      return PairsByFrames(count, static_cast<std::size_t>(delta.value), options.all_pairs);
    case DeltaUnit::kMetres:
      if (options.all_pairs) return PairsToNearest(DistancesOf(path), delta.value, tolerance, true);
      return PairsByWay(count, delta.value, std::nullopt,
                        [&](std::size_t i) { return (path.positions[i] - path.positions[i - 1]).norm(); });
    case DeltaUnit::kSeconds:
      return PairsToNearest(path.times, delta.value, tolerance, options.all_pairs);
    case DeltaUnit::kDegrees:
      break;
  }
  const double radians = delta.value * kRadiansPerDegree;
  if (options.all_pairs) return AllPairsByAngle(path.rotations, radians, tolerance * kRadiansPerDegree);
  return PairsByWay(count, radians, 0,
                    [&](std::size_t i) { return AngleOf(path.rotations[i - 1].conjugate() * path.rotations[i]); });
}

}  // namespace detail
}  // namespace slamdb
