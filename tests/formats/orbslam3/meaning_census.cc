// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include "tests/formats/orbslam3/census.h"
#include "tests/formats/orbslam3/meaning.h"

namespace slamdb {
namespace {

using nlohmann::json;

class Range {
 public:
  void Add(float value) {
    ++count_;
    if (!std::isfinite(value)) {
      ++not_finite_;
      return;
    }
    least_ = std::min(least_, static_cast<double>(value));
    greatest_ = std::max(greatest_, static_cast<double>(value));
  }
  template <class Vector>
  void AddAll(const Vector& values) {
    for (const float value : values.reshaped()) Add(value);
  }
  json ToJson() const {
    json range = {{"n", count_}, {"nonfinite", not_finite_}};
    if (count_ > not_finite_) {
      range["min"] = least_;
      range["max"] = greatest_;
    }
    return range;
  }

 private:
  std::int64_t count_ = 0, not_finite_ = 0;
  double least_ = std::numeric_limits<double>::infinity(), greatest_ = -least_;
};

template <class Entity>
std::int64_t Duplicates(const Column<Entity>& column) {
  std::set<std::uint64_t> ids;
  for (const Entity& entity : column) ids.insert(entity.id.value());
  return static_cast<std::int64_t>(column.size() - ids.size());
}

template <class Entity>
std::int64_t InOtherMaps(const Atlas& atlas, const Map& map, Column<Entity> Map::*column) {
  std::set<std::uint64_t> others;
  for (const Map& other : atlas.maps)
    if (&other != &map)
      for (const Entity& entity : other.*column) others.insert(entity.id.value());
  std::int64_t count = 0;
  for (const Entity& entity : map.*column) count += static_cast<std::int64_t>(others.count(entity.id.value()));
  return count;
}

template <class Entity>
bool SortedById(const Column<Entity>& column) {
  return std::is_sorted(column.begin(), column.end(), [](const Entity& a, const Entity& b) { return a.id < b.id; });
}

json Ranges(const Map& map) {
  std::map<std::string, Range> ranges;
  for (const char* name : {"mVw", "mOwb", "imuCalib_Cov", "imuCalib_tbc", "preint_dT", "preint_C", "preint_db",
                           "preint_avgA", "bias", "mTcp_t", "mHalfBaseline", "mfScale"})
    ranges[name];
  for (const KeyFrame& keyframe : map.keyframes) {
    const ImuPreintegration& imu = keyframe.preintegration;
    ranges["mVw"].AddAll(keyframe.velocity);
    ranges["mOwb"].AddAll(keyframe.body_position);
    ranges["imuCalib_Cov"].AddAll(keyframe.imu_calibration.noise);
    ranges["imuCalib_Cov"].AddAll(keyframe.imu_calibration.walk_noise);
    ranges["imuCalib_tbc"].AddAll(keyframe.imu_calibration.body_from_camera.translation);
    ranges["preint_dT"].Add(imu.duration);
    ranges["preint_C"].AddAll(imu.covariance);
    ranges["preint_db"].AddAll(imu.bias_change);
    ranges["preint_avgA"].AddAll(imu.mean_acceleration);
    ranges["bias"].Add(keyframe.imu_bias.accelerometer.x());
    ranges["bias"].Add(keyframe.imu_bias.gyroscope.x());
    ranges["mTcp_t"].AddAll(keyframe.camera_from_parent.translation);
    ranges["mHalfBaseline"].Add(keyframe.half_baseline);
    ranges["mfScale"].Add(keyframe.merge_scale);
  }
  json result;
  for (const auto& [name, range] : ranges) result["range_" + name] = range.ToJson();
  return result;
}

void CensusIds(const Map& map, const CensusLookup& lookup, json& census) {
  KeyFrameId least, greatest(0);
  MapPointId greatest_point(0);
  for (const KeyFrame& keyframe : map.keyframes) {
    least = std::min(least, keyframe.id);
    greatest = std::max(greatest, keyframe.id);
  }
  for (const MapPoint& point : map.points) greatest_point = std::max(greatest_point, point.id);
  census["min_kf_id"] = map.keyframes.empty() ? 0 : least.value();
  census["max_kf_id"] = greatest.value();
  census["max_mp_id"] = greatest_point.value();
  census["stored_mnInitKFid"] = map.initial_keyframe.value();
  census["stored_mnMaxKFid"] = map.max_keyframe_id;
  census["stored_KFinitialID"] = map.first_keyframe.value();
  census["stored_KFlowerID"] = map.lowest_keyframe.value();
  census["KFinitial_present"] = lookup.Find(map.first_keyframe) != nullptr;
  census["KFlower_present"] = lookup.Find(map.lowest_keyframe) != nullptr;
  census["initKFid_present"] = lookup.Find(map.initial_keyframe) != nullptr;
  census["origins"] = map.origins.size();
  census["origins_dangling"] =
      std::count_if(map.origins.begin(), map.origins.end(), [&](KeyFrameId id) { return !lookup.Find(id); });
  census["origin_ids"] = json::array();
  for (const KeyFrameId id : map.origins) census["origin_ids"].push_back(id.value());
}

std::int64_t StepsBackInTime(const Map& map) {
  std::map<KeyFrameId, double> times;
  for (const KeyFrame& keyframe : map.keyframes) times[keyframe.id] = keyframe.timestamp;
  std::int64_t count = 0;
  double last = -std::numeric_limits<double>::infinity();
  for (const auto& [id, time] : times) {
    count += time < last ? 1 : 0;
    last = time;
  }
  return count;
}

// One more of that value in a histogram.
void Tally(json& histogram, std::uint64_t value) {
  json& bin = histogram[std::to_string(value)];
  bin = bin.is_null() ? 1 : bin.get<int>() + 1;
}

// The preintegrated time against that between the two keyframes.
void CensusDurations(const Map& map, const CensusLookup& lookup, json& census) {
  Range differences;
  std::int64_t large = 0;
  for (const KeyFrame& keyframe : map.keyframes) {
    const KeyFrame* previous = lookup.Find(keyframe.previous);
    if (!previous || keyframe.preintegration.measurements.empty()) continue;
    const double between = keyframe.timestamp - previous->timestamp;
    const auto difference = static_cast<float>(static_cast<double>(keyframe.preintegration.duration) - between);
    differences.Add(difference);
    large += std::abs(difference) > 0.02F ? 1 : 0;
  }
  census["imu_dT_differs_from_ts_diff_gt20ms"] = large;
  census["imu_dT_minus_ts_diff"] = differences.ToJson();
}

constexpr std::array kCounters = {"mp_bad_flag",
                                  "mp_zero_obs",
                                  "mp_one_obs",
                                  "mp_obs_dangling_kf",
                                  "mp_obs_idx_out_of_range",
                                  "mp_obs_slot_empty_in_kf",
                                  "mp_obs_slot_other_mp_in_kf",
                                  "mp_obs_both_idx_-1",
                                  "mp_obs_only_right",
                                  "mp_obsId1_obsId2_keys_differ",
                                  "mp_nobs_mismatch",
                                  "mp_nobs_mismatch_abs_sum",
                                  "mp_nobs_stored_less_than_computed",
                                  "mp_refkf_not_in_map",
                                  "mp_refkf_missing_value_0",
                                  "mp_refkf_not_observing",
                                  "mp_firstkf_not_in_map",
                                  "mp_replaced_set",
                                  "mp_replaced_dangling",
                                  "mp_nan_pos",
                                  "mp_normal_not_unit",
                                  "mp_descriptor_bad_shape",
                                  "mp_maxdist_nonpositive",
                                  "kf_bad_flag",
                                  "kf_mpid_vector_size_not_N",
                                  "kf_slot_mp_not_in_map",
                                  "kf_slot_mp_lacks_observation",
                                  "kf_slot_mp_bad",
                                  "kf_same_mp_in_two_slots",
                                  "cov_directed_edges",
                                  "cov_dangling",
                                  "cov_self",
                                  "cov_missing_reverse",
                                  "cov_weight_differs_from_reverse",
                                  "cov_weight_differs_from_recomputed_shared_mps",
                                  "cov_recomputed_ge15_but_no_edge",
                                  "parent_none",
                                  "parent_dangling",
                                  "parent_self",
                                  "parent_cycle_nodes",
                                  "parent_does_not_list_child",
                                  "child_dangling",
                                  "child_has_other_parent",
                                  "child_duplicate",
                                  "loop_dangling",
                                  "loop_missing_reverse",
                                  "merge_dangling",
                                  "merge_missing_reverse",
                                  "camera_missing",
                                  "camera2_set",
                                  "prev_dangling",
                                  "next_dangling",
                                  "prev_next_not_symmetric",
                                  "next_prev_not_symmetric",
                                  "grid_entries",
                                  "grid_idx_out_of_range",
                                  "grid_duplicate_idx",
                                  "grid_keypoints_not_in_grid",
                                  "gridR_entries",
                                  "gridR_duplicate_idx",
                                  "gridR_out_of_range",
                                  "descriptors_bad_shape",
                                  "mvKeys_size_not_N",
                                  "mvKeysUn_size_not_N",
                                  "mvuRight_size_not_N",
                                  "mvDepth_size_not_N",
                                  "bow_empty",
                                  "featvec_empty",
                                  "featvec_entries",
                                  "featvec_idx_oor",
                                  "featvec_idx_duplicate",
                                  "bow_l1_norm_not_1",
                                  "quat_not_unit",
                                  "kf_pose_nan",
                                  "flag_mbNotErase",
                                  "flag_mbToBeErased",
                                  "flag_mbFirstConnection",
                                  "flag_bImu",
                                  "flag_mbHasVelocity",
                                  "kf_with_imu_measurements",
                                  "imu_measurements",
                                  "kf_with_l2r"};

}  // namespace

nlohmann::json Census(const Atlas& atlas, const Map& map) {
  const CensusLookup lookup(map);
  CensusCounts counts;
  for (const char* counter : kCounters) counts[counter] = 0;
  json histogram = json::object(), origin_maps = json::object(), missing_references = json::object();
  for (const MapPoint& point : map.points) {
    CensusPoint(lookup, point, counts, histogram);
    if (!lookup.Find(point.reference)) Tally(missing_references, point.reference.value());
  }
  SharedPoints shared = CountSharedPoints(map);
  for (const KeyFrame& keyframe : map.keyframes) {
    CensusKeyFrame(atlas, lookup, keyframe, shared[keyframe.id], counts);
    Tally(origin_maps, keyframe.origin_map);
  }
  json census = Ranges(map);
  CensusDurations(map, lookup, census);
  census.update(json(counts));
  CensusIds(map, lookup, census);
  census["mp"] = map.points.size();
  census["kf"] = map.keyframes.size();
  census["kf_duplicate_id_in_map"] = Duplicates(map.keyframes);
  census["mp_duplicate_id_in_map"] = Duplicates(map.points);
  census["kf_id_also_in_other_map"] = InOtherMaps(atlas, map, &Map::keyframes);
  census["mp_id_also_in_other_map"] = InOtherMaps(atlas, map, &Map::points);
  census["kf_vector_sorted_by_id"] = SortedById(map.keyframes);
  census["mp_vector_sorted_by_id"] = SortedById(map.points);
  census["mp_nobs_diff_hist_stored_minus_computed"] = histogram;
  census["mp_refkf_missing_values"] = missing_references;
  census["origin_map_id_hist"] = origin_maps;
  census["kf_timestamp_not_monotonic_in_id"] = StepsBackInTime(map);
  return census;
}

}  // namespace slamdb
