// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/row_hash.h"

#include <string_view>

#include "slamdb/base/detail/hash.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/formats/sqlite/detail/keyframe_blob.h"
#include "slamdb/formats/sqlite/detail/landmark_blob.h"
#include "slamdb/formats/sqlite/detail/packing.h"

namespace slamdb::sqlite {
namespace {

void PutText(ByteWriter& out, std::string_view text) {
  out.Put(static_cast<std::uint64_t>(text.size()));
  out.PutBytes(std::as_bytes(std::span(text)));
}

void PutRepeated(ByteWriter& out, const std::vector<RepeatedEntry>& entries) {
  out.Put(static_cast<std::uint64_t>(entries.size()));
  for (const RepeatedEntry& entry : entries) {
    out.Put(entry.position);
    out.Put(entry.owner_map);
    out.Put(entry.row);
  }
}

std::int64_t HashOfBytes(const ByteWriter& out) { return static_cast<std::int64_t>(ContentHash(out.bytes())); }

void AddGrid(Hasher& hasher, const FeatureGrid& grid) {
  hasher.AddVector(grid.column_sizes);
  hasher.AddVector(grid.cell_sizes);
  hasher.AddVector(grid.keypoints);
}

}  // namespace

void Hasher::Add(Bytes bytes) {
  state_ = ContentHash(bytes, state_ * 0x9E3779B97F4A7C15u + static_cast<std::uint64_t>(bytes.size()));
}

std::int64_t HashOfAtlasHeader(const Atlas& atlas) {
  ByteWriter out;
  PutText(out, atlas.vocabulary.name);
  PutText(out, atlas.vocabulary.checksum);
  const Counters& next = atlas.next_ids;
  for (const std::uint64_t value :
       {next.map, next.frame, next.keyframe, next.map_point, next.camera, next.initial_keyframe}) {
    out.Put(value);
  }
  out.Put(static_cast<std::uint8_t>(atlas.encoding.text));
  out.Put(atlas.encoding.boost_version);
  out.Put(atlas.encoding.long_bytes);
  out.Put(atlas.encoding.size_bytes);
  PutRepeated(out, atlas.repeated_maps);
  PutRepeated(out, atlas.repeated_cameras);
  return HashOfBytes(out);
}

std::int64_t HashOf(const Camera& camera) {
  ByteWriter out;
  out.Put(camera.id.value());
  out.Put(static_cast<std::uint32_t>(camera.model));
  out.Put(camera.recorded_type);
  out.PutVector(camera.parameters);
  out.Put(camera.precision);
  return HashOfBytes(out);
}

std::int64_t HashOfHeader(const Map& map) {
  ByteWriter out;
  out.Put(map.id.value());
  out.Put(map.initial_keyframe.value());
  out.Put(map.max_keyframe_id);
  out.Put(map.big_change_index);
  PutRepeated(out, map.repeated_keyframes);
  PutRepeated(out, map.repeated_points);
  out.PutVector(map.origins);
  out.Put(map.first_keyframe.value());
  out.Put(map.lowest_keyframe.value());
  for (const Flag flag : {map.imu_initialized, map.inertial, map.imu_ba1, map.imu_ba2}) out.Put(flag.recorded);
  return HashOfBytes(out);
}

std::int64_t HashOfRow(const KeyFrame& keyframe) {
  thread_local ByteWriter out;
  out.Clear();
  out.Put(keyframe.id.value());
  out.Put(keyframe.frame_id);
  out.Put(keyframe.timestamp);
  const KeyframeReals reals = RealsOf(keyframe);
  out.PutBytes(std::as_bytes(std::span(reals)));
  out.Put(keyframe.camera.value());
  out.Put(keyframe.right_camera.value());
  for (const KeyFrameId id : {keyframe.parent, keyframe.previous, keyframe.next}) out.Put(id.value());
  out.Put(keyframe.origin_map);
  const Features& features = keyframe.features;
  for (const std::int32_t count : {features.count, features.left_count, features.right_count}) out.Put(count);
  for (const Flag flag : {keyframe.first_connection, keyframe.not_erase, keyframe.to_be_erased, keyframe.bad,
                          keyframe.imu_initialized, keyframe.has_velocity}) {
    out.Put(flag.recorded);
  }
  EncodeDetails(keyframe, out);
  return HashOfBytes(out);
}

std::int64_t HashOfLinks(const KeyFrame& keyframe) {
  thread_local ByteWriter out;
  out.Clear();
  out.Put(static_cast<std::uint64_t>(keyframe.connections.size()));
  for (const Connection& connection : keyframe.connections) {
    out.Put(connection.keyframe.value());
    out.Put(connection.weight);
  }
  out.PutVector(keyframe.children);
  out.PutVector(keyframe.loop_edges);
  out.PutVector(keyframe.merge_edges);
  return HashOfBytes(out);
}

std::int64_t HashOf(const Features& features) {
  Hasher hasher;
  hasher.AddVector(features.keypoints);
  hasher.AddVector(features.undistorted);
  hasher.AddVector(features.right_x);
  hasher.AddVector(features.depth);
  hasher.AddVector(features.descriptors);
  hasher.Add(std::as_bytes(std::span(&features.descriptors_form, 1)));
  hasher.AddVector(features.map_points);
  hasher.AddVector(features.right_keypoints);
  hasher.AddVector(features.right_of_left);
  hasher.AddVector(features.left_of_right);
  AddGrid(hasher, features.grid);
  AddGrid(hasher, features.right_grid);
  hasher.AddVector(features.bag_of_words.words);
  hasher.AddVector(features.bag_of_words.weights);
  hasher.AddVector(features.feature_vector.nodes);
  hasher.AddVector(features.feature_vector.sizes);
  hasher.AddVector(features.feature_vector.features);
  return hasher.value();
}

std::int64_t HashOfRow(const MapPoint& point) {
  thread_local ByteWriter out;
  out.Clear();
  out.Put(point.id.value());
  out.Put(point.first_keyframe);
  out.Put(point.first_frame);
  out.Put(point.observation_count);
  out.PutBytes(std::as_bytes(std::span(point.position.data(), 3)));
  out.PutBytes(std::as_bytes(std::span(point.normal.data(), 3)));
  out.PutBytes(std::as_bytes(std::span(point.descriptor)));
  out.Put(static_cast<std::uint8_t>(point.descriptor_form));
  out.Put(point.bad.recorded);
  out.Put(point.reference.value());
  out.Put(point.replaced_by.value());
  out.Put(point.min_distance);
  out.Put(point.max_distance);
  return HashOfBytes(out);
}

std::int64_t HashOf(const Column<Observation>& observations) {
  return static_cast<std::int64_t>(ContentHash(std::as_bytes(std::span(observations.data(), observations.size()))));
}

std::int64_t HashOf(const Landmark& landmark) {
  thread_local ByteWriter out;
  out.Clear();
  out.Put(landmark.id.value());
  out.PutBytes(std::as_bytes(std::span(landmark.mean.data(), 3)));
  out.PutBytes(std::as_bytes(std::span(landmark.normal.data(), 3)));
  for (const double value :
       {landmark.cov_11, landmark.cov_22, landmark.cov_33, landmark.cov_12, landmark.cov_13, landmark.cov_23})
    out.Put(value);
  out.Put(landmark.last_seen);
  out.Put(landmark.seen_count);
  EncodeLandmarkFeatures(landmark.features, out);
  return HashOfBytes(out);
}

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
  AtlasHashes hashes;
  hashes.header = HashOfAtlasHeader(atlas);
  for (const Camera& camera : atlas.cameras) hashes.cameras.push_back(HashOf(camera));
  for (const Map& map : atlas.maps) {
    AtlasHashes::OfMap& of = hashes.maps.emplace_back();
    of.header = HashOfHeader(map);
    for (auto* list : {&of.keyframes, &of.links, &of.features}) list->resize(map.keyframes.size());
    ParallelFor(map.keyframes.size(), 8, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const KeyFrame& keyframe = map.keyframes[i];
        of.keyframes[i] = HashOfRow(keyframe);
        of.links[i] = HashOfLinks(keyframe);
        of.features[i] = HashOf(keyframe.features);
      }
    });
    for (auto* list : {&of.points, &of.observations}) list->resize(map.points.size());
    ParallelFor(map.points.size(), 4096, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        of.points[i] = HashOfRow(map.points[i]);
        of.observations[i] = HashOf(map.points[i].observations);
      }
    });
    of.landmarks.resize(map.landmarks.size());
    ParallelFor(map.landmarks.size(), 4096, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) of.landmarks[i] = HashOf(map.landmarks[i]);
    });
  }
  return hashes;
}

}  // namespace slamdb::sqlite
