// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/build/detail/chain.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "slamdb/build/detail/columns.h"
#include "slamdb/model/index.h"
#include "slamdb/model/preintegration.h"

namespace slamdb::detail {
namespace {

constexpr double kNoTime = 1e-6;  // seconds, less than measurements last

double DurationOf(const Column<ImuMeasurement>& measurements) {
  double sum = 0;
  for (const ImuMeasurement& measurement : measurements) sum += static_cast<double>(measurement.duration);
  return sum;
}

// Takes the first `seconds` out of measurements. That in which they end is a part of both.
Column<ImuMeasurement> TakeFirst(double seconds, Column<ImuMeasurement>& measurements) {
  Column<ImuMeasurement> taken;
  std::size_t whole = 0;
  while (whole < measurements.size() && static_cast<double>(measurements[whole].duration) <= seconds + kNoTime)
    seconds -= static_cast<double>(measurements[whole++].duration);
  taken.assign(measurements.begin(), measurements.begin() + static_cast<std::ptrdiff_t>(whole));
  measurements.erase(measurements.begin(), measurements.begin() + static_cast<std::ptrdiff_t>(whole));
  if (seconds <= kNoTime || measurements.empty()) return taken;
  taken.push_back(measurements.front());
  taken.back().duration = static_cast<float>(seconds);
  measurements.front().duration -= taken.back().duration;
  return taken;
}

class Planner {
 public:
  Planner(const Map& map, const NewKeyFrames& given)
      : map_(map), given_(given), first_(static_cast<std::uint32_t>(map.keyframes.size())) {
    const IdTable table = KeyFrameTable(map);
    for (const KeyFrame& keyframe : map.keyframes)
      next_.push_back(keyframe.next ? table.Find(keyframe.next.value()) : kNoRow);
    next_.resize(first_ + given.timestamps.size(), kNoRow);
  }

  std::vector<ChainStep> ByTime() {
    const std::vector<std::uint32_t> order = Order();
    for (std::size_t i = 0; i < order.size(); ++i) {
      if (order[i] < first_) continue;
      for (const std::size_t other : {i - 1, i + 1})  // below 0: beyond the end
        if (other < order.size() && TimeOf(order[other]) == TimeOf(order[i]))
          RefuseRow("timestamps", RowOf(order[i]), "is that of ", IdOf(order[other]),
                    ", too; an IMU measures what is between two times");
      Place(order[i], i == 0 ? kNoRow : order[i - 1]);
    }
    return std::move(steps_);
  }

  std::vector<ChainStep> ByPrevious() {
    const IdTable table = KeyFrameTable(map_);
    std::vector<std::pair<KeyFrameId, std::uint32_t>> added;
    for (std::size_t row = 0; row < given_.ids.size(); ++row)
      added.emplace_back(given_.ids[row], first_ + static_cast<std::uint32_t>(row));
    std::ranges::sort(added);
    for (std::uint32_t row = first_; row < next_.size(); ++row) {
      const KeyFrameId id = given_.imu->previous[RowOf(row)];
      if (!id) continue;
      const auto found = std::ranges::lower_bound(added, id, {}, [](const auto& each) { return each.first; });
      Follow(row, id, found != added.end() && found->first == id ? found->second : table.Find(id.value()));
    }
    return std::move(steps_);
  }

 private:
  // Of those whose time is known.
  std::vector<std::uint32_t> Order() const {
    std::vector<std::uint32_t> order;
    for (std::uint32_t row = 0; row < next_.size(); ++row)
      if (std::isfinite(TimeOf(row)) && (row >= first_ || !map_.keyframes[row].bad)) order.push_back(row);
    std::ranges::stable_sort(order, {}, [&](std::uint32_t row) { return TimeOf(row); });
    return order;
  }

  // Behind the keyframe before in time, and before what came behind that.
  void Place(std::uint32_t row, std::uint32_t previous) {
    const std::uint32_t next = previous == kNoRow ? kNoRow : next_[previous];
    if (next != kNoRow) RequireGap(row, previous, next);
    const bool leads_here = next != kNoRow || !given_.imu->measurements[RowOf(row)].empty();
    if (previous == kNoRow || !leads_here) return;
    RequireDuration(row, previous);
    next_[previous] = row;
    next_[row] = next;
    steps_.push_back({row, previous, next});
  }

  // `id`: what the caller named.
  void Follow(std::uint32_t row, KeyFrameId id, std::uint32_t previous) {
    if (previous == kNoRow) RefuseRow("imu.previous", RowOf(row), "is ", id.value(), ", which the map does not have");
    if (!(TimeOf(previous) < TimeOf(row)))
      RefuseRow("imu.previous", RowOf(row), "is ", id.value(), ", which was not taken before it");
    if (next_[previous] != kNoRow)
      RefuseRow("imu.previous", RowOf(row), "is ", id.value(), ", which is that of ", IdOf(next_[previous]),
                " already; without imu.previous it goes between the two");
    if (given_.imu->measurements[RowOf(row)].empty())
      RefuseRow("imu.measurements", RowOf(row), "has none since ", IdOf(previous),
                ", which imu.previous says is before");
    RequireDuration(row, previous);
    next_[previous] = row;
    steps_.push_back({row, previous, kNoRow});
  }

  // What led from `previous` to `next`, which is no new one, can be split.
  void RequireGap(std::uint32_t row, std::uint32_t previous, std::uint32_t next) const {
    if (!(TimeOf(row) < TimeOf(next)))
      RefuseRow("timestamps", RowOf(row), "is not before ", IdOf(next), ", which follows ", IdOf(previous),
                ": repair the chain of the map, or say in imu.previous what comes before");
    if (map_.keyframes[next].preintegration.measurements.empty())
      RefuseRow("timestamps", RowOf(row), "is between ", IdOf(previous), " and ", IdOf(next),
                ", and the map has no measurements to be split there");
  }

  void RequireDuration(std::uint32_t row, std::uint32_t previous) const {
    const Column<ImuMeasurement>& measurements = given_.imu->measurements[RowOf(row)];
    const double lasts = DurationOf(measurements), apart = TimeOf(row) - TimeOf(previous);
    if (measurements.empty() || std::abs(lasts - apart) <= kPreintegrationTolerance) return;
    RefuseRow("imu.measurements", RowOf(row), "lasts ", lasts, " s, but was taken ", apart, " s after ", IdOf(previous),
              "; it is all since then");
  }

  std::size_t RowOf(std::uint32_t row) const { return row - first_; }
  double TimeOf(std::uint32_t row) const {
    return row < first_ ? map_.keyframes[row].timestamp : given_.timestamps[RowOf(row)];
  }
  KeyFrameId IdOf(std::uint32_t row) const { return row < first_ ? map_.keyframes[row].id : given_.ids[RowOf(row)]; }

  const Map& map_;
  const NewKeyFrames& given_;
  const std::uint32_t first_;  // new row
  std::vector<std::uint32_t> next_;
  std::vector<ChainStep> steps_;
};

// The measurements that led to `next` lead to `keyframe` first.
void Split(double since, KeyFrame& keyframe, KeyFrame& next) {
  ImuPreintegration &before = keyframe.preintegration, &after = next.preintegration;
  const double share = (keyframe.timestamp - since) / (next.timestamp - since);
  Column<ImuMeasurement> first = TakeFirst(DurationOf(after.measurements) * share, after.measurements);
  Reintegrate(after, after.updated_bias);
  if (!before.measurements.empty()) return;
  const ImuBias updated = before.updated_bias;
  before.measurements = std::move(first);
  Reintegrate(before, updated);
}

}  // namespace

std::vector<ChainStep> PlanChain(const Map& map, const NewKeyFrames& given) {
  Planner planner(map, given);
  return given.imu->previous.empty() ? planner.ByTime() : planner.ByPrevious();
}

void FollowChain(Map& map, std::span<const ChainStep> steps) {
  for (const auto& [row, previous_row, next_row] : steps) {
    KeyFrame &keyframe = map.keyframes[row], &previous = map.keyframes[previous_row];
    keyframe.previous = previous.id;
    previous.next = keyframe.id;
    if (next_row == kNoRow) continue;
    KeyFrame& next = map.keyframes[next_row];
    Split(previous.timestamp, keyframe, next);
    keyframe.next = next.id;
    next.previous = keyframe.id;
  }
}

}  // namespace slamdb::detail
