// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <bit>
#include <string>
#include <unordered_map>

#include "tests/formats/orbslam3/meaning.h"

namespace slamdb {
namespace {

using nlohmann::json;

template <class Entity>
std::vector<const Entity*> ById(const Column<Entity>& column) {
  std::vector<const Entity*> sorted;
  for (const Entity& entity : column) sorted.push_back(&entity);
  std::stable_sort(sorted.begin(), sorted.end(), [](const Entity* a, const Entity* b) { return a->id < b->id; });
  return sorted;
}

std::uint64_t Bits(const Eigen::Vector3f& v) {
  std::uint64_t sum = 0;
  for (unsigned i = 0; i < 3; ++i) sum += std::uint64_t{std::bit_cast<std::uint32_t>(v[i])} * (2 * i + 1);
  return sum;
}

template <class Range>
std::uint64_t WeightedBytes(const Range& bytes, std::uint64_t first) {
  std::uint64_t sum = 0;
  for (const std::uint8_t byte : bytes) sum += first++ * byte;
  return sum;
}

json AsList(const Eigen::Vector3d& v) { return {v[0], v[1], v[2]}; }
json AsIds(const std::vector<KeyFrameId>& ids) {
  json list = json::array();
  for (const KeyFrameId id : ids) list.push_back(id.value());
  return list;
}

void MapSums(const Map& map, json& sums) {
  sums["id"] = map.id.value();
  sums["init_kf_id"] = map.initial_keyframe.value();
  sums["max_kf_id"] = map.max_keyframe_id;
  sums["big_change_idx"] = map.big_change_index;
  sums["imu_initialized"] = static_cast<bool>(map.imu_initialized);
  sums["is_inertial"] = static_cast<bool>(map.inertial);
  sums["imu_ba1"] = static_cast<bool>(map.imu_ba1);
  sums["imu_ba2"] = static_cast<bool>(map.imu_ba2);
  sums["n_kf"] = map.keyframes.size();
  sums["n_mp"] = map.points.size();
  sums["origins"] = AsIds(map.origins);
  const auto loaded = [&](KeyFrameId id) {
    const bool found = std::any_of(map.keyframes.begin(), map.keyframes.end(),
                                   [&](const KeyFrame& keyframe) { return keyframe.id == id; });
    return found ? static_cast<std::int64_t>(id.value()) : -1;
  };
  sums["kf_initial_id"] = loaded(map.first_keyframe);
  sums["kf_lower_id"] = loaded(map.lowest_keyframe);
}

// ORB-SLAM3 normalises rotations when it loads them.
void LoadedPoseSums(const std::vector<const KeyFrame*>& keyframes, json& sums) {
  Eigen::Vector4d rotation = Eigen::Vector4d::Zero();
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const KeyFrame* keyframe : keyframes) {
    const Rigid3f pose = keyframe->camera_from_world.Normalized();
    rotation += Eigen::Vector4d(pose.rotation.w(), pose.rotation.x(), pose.rotation.y(), pose.rotation.z());
    center += pose.Center().cast<double>();
  }
  sums["kf_tcw_q_wxyz_sum"] = {rotation[0], rotation[1], rotation[2], rotation[3]};
  sums["kf_ow_sum"] = AsList(center);
}

void PoseSums(const std::vector<const KeyFrame*>& keyframes, json& sums) {
  std::uint64_t id_sum = 0, id_xor = 0, frames = 0, bits = 0;
  double time = 0;
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  for (const KeyFrame* keyframe : keyframes) {
    id_sum += keyframe->id.value();
    id_xor ^= keyframe->id.value();
    frames += keyframe->frame_id;
    time += keyframe->timestamp;
    translation += keyframe->camera_from_world.translation.cast<double>();
    bits += (keyframe->id.value() + 1) * Bits(keyframe->camera_from_world.translation);
  }
  sums["kf_id_sum"] = id_sum;
  sums["kf_id_xor"] = id_xor;
  sums["frame_id_sum"] = frames;
  sums["kf_timestamp_sum"] = time;
  sums["kf_tcw_t_sum"] = AsList(translation);
  sums["kf_tcw_t_bits"] = bits;
}

void PointSums(const std::vector<const MapPoint*>& points, json& sums) {
  std::uint64_t id_sum = 0, id_xor = 0, bits = 0, descriptors = 0;
  std::int64_t recorded_observations = 0, without_reference = 0;
  double nearest = 0, farthest = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::Zero();
  for (const MapPoint* point : points) {
    const std::uint64_t id = point->id.value();
    id_sum += id;
    id_xor ^= id;
    bits += (id + 1) * Bits(point->position);
    position += point->position.cast<double>();
    normal += point->normal.cast<double>();
    nearest += static_cast<double>(point->min_distance);
    farthest += static_cast<double>(point->max_distance);
    if (point->has_descriptor()) descriptors += (id + 1) * WeightedBytes(point->descriptor, 1);
    recorded_observations += point->observation_count;
    without_reference += point->bad ? 1 : 0;
  }
  sums["mp_id_sum"] = id_sum;
  sums["mp_id_xor"] = id_xor;
  sums["mp_pos_bits"] = bits;
  sums["mp_pos_sum"] = AsList(position);
  sums["mp_normal_sum"] = AsList(normal);
  sums["mp_mindist_sum"] = nearest;
  sums["mp_maxdist_sum"] = farthest;
  sums["mp_desc_hash"] = descriptors;
  sums["mp_nObs_sum"] = recorded_observations;
  sums["null_after_postload"]["mp_ref_kf"] = without_reference;
}

void ObservationSums(const std::vector<const MapPoint*>& points, json& sums) {
  std::uint64_t count = 0, left_sum = 0, right_sum = 0, hash = 0, without = 0;
  for (const MapPoint* point : points) {
    const std::size_t observations = point->bad ? 0 : point->observations.size();
    count += observations;
    without += observations == 0 ? 1 : 0;
    for (std::size_t i = 0; i < observations; ++i) {
      const Observation& observation = point->observations[i];
      const std::uint64_t keyframe = observation.keyframe.value();
      const auto left = static_cast<std::uint64_t>(observation.left),
                 right = static_cast<std::uint64_t>(observation.right);
      if (observation.left >= 0) left_sum += keyframe * left;
      if (observation.right >= 0) right_sum += keyframe * right;
      hash += (point->id.value() + 1) * (keyframe + 1) * (left + 2);
      hash += 7 * (point->id.value() + 1) * (keyframe + 3) * (right + 2);
    }
  }
  sums["obs_count"] = count;
  sums["mp_zero_obs"] = without;
  sums["obs_kfid_x_idx_left"] = left_sum;
  sums["obs_kfid_x_idx_right"] = right_sum;
  sums["obs_hash"] = hash;
}

void KeypointSums(const std::vector<const KeyFrame*>& keyframes, const std::string& name,
                  const Column<Keypoint> Features::*column, json& sums) {
  std::uint64_t count = 0;
  double x = 0, y = 0, response = 0, angle = 0;
  std::int64_t octaves = 0;
  for (const KeyFrame* keyframe : keyframes) {
    count += (keyframe->features.*column).size();
    for (const Keypoint& keypoint : keyframe->features.*column) {
      x += static_cast<double>(keypoint.x);
      y += static_cast<double>(keypoint.y);
      response += static_cast<double>(keypoint.response);
      angle += static_cast<double>(keypoint.angle);
      octaves += keypoint.octave;
    }
  }
  sums[name] = count;
  sums[name + "_x_sum"] = x;
  sums[name + "_y_sum"] = y;
  if (name != "mvKeys") return;
  sums["mvKeys_response_sum"] = response;
  sums["mvKeys_angle_sum"] = angle;
  sums["mvKeys_octave_sum"] = octaves;
}

void DescriptorSums(const std::vector<const KeyFrame*>& keyframes, json& sums) {
  std::uint64_t bytes = 0, hash = 0;
  std::int64_t features = 0;
  double right = 0, depth = 0;
  for (const KeyFrame* keyframe : keyframes) {
    features += keyframe->features.count;
    for (const float value : keyframe->features.right_x) right += static_cast<double>(value);
    for (const float value : keyframe->features.depth) depth += static_cast<double>(value);
    std::uint64_t first = 1, weighted = 0;
    for (const Descriptor& descriptor : keyframe->features.descriptors) {
      for (const std::uint8_t byte : descriptor) bytes += byte;
      weighted += WeightedBytes(descriptor, first);
      first += descriptor.size();
    }
    hash += (keyframe->id.value() + 1) * weighted;
  }
  sums["keypoints_N_sum"] = features;
  sums["mvuRight_sum"] = right;
  sums["mvDepth_sum"] = depth;
  sums["desc_byte_sum"] = bytes;
  sums["desc_hash"] = hash;
}

void WordSums(const std::vector<const KeyFrame*>& keyframes, json& sums) {
  std::uint64_t words = 0, word_hash = 0, entries = 0, entry_hash = 0;
  double weight = 0;
  for (const KeyFrame* keyframe : keyframes) {
    const std::uint64_t factor = keyframe->id.value() + 1;
    const BagOfWords& bag = keyframe->features.bag_of_words;
    words += bag.words.size();
    for (const std::uint32_t word : bag.words) word_hash += factor * (std::uint64_t{word} + 1);
    for (const double value : bag.weights) weight += value;
    const FeatureVector& vector = keyframe->features.feature_vector;
    entries += vector.features.size();
    for (std::size_t node = 0, next = 0; node < vector.nodes.size(); ++node)
      for (const std::size_t end = next + vector.sizes[node]; next < end; ++next)
        entry_hash += factor * (std::uint64_t{vector.nodes[node]} + 1) * (std::uint64_t{vector.features[next]} + 1);
  }
  sums["bow_words"] = words;
  sums["bow_weight_sum"] = weight;
  sums["bow_hash"] = word_hash;
  sums["featvec_entries"] = entries;
  sums["featvec_hash"] = entry_hash;
}

void MatchSums(const Map& map, const std::vector<const KeyFrame*>& keyframes, json& sums) {
  std::unordered_map<MapPointId, bool> good;
  for (const MapPoint& point : map.points) good[point.id] = !point.bad;
  std::uint64_t filled = 0, hash = 0, lost = 0;
  for (const KeyFrame* keyframe : keyframes) {
    std::uint64_t row = 0;
    for (const MapPointId point : keyframe->features.map_points) {
      ++row;
      if (!point) continue;
      const auto found = good.find(point);
      const bool loaded = found != good.end() && found->second;
      lost += loaded ? 0 : 1;
      if (!loaded) continue;
      ++filled;
      hash += (keyframe->id.value() + 1) * row * (point.value() + 1);
    }
  }
  sums["kf_slots_filled"] = filled;
  sums["kf_slot_hash"] = hash;
  sums["null_after_postload"]["kf_slot_mp"] = lost;
}

void GraphSums(const std::vector<const KeyFrame*>& keyframes, json& sums) {
  std::uint64_t edges = 0, hash = 0, parents = 0, roots = 0, children = 0, loops = 0, merges = 0, previous = 0,
                next = 0;
  std::int64_t weight = 0;
  for (const KeyFrame* keyframe : keyframes) {
    const std::uint64_t factor = keyframe->id.value() + 1;
    edges += keyframe->connections.size();
    for (const Connection& connection : keyframe->connections) {
      weight += connection.weight;
      hash += factor * (connection.keyframe.value() + 1) * static_cast<std::uint64_t>(connection.weight);
    }
    if (keyframe->parent) parents += factor * (keyframe->parent.value() + 1);
    roots += keyframe->parent ? 0 : 1;
    children += keyframe->children.size();
    loops += keyframe->loop_edges.size();
    merges += keyframe->merge_edges.size();
    previous += keyframe->previous ? 1 : 0;
    next += keyframe->next ? 1 : 0;
  }
  sums["cov_edges_directed"] = edges;
  sums["cov_weight_sum"] = weight;
  sums["cov_hash"] = hash;
  sums["parent_hash"] = parents;
  sums["kf_without_parent"] = roots;
  sums["children"] = children;
  sums["loop_edges_directed"] = loops;
  sums["merge_edges_directed"] = merges;
  sums["prev_links"] = previous;
  sums["next_links"] = next;
}

void InertialSums(const std::vector<const KeyFrame*>& keyframes, json& sums) {
  std::uint64_t measurements = 0;
  double duration = 0, measured = 0, bias = 0, velocity = 0;
  for (const KeyFrame* keyframe : keyframes) {
    const ImuPreintegration& imu = keyframe->preintegration;
    if (!imu.measurements.empty()) duration += static_cast<double>(imu.duration);  // else it is uninitialised
    measurements += imu.measurements.size();
    for (const ImuMeasurement& measurement : imu.measurements) measured += static_cast<double>(measurement.duration);
    bias += static_cast<double>(keyframe->imu_bias.accelerometer.x());
    for (const float value : keyframe->velocity) velocity += static_cast<double>(value);
  }
  sums["imu_dT_sum"] = duration;
  sums["imu_measurements"] = measurements;
  sums["imu_meas_t_sum"] = measured;
  sums["bias_bax_sum"] = bias;
  sums["velocity_sum"] = velocity;
}

}  // namespace

nlohmann::json Sums(const Map& map) {
  const std::vector<const KeyFrame*> keyframes = ById(map.keyframes);
  const std::vector<const MapPoint*> points = ById(map.points);
  json sums;
  MapSums(map, sums);
  PoseSums(keyframes, sums);
  LoadedPoseSums(keyframes, sums);
  PointSums(points, sums);
  ObservationSums(points, sums);
  KeypointSums(keyframes, "mvKeys", &Features::keypoints, sums);
  KeypointSums(keyframes, "mvKeysUn", &Features::undistorted, sums);
  KeypointSums(keyframes, "mvKeysRight", &Features::right_keypoints, sums);
  DescriptorSums(keyframes, sums);
  WordSums(keyframes, sums);
  MatchSums(map, keyframes, sums);
  GraphSums(keyframes, sums);
  InertialSums(keyframes, sums);
  return sums;
}

}  // namespace slamdb
