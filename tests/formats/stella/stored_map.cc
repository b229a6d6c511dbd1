// SPDX-License-Identifier: BSD-3-Clause
#include "tests/formats/stella/stored_map.h"

#include <vector>

#include "slamdb/formats/stella/detail/stella.h"

namespace slamdb {
namespace {

json KeypointOf(float x, float y, float angle, unsigned octave) {
  return {{"pt", {x, y}}, {"ang", angle}, {"oct", octave}};
}

json DescriptorOf(std::uint32_t first) { return std::vector<std::uint32_t>{first, 1, 2, 300, 70000, 5, 6, 0xffffffff}; }

json KeyFrameOf(double time, double x, std::vector<json> keypoints, std::vector<int> landmarks) {
  std::vector<json> descriptors;
  for (std::uint32_t row = 0; row < keypoints.size(); ++row) descriptors.push_back(DescriptorOf(row));
  return {{"ts", time},
          {"cam", "lab"},
          {"orb_params", "fine"},
          {"rot_cw", {0.0, 0.0, 0.6, 0.8}},
          {"trans_cw", {x, 0.1, 2.5}},
          {"n_keypts", keypoints.size()},
          {"undist_keypts", keypoints},
          {"x_rights", std::vector<float>{}},
          {"depths", std::vector<float>{}},
          {"descs", descriptors},
          {"lm_ids", landmarks},
          {"span_parent", -1},
          {"span_children", std::vector<int>{}},
          {"loop_edges", std::vector<int>{}}};
}

}  // namespace

json SmallStellaMap() {
  json first = KeyFrameOf(0.5, 0, {KeypointOf(10.5F, 20, 90, 0), KeypointOf(100.1F, 20, 1, 3), KeypointOf(5, 6, 7, 1)},
                          {7, -1, -1});
  json second = KeyFrameOf(1.1, -1, {KeypointOf(12, 21, 91, 1), KeypointOf(64, 48, 0, 0)}, {-1, 7});
  first["span_children"] = {12};
  second["span_parent"] = 4;
  second["loop_edges"] = {4};
  first["loop_edges"] = {12};
  return {{"cameras",
           {{"lab",
             {{"model_type", "Perspective"},
              {"setup_type", "Monocular"},
              {"color_order", "RGB"},
              {"cols", 640},
              {"rows", 480},
              {"fps", 30.0},
              {"focal_x_baseline", 0.0},
              {"fx", 500.5},
              {"fy", 501.0},
              {"cx", 320.0},
              {"cy", 240.0},
              {"k1", 0.0},
              {"k2", 0.0},
              {"p1", 0.0},
              {"p2", 0.0},
              {"k3", 0.0}}}}},
          {"orb_params",
           {{"fine",
             {{"name", "fine"},
              {"scale_factor", 1.5F},
              {"num_levels", 5},
              {"ini_fast_threshold", 20},
              {"min_fast_threshold", 7}}}}},
          {"keyframes", {{"4", first}, {"12", second}}},
          {"landmarks",
           {{"7", {{"1st_keyfrm", 4}, {"pos_w", {0.25, -1.5, 4.0}}, {"ref_keyfrm", 12}, {"n_vis", 9}, {"n_fnd", 5}}}}},
          {"keyframe_next_id", 20},
          {"landmark_next_id", 300}};
}

json SmallOpenVslamMap() {
  json map = SmallStellaMap();
  map.erase("orb_params");
  map["frame_next_id"] = 99;
  int frame = 30;
  for (auto& [id, keyframe] : map["keyframes"].items()) {
    json places = json::array();
    for (const json& keypoint : keyframe["undist_keypts"])
      places.push_back({keypoint["pt"][0].get<float>() + 1, keypoint["pt"][1]});
    keyframe["keypts"] = keyframe["undist_keypts"];
    keyframe["undists"] = places;
    keyframe["src_frm_id"] = frame++;
    keyframe["depth_thr"] = 3.5;
    keyframe["n_scale_levels"] = 6;
    keyframe["scale_factor"] = 1.25;
    keyframe.erase("undist_keypts");
    keyframe.erase("orb_params");
  }
  return map;
}

std::string Packed(const json& map) {
  const std::vector<std::uint8_t> bytes = json::to_msgpack(map);
  return {bytes.begin(), bytes.end()};
}

Atlas ReadStella(const std::string& bytes, Notices& notices) {
  return detail::kStellaFormat.read({std::as_bytes(std::span(bytes)), "memory"}, {}, notices);
}

Atlas ReadStella(const json& map) {
  Notices ignored;
  return ReadStella(Packed(map), ignored);
}

}  // namespace slamdb
