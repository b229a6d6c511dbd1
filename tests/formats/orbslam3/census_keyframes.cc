// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <set>

#include "tests/formats/orbslam3/census.h"

namespace slamdb {
namespace {

void CensusMatches(const CensusLookup& lookup, const KeyFrame& keyframe, CensusCounts& counts) {
  const Features& features = keyframe.features;
  counts["kf_mpid_vector_size_not_N"] += features.map_points.size() == static_cast<std::size_t>(features.count) ? 0 : 1;
  std::map<MapPointId, int> seen;
  for (std::size_t row = 0; row < features.map_points.size(); ++row) {
    const MapPointId id = features.map_points[row];
    if (!id) continue;
    counts["kf_same_mp_in_two_slots"] += seen[id]++ > 0 ? 1 : 0;
    const MapPoint* point = lookup.Find(id);
    counts["kf_slot_mp_not_in_map"] += point ? 0 : 1;
    if (!point) continue;
    counts["kf_slot_mp_bad"] += point->bad ? 1 : 0;
    const auto wanted = static_cast<std::int32_t>(row);
    const bool observed = std::any_of(
        point->observations.begin(), point->observations.end(),
        [&](const Observation& o) { return o.keyframe == keyframe.id && (o.left == wanted || o.right == wanted); });
    counts["kf_slot_mp_lacks_observation"] += observed ? 0 : 1;
  }
}

const Connection* FindConnection(const KeyFrame& keyframe, KeyFrameId other) {
  for (const Connection& connection : keyframe.connections)
    if (connection.keyframe == other) return &connection;
  return nullptr;
}

void CensusCovisibility(const CensusLookup& lookup, const KeyFrame& keyframe,
                        std::map<KeyFrameId, std::int32_t>& shared, CensusCounts& counts) {
  for (const Connection& connection : keyframe.connections) {
    ++counts["cov_directed_edges"];
    counts["cov_self"] += connection.keyframe == keyframe.id ? 1 : 0;
    const KeyFrame* other = lookup.Find(connection.keyframe);
    counts["cov_dangling"] += other ? 0 : 1;
    if (!other) continue;
    const Connection* reverse = FindConnection(*other, keyframe.id);
    counts["cov_missing_reverse"] += reverse ? 0 : 1;
    counts["cov_weight_differs_from_reverse"] += reverse && reverse->weight != connection.weight ? 1 : 0;
    counts["cov_weight_differs_from_recomputed_shared_mps"] += shared[connection.keyframe] != connection.weight ? 1 : 0;
  }
  for (const auto& [other, weight] : shared)
    counts["cov_recomputed_ge15_but_no_edge"] += weight >= 15 && !FindConnection(keyframe, other) ? 1 : 0;
}

bool OnCycle(const CensusLookup& lookup, const KeyFrame& keyframe) {
  std::set<KeyFrameId> path;
  for (const KeyFrame* next = &keyframe; next; next = lookup.Find(next->parent))
    if (!path.insert(next->id).second) return next->id == keyframe.id;
  return false;
}

void CensusTree(const CensusLookup& lookup, const KeyFrame& keyframe, CensusCounts& counts) {
  const KeyFrame* parent = lookup.Find(keyframe.parent);
  counts["parent_none"] += keyframe.parent ? 0 : 1;
  counts["parent_dangling"] += keyframe.parent && !parent ? 1 : 0;
  counts["parent_self"] += keyframe.parent == keyframe.id ? 1 : 0;
  counts["parent_cycle_nodes"] += OnCycle(lookup, keyframe) ? 1 : 0;
  const auto lists = [](const Column<KeyFrameId>& ids, KeyFrameId id) {
    return std::find(ids.begin(), ids.end(), id) != ids.end();
  };
  counts["parent_does_not_list_child"] += parent && !lists(parent->children, keyframe.id) ? 1 : 0;
  std::set<KeyFrameId> seen;
  for (const KeyFrameId id : keyframe.children) {
    const KeyFrame* child = lookup.Find(id);
    counts["child_dangling"] += child ? 0 : 1;
    counts["child_has_other_parent"] += child && child->parent != keyframe.id ? 1 : 0;
    counts["child_duplicate"] += seen.insert(id).second ? 0 : 1;
  }
  for (const KeyFrameId id : keyframe.loop_edges) {
    const KeyFrame* other = lookup.Find(id);
    counts["loop_dangling"] += other ? 0 : 1;
    counts["loop_missing_reverse"] += other && !lists(other->loop_edges, keyframe.id) ? 1 : 0;
  }
  for (const KeyFrameId id : keyframe.merge_edges) {
    const KeyFrame* other = lookup.Find(id);
    counts["merge_dangling"] += other ? 0 : 1;
    counts["merge_missing_reverse"] += other && !lists(other->merge_edges, keyframe.id) ? 1 : 0;
  }
}

void CensusLinks(const Atlas& atlas, const CensusLookup& lookup, const KeyFrame& keyframe, CensusCounts& counts) {
  const bool camera = std::any_of(atlas.cameras.begin(), atlas.cameras.end(),
                                  [&](const Camera& candidate) { return candidate.id == keyframe.camera; });
  counts["camera_missing"] += camera ? 0 : 1;
  counts["camera2_set"] += keyframe.right_camera ? 1 : 0;
  const KeyFrame* previous = lookup.Find(keyframe.previous);
  const KeyFrame* next = lookup.Find(keyframe.next);
  counts["prev_dangling"] += keyframe.previous && !previous ? 1 : 0;
  counts["next_dangling"] += keyframe.next && !next ? 1 : 0;
  counts["prev_next_not_symmetric"] += previous && previous->next != keyframe.id ? 1 : 0;
  counts["next_prev_not_symmetric"] += next && next->previous != keyframe.id ? 1 : 0;
}

void CensusGrid(const FeatureGrid& grid, std::size_t keypoints, const std::string& prefix, CensusCounts& counts) {
  const std::string out_of_range = prefix == "grid" ? "grid_idx_out_of_range" : "gridR_out_of_range";
  std::set<std::uint64_t> seen;
  for (const std::uint64_t row : grid.keypoints) {
    ++counts[prefix + "_entries"];
    counts[prefix + "_duplicate_idx"] += seen.insert(row).second ? 0 : 1;
    counts[out_of_range] += row < keypoints ? 0 : 1;
  }
  if (prefix == "grid") counts["grid_keypoints_not_in_grid"] += static_cast<std::int64_t>(keypoints - seen.size());
}

void CensusFeatures(const KeyFrame& keyframe, CensusCounts& counts) {
  const Features& features = keyframe.features;
  const auto count = static_cast<std::size_t>(features.count);
  CensusGrid(features.grid, features.keypoints.size(), "grid", counts);
  CensusGrid(features.right_grid, features.right_keypoints.size(), "gridR", counts);
  counts["descriptors_bad_shape"] += features.descriptors.size() == count ? 0 : 1;
  counts["mvKeys_size_not_N"] += features.keypoints.size() == count ? 0 : 1;
  counts["mvKeysUn_size_not_N"] += features.undistorted.size() == count ? 0 : 1;
  counts["mvuRight_size_not_N"] += features.right_x.size() == count ? 0 : 1;
  counts["mvDepth_size_not_N"] += features.depth.size() == count ? 0 : 1;
  counts["kf_with_l2r"] += features.right_of_left.empty() ? 0 : 1;
  counts["bow_empty"] += features.bag_of_words.words.empty() ? 1 : 0;
  counts["featvec_empty"] += features.feature_vector.nodes.empty() ? 1 : 0;
  std::set<std::uint32_t> seen;
  for (const std::uint32_t row : features.feature_vector.features) {
    ++counts["featvec_entries"];
    counts["featvec_idx_oor"] += row < count ? 0 : 1;
    counts["featvec_idx_duplicate"] += seen.insert(row).second ? 0 : 1;
  }
  double norm = 0;
  for (const double weight : features.bag_of_words.weights) norm += weight;
  counts["bow_l1_norm_not_1"] += !features.bag_of_words.words.empty() && std::abs(norm - 1) > 1e-6 ? 1 : 0;
}

void CensusState(const KeyFrame& keyframe, CensusCounts& counts) {
  const Rigid3f& pose = keyframe.camera_from_world;
  counts["kf_bad_flag"] += keyframe.bad ? 1 : 0;
  counts["quat_not_unit"] += std::abs(pose.rotation.norm() - 1.0F) > 1e-3F ? 1 : 0;
  counts["kf_pose_nan"] += pose.rotation.coeffs().allFinite() && pose.translation.allFinite() ? 0 : 1;
  counts["flag_mbNotErase"] += keyframe.not_erase ? 1 : 0;
  counts["flag_mbToBeErased"] += keyframe.to_be_erased ? 1 : 0;
  counts["flag_mbFirstConnection"] += keyframe.first_connection ? 1 : 0;
  counts["flag_bImu"] += keyframe.imu_initialized ? 1 : 0;
  counts["flag_mbHasVelocity"] += keyframe.has_velocity ? 1 : 0;
  counts["kf_with_imu_measurements"] += keyframe.preintegration.measurements.empty() ? 0 : 1;
  counts["imu_measurements"] += static_cast<std::int64_t>(keyframe.preintegration.measurements.size());
}

}  // namespace

SharedPoints CountSharedPoints(const Map& map) {
  SharedPoints shared;
  for (const KeyFrame& keyframe : map.keyframes) {
    std::map<MapPointId, int> slots;
    for (const MapPointId point : keyframe.features.map_points)
      if (point) ++slots[point];
    for (const MapPoint& point : map.points) {
      const auto found = slots.find(point.id);
      if (found == slots.end()) continue;
      for (const Observation& observation : point.observations)
        if (observation.keyframe != keyframe.id) shared[keyframe.id][observation.keyframe] += found->second;
    }
  }
  return shared;
}

void CensusKeyFrame(const Atlas& atlas, const CensusLookup& lookup, const KeyFrame& keyframe,
                    std::map<KeyFrameId, std::int32_t>& shared, CensusCounts& counts) {
  CensusMatches(lookup, keyframe, counts);
  CensusCovisibility(lookup, keyframe, shared, counts);
  CensusTree(lookup, keyframe, counts);
  CensusLinks(atlas, lookup, keyframe, counts);
  CensusFeatures(keyframe, counts);
  CensusState(keyframe, counts);
}

}  // namespace slamdb
