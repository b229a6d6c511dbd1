// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "slamdb/model/index.h"
#include "slamdb/model/up.h"
#include "slamdb/plot/detail/geometry.h"
#include "slamdb/plot/detail/theme.h"
#include "slamdb/plot/plot.h"

// What plots have to show of an atlas, looked up once.
namespace slamdb::plot {

// The directions in which a map is looked at: right and forward on the plan, and up.
struct Frame {
  Eigen::Matrix3d axes_from_world = Eigen::Matrix3d::Identity();  // rows: right, forward, up
  std::array<std::string, 3> names;                               // of the axes, without unit
  std::string how;                                                // how it was found, for a caption
};

// A good keyframe with its camera at a finite place, and what it observes.
struct Stop {
  const KeyFrame* keyframe = nullptr;
  std::uint32_t row = 0;  // in Map::keyframes
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  bool follows = false;  // on the stop before it, without a gap in time
};

struct MapScene {
  const Map* map = nullptr;
  std::string name;  // `map 0`
  Color color;
  bool metric = false;
  std::vector<Stop> path;               // in order of time
  std::vector<std::uint32_t> timed;     // rows of good keyframes with a finite time, in order of time
  std::vector<std::uint32_t> observed;  // good points that each keyframe observes, by row
  std::vector<std::pair<std::uint32_t, std::uint32_t>> loops, merges;  // places in `path`, each pair once
  Frame frame;
};

// Reprojection errors of observations of good points, at their keypoints: in undistorted pixels of the left image and,
// of a fisheye stereo pair, of the right one.
struct ImageErrors {
  struct Sample {
    float x, y, error;
    std::uint32_t map = 0;  // place in Scene::maps
  };
  std::vector<Sample> samples;  // that can be projected, in the order of maps, points and observations
  Box image;                    // what most of the keypoints are in
};

struct Scene {
  const Atlas& atlas;
  PlotOptions options;
  Theme theme;
  std::vector<MapScene> maps;  // that have keyframes or points; of very many, those with the most
  std::size_t other_maps = 0;  // that are left out for that

  std::size_t keyframes() const;
  std::string unit() const;           // `m`, or `map units` where a map has no scale
  const ImageErrors& errors() const;  // computed when first asked for; not from several threads

  mutable std::optional<ImageErrors> errors_;
};

Scene SceneOf(const Atlas& atlas, const PlotOptions& options);
// The same maps, to be drawn otherwise.
void Redress(Scene& scene, const PlotOptions& options);

// The time between keyframes that counts as a gap.
double GapOf(const Map& map, const std::vector<std::uint32_t>& timed);

// The map turned upright: x and y of one whose z is up, x and z of one whose y is down.
Frame UprightFrame(const Up& up);

// Turned about up, so that the largest level spread of some places lies to the right; as it is where they have no two.
Frame FrameOfSpreads(const Up& up, const std::vector<Eigen::Vector3d>& places);

// Upright where the heading of the map's axes means something, with inertia or z up; by the spreads of the path
// otherwise.
Frame FrameOf(const Up& up, const std::vector<Stop>& path);

}  // namespace slamdb::plot
