// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <cstdlib>

#include "tests/formats/orbslam3/census.h"

namespace slamdb {
namespace {

// One side of an observation: what stands in the keyframe's slot.
void CensusObservedSlot(const KeyFrame& keyframe, const MapPoint& point, std::int32_t row, CensusCounts& counts) {
  const Column<MapPointId>& slots = keyframe.features.map_points;
  const bool inside = row < keyframe.features.count && static_cast<std::size_t>(row) < slots.size();
  counts["mp_obs_idx_out_of_range"] += inside ? 0 : 1;
  if (!inside) return;
  const MapPointId slot = slots[static_cast<std::size_t>(row)];
  counts["mp_obs_slot_empty_in_kf"] += slot ? 0 : 1;
  counts["mp_obs_slot_other_mp_in_kf"] += slot && slot != point.id ? 1 : 0;
}

// How many observations ORB-SLAM3 counts for it: two where there is a stereo measurement.
std::int32_t ObservationWeight(const KeyFrame& keyframe, const Observation& observation) {
  const Features& features = keyframe.features;
  if (features.is_fisheye_stereo()) return (observation.left >= 0 ? 1 : 0) + (observation.right >= 0 ? 1 : 0);
  const auto row = static_cast<std::size_t>(observation.left);
  return row < features.right_x.size() && features.right_x[row] >= 0 ? 2 : 1;
}

void CensusObservations(const CensusLookup& lookup, const MapPoint& point, CensusCounts& counts,
                        nlohmann::json& histogram) {
  std::int32_t computed = 0;
  bool reference_observes = false;
  for (const Observation& observation : point.observations) {
    const bool left_absent = observation.left == Observation::kAbsent,
               right_absent = observation.right == Observation::kAbsent;
    counts["mp_obsId1_obsId2_keys_differ"] += left_absent || right_absent ? 1 : 0;
    counts["mp_obs_both_idx_-1"] += observation.left < 0 && observation.right < 0 ? 1 : 0;
    counts["mp_obs_only_right"] += observation.left < 0 && observation.right >= 0 ? 1 : 0;
    reference_observes = reference_observes || observation.keyframe == point.reference;
    const KeyFrame* keyframe = lookup.Find(observation.keyframe);
    counts["mp_obs_dangling_kf"] += keyframe ? 0 : 1;
    if (!keyframe) continue;
    computed += ObservationWeight(*keyframe, observation);
    if (observation.left >= 0) CensusObservedSlot(*keyframe, point, observation.left, counts);
    if (observation.right >= 0) CensusObservedSlot(*keyframe, point, observation.right, counts);
  }
  counts["mp_refkf_not_observing"] += lookup.Find(point.reference) && !reference_observes ? 1 : 0;
  const std::int32_t difference = point.observation_count - computed;
  if (difference == 0) return;
  ++counts["mp_nobs_mismatch"];
  counts["mp_nobs_mismatch_abs_sum"] += std::abs(difference);
  counts["mp_nobs_stored_less_than_computed"] += difference < 0 ? 1 : 0;
  nlohmann::json& bin = histogram[std::to_string(difference)];
  bin = bin.is_null() ? 1 : bin.get<int>() + 1;
}

void CensusRecord(const CensusLookup& lookup, const MapPoint& point, CensusCounts& counts) {
  counts["mp_bad_flag"] += point.bad ? 1 : 0;
  counts["mp_zero_obs"] += point.observations.empty() ? 1 : 0;
  counts["mp_one_obs"] += point.observations.size() == 1 ? 1 : 0;
  const bool reference = lookup.Find(point.reference) != nullptr;
  counts["mp_refkf_not_in_map"] += reference ? 0 : 1;
  counts["mp_refkf_missing_value_0"] += !reference && point.reference.value() == 0 ? 1 : 0;
  counts["mp_firstkf_not_in_map"] += lookup.Find(KeyFrameId(static_cast<std::uint64_t>(point.first_keyframe))) ? 0 : 1;
  counts["mp_replaced_set"] += point.replaced_by ? 1 : 0;
  counts["mp_replaced_dangling"] += point.replaced_by && !lookup.Find(point.replaced_by) ? 1 : 0;
  counts["mp_nan_pos"] += point.position.allFinite() ? 0 : 1;
  counts["mp_normal_not_unit"] += std::abs(point.normal.norm() - 1.0F) > 1e-3F ? 1 : 0;
  counts["mp_descriptor_bad_shape"] += point.has_descriptor() ? 0 : 1;
  counts["mp_maxdist_nonpositive"] += point.max_distance > 0 ? 0 : 1;
}

}  // namespace

void CensusPoint(const CensusLookup& lookup, const MapPoint& point, CensusCounts& counts, nlohmann::json& histogram) {
  CensusRecord(lookup, point, counts);
  CensusObservations(lookup, point, counts, histogram);
}

}  // namespace slamdb
