// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "slamdb/base/progress.h"
#include "slamdb/export.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/similarity.h"

namespace slamdb {

enum class Sensor { kMonocular, kStereo, kRgbd, kFisheyeStereo };

// How the maps of an atlas are sessions of one or of alike places, each on an arc of the wall of its own.
struct SessionOptions {
  double overlap = 0.5;  // share of its arc that a session shares with the one before it: 0 nothing, 1 all
  double common = 0.7;   // share of the points there that are the same; the others only one session mapped
  // Every session is in a room of its own. In those after the first, every other metre of the wall is a strip of the
  // first one's wall, all in another order and moved up or down by up to 30 cm.
  bool look_alike = false;
};

struct SyntheticOptions {
  Sensor sensor = Sensor::kMonocular;
  bool inertial = false;  // IMU calibration, preintegration with measurements, velocities, an unbroken chain
  int maps = 1;
  std::size_t keyframes = 20;  // per map
  std::size_t points = 1000;   // per map
  std::size_t features = 500;  // at most, per keyframe (both images of a fisheye pair together)
  double pixel_noise = 0.5;    // standard deviation of keypoint positions at octave 0
  double outliers = 0;         // share of the keypoints of points that show something else
  // At most, in which a look at a point differs from the descriptor that the point has. Two looks at one point differ
  // in twice as many at most; in real maps in 20 to 50.
  int flipped_bits = 8;
  std::uint64_t vocabulary = 0;            // another number, other words for the same looks, and another checksum
  bool loops = true;                       // loop edges where the camera comes back
  std::optional<SessionOptions> sessions;  // by default each map is of a world of its own
  std::uint64_t seed = 1;
  int threads = 0;
  Progress progress;
};

// As many keyframes and points as make a binary .osa file of about so many bytes.
SLAMDB_EXPORT void ScaleTo(std::uint64_t bytes, SyntheticOptions& options);

// Makes a sound, geometrically consistent atlas as ORB-SLAM3 would have saved it.
// A camera goes round a room whose walls carry the points.
// Every keypoint is the noisy projection of a point, or clutter.
// Octaves, distance ranges, normals, descriptors, grids, covisibility, spanning tree, bags of words and counters follow
// from that.
// The words of its bags are below 1,000,000 and its vocabulary is made up.
// `check` finds nothing in it.
// Equal options give equal bytes on every machine.
//
// Throws Error (kUsage) when an option is out of its range, or the options contradict themselves.
// Cost: linear in the number of features.
SLAMDB_EXPORT Atlas SynthesizeAtlas(const SyntheticOptions& options);

// An atlas, and where the frames of its maps truly lie.
struct SyntheticSessions {
  Atlas atlas;
  // By map: from its frame to the room's, in metres, z up. Sessions of one room share its frame; a map that is not a
  // session, or a session in a look-alike room, has a room of its own.
  std::vector<Similarity3d> room_from_map;
};

// As SynthesizeAtlas, with the truth.
// Each session has its own origin, keyframes, noise, ids and times and, monocular without IMU, a scale between 0.1
// and 10.
SLAMDB_EXPORT SyntheticSessions SynthesizeSessions(const SyntheticOptions& options);

}  // namespace slamdb
