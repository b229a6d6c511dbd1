// SPDX-License-Identifier: BSD-3-Clause
// The times of keyframes: that they are seconds, and of one clock.
#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/median.h"
#include "slamdb/base/detail/time_units.h"
#include "slamdb/checks/detail/catalogue.h"
#include "slamdb/checks/detail/visit.h"

namespace slamdb::detail {
namespace {

constexpr double kHour = 3600;

// The good keyframes with a finite time, in the order in which the runs of the system made them.
std::vector<const KeyFrame*> InOrderOfRuns(const Map& map) {
  std::vector<const KeyFrame*> order;
  for (const KeyFrame& keyframe : map.keyframes)
    if (!keyframe.bad && std::isfinite(keyframe.timestamp)) order.push_back(&keyframe);
  std::ranges::stable_sort(order, [](const KeyFrame* a, const KeyFrame* b) {
    return std::pair(a->origin_map, a->id) < std::pair(b->origin_map, b->id);
  });
  return order;
}

// What a fork wrote as 32 bits of seconds and 32 bits of nanoseconds, and was read as one double.
std::optional<double> UnpackedSeconds(double timestamp) {
  const auto bits = std::bit_cast<std::uint64_t>(timestamp);
  const auto low = static_cast<std::uint32_t>(bits), high = static_cast<std::uint32_t>(bits >> 32);
  for (const auto& [seconds, nanoseconds] : {std::pair(low, high), std::pair(high, low)})
    if (IsEpoch(seconds) && nanoseconds < 1'000'000'000) return seconds + nanoseconds * 1e-9;
  return std::nullopt;
}

// No time of any clock that counts seconds, but the two halves of one.
bool IsPacked(double timestamp) {
  const double size = std::abs(timestamp);
  return timestamp != 0 && std::isfinite(timestamp) && (size < 1e-12 || size > 1e20) && UnpackedSeconds(timestamp);
}

// The unit in which a time lies in this century, when it is not seconds.
std::optional<TimeUnit> OtherUnit(double timestamp) {
  for (const TimeUnit unit : {TimeUnit::kMilliseconds, TimeUnit::kMicroseconds, TimeUnit::kNanoseconds})
    if (IsEpoch(timestamp * std::pow(10.0, PowerOf(unit)))) return unit;
  return std::nullopt;
}

// What the time is in seconds, when it surely counts something else.
std::optional<double> MeantSeconds(double timestamp) {
  if (IsPacked(timestamp)) return UnpackedSeconds(timestamp);
  if (const auto unit = OtherUnit(timestamp)) return timestamp / std::pow(10.0, -PowerOf(*unit));
  return std::nullopt;
}

// The one that all of the map's finite times have; none when they differ.
std::optional<TimeUnit> CommonOtherUnit(const Map& map) {
  std::optional<TimeUnit> common;
  for (const KeyFrame& keyframe : map.keyframes) {
    if (!std::isfinite(keyframe.timestamp)) continue;
    const auto unit = OtherUnit(keyframe.timestamp);
    if (!unit || (common && *unit != *common)) return std::nullopt;
    common = unit;
  }
  return common;
}

double MedianStep(const std::vector<const KeyFrame*>& order) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < order.size(); ++i)
    steps.push_back(std::abs(order[i]->timestamp - order[i - 1]->timestamp));
  return MedianOf(std::move(steps));
}

bool CountsOther(const KeyFrame& keyframe) { return MeantSeconds(keyframe.timestamp).has_value(); }

}  // namespace

void CheckTimestampSeconds(const Subject& subject, Findings& findings) {
  for (const Map& map : subject.atlas.maps) {
    if (const auto unit = CommonOtherUnit(map)) {
      const KeyFrame& first = *std::ranges::find_if(map.keyframes, CountsOther);
      findings.Add(PlaceOf(map), "its timestamps count ", NameOf(*unit), ", not seconds: that of ", first.id, " is ",
                   first.timestamp, ", which as ", NameOf(*unit), " is ", Fixed(*MeantSeconds(first.timestamp), 3),
                   " s");
    } else if (std::ranges::any_of(map.keyframes, CountsOther)) {
      for (const KeyFrame& keyframe : map.keyframes)
        if (IsPacked(keyframe.timestamp))
          findings.Add(PlaceOf(map, keyframe), "its timestamp is ", keyframe.timestamp,
                       ": seconds and nanoseconds that were read as one number, ",
                       Fixed(*MeantSeconds(keyframe.timestamp), 3), " s");
        else if (const auto own = OtherUnit(keyframe.timestamp))
          findings.Add(PlaceOf(map, keyframe), "its timestamp ", keyframe.timestamp, " counts ", NameOf(*own),
                       ", and not what others of the map do: it is ", Fixed(*MeantSeconds(keyframe.timestamp), 3),
                       " s");
    } else {
      constexpr double kTooLong = 1e4;  // seconds, from one keyframe to the next
      const double step = MedianStep(InOrderOfRuns(map));
      if (step >= kTooLong)
        findings.Add(PlaceOf(map), "half of its keyframes were taken more than ", step,
                     " s after the one before: do timestamps count ", step < 1e6 ? "ms or us" : "us or ns", "?");
    }
  }
}

// Each by itself: what is right among what is wrong stays.
std::size_t ReadTimestampsAsSeconds(Atlas& atlas) {
  std::size_t changed = 0;
  for (Map& map : atlas.maps)
    for (KeyFrame& keyframe : map.keyframes)
      if (const auto seconds = MeantSeconds(keyframe.timestamp)) {
        keyframe.timestamp = *seconds;
        ++changed;
      }
  return changed;
}

// Keyframes of one origin map come from one run of the system; what merging brought together may overlap in time.
void CheckTimestampOrder(const Subject& subject, Findings& findings) {
  for (const Map& map : subject.atlas.maps) {
    const std::vector<const KeyFrame*> order = InOrderOfRuns(map);
    for (std::size_t i = 1; i < order.size(); ++i) {
      const KeyFrame &before = *order[i - 1], &after = *order[i];
      if (before.origin_map == after.origin_map && before.id != after.id && after.timestamp <= before.timestamp)
        findings.Add(PlaceOf(map, after), "was taken ", before.timestamp - after.timestamp, " s before ", before.id);
    }
  }
}

// Of times that are seconds; others are found by what they count.
void CheckTimestampGap(const Subject& subject, Findings& findings) {
  for (const Map& map : subject.atlas.maps) {
    const std::vector<const KeyFrame*> order = InOrderOfRuns(map);
    if (std::ranges::any_of(map.keyframes, CountsOther) || MedianStep(order) >= kHour) continue;
    for (std::size_t i = 1; i < order.size(); ++i) {
      const KeyFrame &before = *order[i - 1], &after = *order[i];
      const double gap = after.timestamp - before.timestamp;
      if (before.origin_map == after.origin_map && gap >= kHour)
        findings.Add(PlaceOf(map, after), "was taken ", Fixed(gap / kHour, 1), " hours after ", before.id,
                     " of the same run");
    }
  }
}

}  // namespace slamdb::detail
