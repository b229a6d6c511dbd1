// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <limits>
#include <variant>

#include "slamdb/base/error.h"
#include "slamdb/many/detail/natural.h"
#include "slamdb/many/list.h"

namespace slamdb {
namespace {

constexpr std::array kKeys = {
    ListKey::kName,      ListKey::kInput,    ListKey::kMaps,         ListKey::kSensor,
    ListKey::kKeyframes, ListKey::kPoints,   ListKey::kObservations, ListKey::kLandmarks,
    ListKey::kLength,    ListKey::kSpan,     ListKey::kDate,         ListKey::kSize,
    ListKey::kFormat,    ListKey::kRevision, ListKey::kSaved,        ListKey::kVerdict,
};
constexpr std::array<std::string_view, kKeys.size()> kWords = {
    "name",   "input", "maps", "sensor", "keyframes", "points",   "observations", "landmarks",
    "length", "span",  "date", "size",   "format",    "revision", "saved",        "verdict"};

// What is not known.
struct Unknown {};
using Value = std::variant<Unknown, double, std::string>;

Value TextOrUnknown(const std::string& text) { return text.empty() ? Value() : Value(text); }

Value Number(std::uint64_t number) { return static_cast<double>(number); }

Value Verdict(const ListedAtlas& atlas) {
  if (!atlas.findings) return {};
  constexpr double kErrorsFirst = 1e9;
  return static_cast<double>(atlas.findings->errors) * kErrorsFirst + static_cast<double>(atlas.findings->warnings);
}

Value Sensor(const AtlasSummary& summary) {
  if (summary.sensors.empty()) return {};
  double number = 0;
  for (const MapSensor sensor : summary.sensors) number = number * 4 + static_cast<double>(sensor);
  return number + (summary.has_imu ? 0.5 : 0);
}

// Of one that could be read.
Value Measure(const ListedAtlas& atlas, ListKey key) {
  const AtlasSummary& summary = atlas.summary;
  switch (key) {
    case ListKey::kMaps:
      return Number(summary.maps);
    case ListKey::kSensor:
      return Sensor(summary);
    case ListKey::kKeyframes:
      return Number(summary.keyframes);
    case ListKey::kPoints:
      return Number(summary.points);
    case ListKey::kObservations:
      return Number(summary.observations);
    case ListKey::kLandmarks:
      return Number(summary.landmarks);
    case ListKey::kLength:
      return summary.trajectory_length;
    case ListKey::kSpan:
      return summary.begin_time ? Value(summary.duration) : Value();
    case ListKey::kDate:
      return summary.begin_time ? Value(*summary.begin_time) : Value();
    case ListKey::kRevision:
      return Number(atlas.revision);
    default:
      return Verdict(atlas);
  }
}

Value ValueOf(const ListedAtlas& atlas, ListKey key) {
  if (key == ListKey::kName) return atlas.name;
  if (key == ListKey::kInput) return atlas.input;
  if (key == ListKey::kFormat) return TextOrUnknown(atlas.format);
  if (key == ListKey::kSaved) return TextOrUnknown(atlas.saved_at);
  if (key == ListKey::kSize) return atlas.bytes ? Number(*atlas.bytes) : Value();
  const Value value = atlas.failure.empty() ? Measure(atlas, key) : Value();
  const auto* number = std::get_if<double>(&value);
  return number != nullptr && std::isnan(*number) ? Value() : value;
}

bool Less(const Value& a, const Value& b) {
  if (const auto* text = std::get_if<std::string>(&a)) return detail::NaturalLess(*text, std::get<std::string>(b));
  return std::get<double>(a) < std::get<double>(b);
}

// Whether a stands before b; unknown ones stand last.
std::weak_ordering Compare(const ListedAtlas& a, const ListedAtlas& b, const SortKey& key) {
  const Value of_a = ValueOf(a, key.key), of_b = ValueOf(b, key.key);
  const bool has_a = of_a.index() != 0, has_b = of_b.index() != 0;
  if (!has_a || !has_b) return has_b <=> has_a;
  if (Less(of_a, of_b)) return key.descending ? std::weak_ordering::greater : std::weak_ordering::less;
  if (Less(of_b, of_a)) return key.descending ? std::weak_ordering::less : std::weak_ordering::greater;
  return std::weak_ordering::equivalent;
}

}  // namespace

std::span<const ListKey> ListKeys() { return kKeys; }

std::string_view NameOf(ListKey key) {
  return kWords[static_cast<std::size_t>(std::ranges::find(kKeys, key) - kKeys.begin())];
}

std::optional<AtlasQuery::Number> NumberOf(ListKey key) {
  using enum AtlasQuery::Number;
  switch (key) {
    case ListKey::kMaps:
      return kMaps;
    case ListKey::kKeyframes:
      return kKeyframes;
    case ListKey::kPoints:
      return kPoints;
    case ListKey::kObservations:
      return kObservations;
    case ListKey::kLandmarks:
      return kLandmarks;
    case ListKey::kLength:
      return kLength;
    case ListKey::kSpan:
      return kDuration;
    case ListKey::kSize:
      return kBytes;
    case ListKey::kRevision:
      return kRevision;
    default:
      return std::nullopt;
  }
}

SortKey SortKeyOf(std::string_view word) {
  const bool descending = word.starts_with('-');
  const auto found = std::ranges::find(kWords, word.substr(descending ? 1 : 0));
  if (found != kWords.end()) return {kKeys[static_cast<std::size_t>(found - kWords.begin())], descending};
  std::string known;
  for (const std::string_view each : kWords) known.append(known.empty() ? "" : ", ").append(each);
  throw Error(ErrorKind::kUsage, "'" + std::string(word) + "' is none of " + known);
}

void SortAtlases(std::vector<ListedAtlas>& atlases, std::span<const SortKey> keys) {
  if (keys.empty()) return;
  std::ranges::stable_sort(atlases, [&](const ListedAtlas& a, const ListedAtlas& b) {
    for (const SortKey& key : keys)
      if (const auto order = Compare(a, b, key); order != 0) return order < 0;
    return false;
  });
}

}  // namespace slamdb
