// SPDX-License-Identifier: BSD-3-Clause
// Stores and journals hold hashes that earlier versions computed: what is hashed, and in which order, must stay.
// What was not recorded when they were made is hashed only where it is there.
#include "slamdb/model/digest.h"

#include "slamdb/base/detail/hash.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/model/detail/record.h"
#include "slamdb/model/detail/record_codec.h"
#include "slamdb/model/detail/row_hash.h"

namespace slamdb {
namespace detail {
namespace {

// Chains hashes of byte ranges, their lengths included.
class Hasher {
 public:
  void Add(Bytes bytes) {
    state_ = detail::HashBytes(bytes, state_ * 0x9E3779B97F4A7C15u + static_cast<std::uint64_t>(bytes.size()));
  }
  template <class Vector>
  void AddVector(const Vector& values) {
    Add(std::as_bytes(std::span(values.data(), values.size())));
  }
  std::int64_t value() const { return static_cast<std::int64_t>(state_); }

 private:
  std::uint64_t state_ = 0;
};

// The hash of what write(writer) writes.
template <class Write>
std::int64_t HashOfRecord(const Write& write) {
  thread_local ByteWriter bytes;
  bytes.Clear();
  RecordWriter writer(bytes);
  write(writer, bytes);
  return static_cast<std::int64_t>(detail::HashBytes(bytes.bytes()));
}

template <class Entity>
std::int64_t HashOfFields(const Entity& entity) {
  return HashOfRecord([&](RecordWriter& writer, ByteWriter&) { ForEachField(&entity, EachTo(writer, entity)); });
}

}  // namespace

std::int64_t HashOfAtlasHeader(const Atlas& atlas, const ArchiveEncoding& encoding) {
  return HashOfRecord([&](RecordWriter& writer, ByteWriter&) {
    fields::ForEachHeadField(EachTo(writer, atlas));
    fields::ForEachEncodingField([&](std::string_view, auto, auto member) { writer.Field(Member(encoding, member)); });
    fields::ForEachRepeatedField(EachTo(writer, atlas));
    if (!atlas.layout.empty() || atlas.carried) fields::ForEachForkField(EachTo(writer, atlas));
  });
}

std::int64_t HashOf(const Camera& camera) { return HashOfFields(camera); }

std::int64_t HashOfHeader(const Map& map) { return HashOfFields(map); }

std::int64_t HashOfRow(const KeyFrame& keyframe) {
  return HashOfRecord([&](RecordWriter& writer, ByteWriter& bytes) {
    writer.Field(keyframe.id);
    writer.Field(keyframe.frame_id);
    writer.Field(keyframe.timestamp);
    for (const float real : RealsOf(keyframe)) writer.Field(real);
    for (const CameraId id : {keyframe.camera, keyframe.right_camera}) writer.Field(id);
    for (const KeyFrameId id : {keyframe.parent, keyframe.previous, keyframe.next}) writer.Field(id);
    writer.Field(keyframe.origin_map);
    const Features& features = keyframe.features;
    for (const std::int32_t count : {features.count, features.left_count, features.right_count}) writer.Field(count);
    for (const Flag flag : {keyframe.first_connection, keyframe.not_erase, keyframe.to_be_erased, keyframe.bad,
                            keyframe.imu_initialized, keyframe.has_velocity})
      writer.Field(flag);
    EncodeDetails(keyframe, bytes);
    writer.Field(keyframe.carried);
  });
}

std::int64_t HashOfLinks(const KeyFrame& keyframe) {
  return HashOfRecord([&](RecordWriter& writer, ByteWriter&) {
    writer.Field(static_cast<std::uint64_t>(keyframe.connections.size()));
    for (const Connection& connection : keyframe.connections) {
      writer.Field(connection.keyframe);
      writer.Field(connection.weight);
    }
    for (const auto* list : {&keyframe.children, &keyframe.loop_edges, &keyframe.merge_edges}) writer.Field(*list);
  });
}

std::int64_t HashOfFeatures(const KeyFrame& keyframe) {
  Hasher hasher;
  const auto add = [&](std::string_view, auto... members) {
    const auto& field = Member(keyframe, members...);
    using Field = std::remove_cvref_t<decltype(field)>;
    if constexpr (std::is_same_v<Field, MatrixForm>) {
      hasher.Add(std::as_bytes(std::span(&field, 1)));
    } else if constexpr (!std::is_same_v<Field, std::int32_t>) {  // the counts are of the keyframe's row
      hasher.AddVector(field);
    }
  };
  fields::ForEachFeatureField(add);
  fields::ForEachWordField(add);
  return hasher.value();
}

std::int64_t HashOfRow(const MapPoint& point) {
  return HashOfRecord([&](RecordWriter& writer, ByteWriter&) {
    const auto each = EachTo(writer, point);
    fields::ForEachArchivedPointField([&](std::string_view name, auto member) {
      if constexpr (!std::is_same_v<decltype(member), Column<Observation> MapPoint::*>) each(name, member);
    });
    if (point.has_tracking()) fields::ForEachTrackingField(each);
    writer.Field(point.carried);
  });
}

std::int64_t HashOf(const Column<Observation>& observations) {
  return static_cast<std::int64_t>(
      detail::HashBytes(std::as_bytes(std::span(observations.data(), observations.size()))));
}

std::int64_t HashOf(const Landmark& landmark) { return HashOfFields(landmark); }

std::int64_t AtlasHashes::Combined() const {
  Hasher hasher;
  hasher.Add(std::as_bytes(std::span(&header, 1)));
  hasher.AddVector(cameras);
  for (const OfMap& map : maps) {
    hasher.Add(std::as_bytes(std::span(&map.header, 1)));
    for (const auto* list : {&map.keyframes, &map.links, &map.features, &map.points, &map.observations}) {
      hasher.AddVector(*list);
    }
    if (!map.landmarks.empty()) hasher.AddVector(map.landmarks);  // so that older hashes stay what they are
  }
  return hasher.value();
}

AtlasHashes HashesOf(const Atlas& atlas, int threads) {
  constexpr std::size_t kKeyFrameGrain = 8, kPointGrain = 4096;
  AtlasHashes hashes;
  hashes.header = HashOfAtlasHeader(atlas, atlas.encoding);
  for (const Camera& camera : atlas.cameras) hashes.cameras.push_back(HashOf(camera));
  for (const Map& map : atlas.maps) {
    AtlasHashes::OfMap& of = hashes.maps.emplace_back();
    of.header = HashOfHeader(map);
    for (auto* list : {&of.keyframes, &of.links, &of.features}) list->resize(map.keyframes.size());
    detail::ParallelFor(map.keyframes.size(), kKeyFrameGrain, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const KeyFrame& keyframe = map.keyframes[i];
        of.keyframes[i] = HashOfRow(keyframe);
        of.links[i] = HashOfLinks(keyframe);
        of.features[i] = HashOfFeatures(keyframe);
      }
    });
    for (auto* list : {&of.points, &of.observations}) list->resize(map.points.size());
    detail::ParallelFor(map.points.size(), kPointGrain, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        of.points[i] = HashOfRow(map.points[i]);
        of.observations[i] = HashOf(map.points[i].observations);
      }
    });
    of.landmarks.resize(map.landmarks.size());
    detail::ParallelFor(map.landmarks.size(), kPointGrain, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) of.landmarks[i] = HashOf(map.landmarks[i]);
    });
  }
  return hashes;
}

}  // namespace detail

std::uint64_t HashOf(const Atlas& atlas, int threads) {
  return static_cast<std::uint64_t>(detail::HashesOf(atlas, threads).Combined());
}

std::uint64_t HashWithoutEncoding(const Atlas& atlas, int threads) {
  detail::AtlasHashes hashes = detail::HashesOf(atlas, threads);
  hashes.header = detail::HashOfAtlasHeader(atlas, ArchiveEncoding());
  return static_cast<std::uint64_t>(hashes.Combined());
}

}  // namespace slamdb
