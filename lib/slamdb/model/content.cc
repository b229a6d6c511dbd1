// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/content.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <functional>
#include <mutex>
#include <span>

#include "slamdb/base/detail/hash.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/model/detail/record.h"
#include "slamdb/model/detail/record_codec.h"

namespace slamdb {
namespace {

constexpr std::size_t kKeyFrameGrain = 16, kPointGrain = 4096;

constexpr std::uint64_t ContentCounts::*kFields[] = {
    &ContentCounts::maps,           &ContentCounts::cameras,     &ContentCounts::keyframes,
    &ContentCounts::points,         &ContentCounts::features,    &ContentCounts::observations,
    &ContentCounts::slots,          &ContentCounts::connections, &ContentCounts::parents,
    &ContentCounts::children,       &ContentCounts::loop_edges,  &ContentCounts::merge_edges,
    &ContentCounts::temporal_links, &ContentCounts::references,  &ContentCounts::landmarks,
};
static_assert(sizeof(kFields) / sizeof(kFields[0]) == sizeof(ContentCounts) / sizeof(std::uint64_t));

void Count(const KeyFrame& keyframe, ContentCounts& counts) {
  ++counts.keyframes;
  counts.features += keyframe.features.descriptors.size();
  counts.slots += static_cast<std::uint64_t>(
      std::ranges::count_if(keyframe.features.map_points, [](MapPointId id) { return id.has_value(); }));
  counts.connections += keyframe.connections.size();
  counts.parents += keyframe.parent.has_value();
  counts.children += keyframe.children.size();
  counts.loop_edges += keyframe.loop_edges.size();
  counts.merge_edges += keyframe.merge_edges.size();
  counts.temporal_links += std::uint64_t{keyframe.previous.has_value()} + keyframe.next.has_value();
}

void Count(const MapPoint& point, ContentCounts& counts) {
  ++counts.points;
  counts.observations += point.observations.size();
  counts.references += point.reference.has_value();
}

// The sum of each(entity) over a list, whatever the order.
template <class Sum, class List, class Each>
Sum SumOver(const List& list, std::size_t grain, int threads, const Each& each) {
  Sum total{};
  std::mutex mutex;
  detail::ParallelFor(list.size(), grain, threads, [&](std::size_t begin, std::size_t end) {
    Sum sum{};
    for (std::size_t row = begin; row < end; ++row) each(list[row], sum);
    const std::lock_guard lock(mutex);
    total += sum;
  });
  return total;
}

template <class List>
std::uint64_t HashOf(const List& list, std::uint64_t seed) {
  return detail::HashBytes(std::as_bytes(std::span(list)), seed);
}

std::uint64_t HashOf(const KeyFrame& keyframe) {
  const Features& features = keyframe.features;
  const Eigen::Vector3f center = keyframe.camera_from_world.translation;
  std::uint64_t hash = std::bit_cast<std::uint64_t>(keyframe.timestamp);
  hash = HashOf(std::span(center.data(), 3), hash);
  hash = HashOf(features.keypoints, hash);
  hash = HashOf(features.right_keypoints, hash);
  return HashOf(features.descriptors, hash);
}

std::uint64_t HashOf(const MapPoint& point) {
  const std::uint64_t hash = HashOf(std::span(point.position.data(), 3), 0);
  return HashOf(point.descriptor, hash);
}

}  // namespace

ContentCounts& ContentCounts::operator+=(const ContentCounts& other) {
  for (const auto field : kFields) this->*field += other.*field;
  return *this;
}

ContentCounts& ContentCounts::operator-=(const ContentCounts& other) {
  for (const auto field : kFields) this->*field -= other.*field;
  return *this;
}

ContentCounts CountContent(const Map& map, int threads) {
  ContentCounts counts{.maps = 1, .landmarks = map.landmarks.size()};
  const auto count = [](const auto& entity, ContentCounts& sum) { Count(entity, sum); };
  counts += SumOver<ContentCounts>(map.keyframes, kKeyFrameGrain, threads, count);
  counts += SumOver<ContentCounts>(map.points, kPointGrain, threads, count);
  return counts;
}

ContentCounts CountContent(const Atlas& atlas, int threads) {
  ContentCounts counts{.cameras = atlas.cameras.size()};
  for (const Map& map : atlas.maps) counts += CountContent(map, threads);
  return counts;
}

std::string_view Substance::Lacks() const {
  if (landmarks) return {};
  return !maps ? "maps" : !keyframes ? "keyframes" : !points ? "points" : "";
}

Substance& Substance::operator|=(const Substance& other) {
  maps |= other.maps;
  keyframes |= other.keyframes;
  points |= other.points;
  landmarks |= other.landmarks;
  return *this;
}

Substance SubstanceOf(const Atlas& atlas, bool with_bad) {
  const auto counts = [with_bad](const auto& entity) { return with_bad || !entity.bad; };
  Substance substance{.maps = !atlas.maps.empty()};
  for (const Map& map : atlas.maps) {
    substance.keyframes |= std::ranges::any_of(map.keyframes, counts);
    substance.points |= std::ranges::any_of(map.points, counts);
    substance.landmarks |= !map.landmarks.empty();
  }
  return substance;
}

ContentSignature SignatureOf(const Map& map) {
  ContentSignature signature{
      .keyframes = map.keyframes.size(), .points = map.points.size(), .landmarks = map.landmarks.size()};
  for (const KeyFrame& keyframe : map.keyframes) {
    signature.features += keyframe.features.descriptors.size();
    signature.timestamps += std::bit_cast<std::uint64_t>(keyframe.timestamp);
  }
  return signature;
}

std::uint64_t ContentHash(const Landmark& landmark) {
  detail::ByteWriter bytes;
  detail::RecordWriter writer(bytes);
  ForEachField(&landmark, [&](std::string_view, auto member) {
    using Field = std::remove_cvref_t<decltype(landmark.*member)>;
    if constexpr (!std::is_same_v<Field, LandmarkId>) writer.Field(landmark.*member);
  });
  return detail::HashBytes(bytes.bytes());
}

std::uint64_t ContentHash(const Map& map, int threads) {
  const auto hash = [](const auto& entity, std::uint64_t& sum) { sum += HashOf(entity); };
  return SumOver<std::uint64_t>(map.keyframes, kKeyFrameGrain, threads, hash) * 3 +
         SumOver<std::uint64_t>(map.points, kPointGrain, threads, hash) +
         SumOver<std::uint64_t>(map.landmarks, kPointGrain, threads,
                                [](const Landmark& landmark, std::uint64_t& sum) { sum += ContentHash(landmark); });
}

}  // namespace slamdb
