// SPDX-License-Identifier: BSD-3-Clause
#include "tests/align/trial.h"

#include <cmath>
#include <numbers>

namespace slamdb::testing {
namespace {

// Of a stretch of a room that a robot crosses in some seconds.
SyntheticOptions Session(Sensor sensor, bool inertial, std::uint64_t seed) {
  SyntheticOptions options{.sensor = sensor, .inertial = inertial, .maps = 2};
  options.keyframes = 30;
  options.points = 1200;
  options.features = sensor == Sensor::kFisheyeStereo ? 1600 : 700;
  options.pixel_noise = 0.5 + 0.25 * static_cast<double>(seed % 4);
  options.outliers = 0.04 * static_cast<double>(seed / 4 % 4);
  options.flipped_bits = 24;
  options.seed = seed;
  return options;
}

}  // namespace

SyntheticOptions PairOfSessions(Sensor sensor, bool inertial, double overlap, std::uint64_t seed) {
  SyntheticOptions options = Session(sensor, inertial, seed);
  options.sessions = SessionOptions{.overlap = overlap};
  return options;
}

SyntheticOptions PairOfLookAlikes(Sensor sensor, bool inertial, std::uint64_t seed) {
  SyntheticOptions options = Session(sensor, inertial, seed);
  options.sessions = SessionOptions{.look_alike = true};
  return options;
}

Similarity3d TrueTransform(const SyntheticSessions& sessions) {
  return sessions.room_from_map[0].Inverse() * sessions.room_from_map[1];
}

TransformError ErrorOf(const SyntheticSessions& sessions, const Similarity3d& first_from_second) {
  const Similarity3d truth = TrueTransform(sessions);
  TransformError error;
  error.degrees = truth.rotation.angularDistance(first_from_second.rotation) * 180 / std::numbers::pi;
  error.scale = std::abs(first_from_second.scale / truth.scale - 1);
  double squares = 0;
  const Column<KeyFrame>& keyframes = sessions.atlas.maps[1].keyframes;
  for (const KeyFrame& keyframe : keyframes) {
    const Eigen::Vector3d center = keyframe.camera_from_world.Inverse().translation.cast<double>();
    squares += (truth * center - first_from_second * center).squaredNorm();
  }
  error.metres = std::sqrt(squares / static_cast<double>(keyframes.size())) * sessions.room_from_map[0].scale;
  return error;
}

Outcome AlignSessions(const SyntheticSessions& sessions, const AlignOptions& options) {
  Outcome outcome{.alignment = AlignMaps({&sessions.atlas, 0}, {&sessions.atlas, 1}, options), .error = {}};
  if (outcome.alignment.first_from_second) outcome.error = ErrorOf(sessions, *outcome.alignment.first_from_second);
  return outcome;
}

std::string Describe(const Outcome& outcome) {
  const AlignmentEvidence& evidence = outcome.alignment.evidence;
  const auto number = [](double value) { return std::to_string(value); };
  return std::string(NameOf(outcome.alignment.verdict)) + ": " + outcome.alignment.reason + "; agreeing " +
         std::to_string(evidence.agreeing) + " of " + std::to_string(evidence.candidates) + ", keyframes " +
         std::to_string(evidence.keyframes) + ", contradicting " + std::to_string(evidence.contradicting) +
         ", points " + std::to_string(evidence.points) + ", extent " + number(evidence.extent) + ", found " +
         number(evidence.found_share) + ", cells " + number(evidence.cell_share) + ", front " +
         number(evidence.front_share) + ", views " + std::to_string(evidence.agreeing_views) + " of " +
         std::to_string(evidence.views) + "; off by " + number(outcome.error.degrees) + " degrees, " +
         number(outcome.error.metres) + " m, " + number(100 * outcome.error.scale) + "% of the scale";
}

}  // namespace slamdb::testing
