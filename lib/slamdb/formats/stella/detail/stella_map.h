// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "slamdb/model/atlas.h"

// What the files of stella_vslam and OpenVSLAM hold, whichever of their formats they are of.
namespace slamdb::stella {

enum class Model { kPerspective, kFisheye, kEquirectangular, kRadialDivision };
enum class Setup { kMonocular, kStereo, kRgbd };

// Names as the files have them; nullopt for others.
std::string_view NameOf(Model model);
std::string_view NameOf(Setup setup);
std::optional<Model> ModelOf(std::string_view name);
std::optional<Setup> SetupOf(std::string_view name);

struct LensCamera {
  std::string name;
  Model model = Model::kPerspective;
  Setup setup = Setup::kMonocular;
  std::string color_order = "Gray";     // Gray, RGB, BGR
  std::uint32_t columns = 0, rows = 0;  // of the picture
  double fps = 30;
  double fx = 0, fy = 0, cx = 0, cy = 0;  // pixels; none of equirectangular cameras
  // Perspective: k1 k2 p1 p2 k3. Fisheye: k1 k2 k3 k4. RadialDivision: its one number.
  std::array<double, 5> distortion{};
  double focal_x_baseline = 0;  // pixels * metres; 0: monocular

  bool is_distorted() const { return distortion != std::array<double, 5>{}; }
  friend auto operator<=>(const LensCamera&, const LensCamera&) = default;
};

// How ORB features were extracted.
struct OrbParams {
  std::string name;
  float scale_factor = 1.2F;
  std::uint32_t levels = 8, ini_fast_threshold = 20, min_fast_threshold = 7;

  // Of a pyramid, or the usual ones where that is none. The name tells them: `ORB of 8 levels, scale 1.2`.
  static OrbParams Of(const ScalePyramid& pyramid);
  // What a name tells, if it is one that slamdb gave.
  static std::optional<OrbParams> Named(const std::string& name);
  // Whether levels and scale are those of a pyramid.
  bool is_sound() const { return levels >= 1 && levels <= 64 && scale_factor > 1 && scale_factor < 10; }

  friend auto operator<=>(const OrbParams&, const OrbParams&) = default;
};

// A keyframe with what it names.
struct StoredKeyFrame {
  KeyFrame keyframe;  // id, time, pose, keypoints, right_x, depth, descriptors, map_points, tree and loops
  std::string camera, orb_params;
  std::optional<OrbParams> own_params;    // OpenVSLAM: each keyframe has its own
  std::optional<double> depth_threshold;  // OpenVSLAM, metres
};

struct StoredMap {
  std::vector<LensCamera> cameras;
  std::vector<OrbParams> orb_params;
  std::vector<StoredKeyFrame> keyframes;
  Column<MapPoint> points;
  std::uint64_t next_keyframe = 0, next_point = 0, next_frame = 0;
  std::uint64_t markers = 0, marker_sightings = 0;  // which no atlas holds
};

}  // namespace slamdb::stella
