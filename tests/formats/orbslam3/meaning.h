// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>

#include "slamdb/model/atlas.h"

// What an atlas means, in the terms in which ORB-SLAM3's own loader was asked about the real files: a reader that puts
// one number in the wrong place changes some of these.
namespace slamdb {

// Each irregularity of a map as stored, and the ranges of its numbers, before ORB-SLAM3 repairs anything.
nlohmann::json Census(const Atlas& atlas, const Map& map);

// Counts, sums in double in ascending order of ids, and hashes modulo 2^64 of the map as ORB-SLAM3 holds it after
// loading: without the observations of bad points, and without matches to points that are bad or absent. Of a keyframe
// kf, a point mp, an observation's rows left and right (-1: none), and bits(x), the 32 bits of a float:
//   kf_tcw_t_bits         sum of (kf+1) bits(t_i) (2i+1)           mp_pos_bits          sum of (mp+1) bits(p_i) (2i+1)
//   obs_kfid_x_idx_left   sum of kf left where left >= 0, and the same of right
//   obs_hash              sum of (mp+1)(kf+1)(left+2) + 7 (mp+1)(kf+3)(right+2)
//   kf_slot_hash          sum of (kf+1)(i+1)(mp+1) over matches i
//   desc_hash             sum of (kf+1) sum of (i+1) byte_i over the rows of descriptors; mp_desc_hash alike
//   cov_hash              sum of (kf+1)(other+1) weight            parent_hash          sum of (kf+1)(parent+1)
//   bow_hash              sum of (kf+1)(word+1)                    featvec_hash         sum of (kf+1)(node+1)(row+1)
nlohmann::json Sums(const Map& map);

}  // namespace slamdb
