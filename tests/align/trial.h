// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "slamdb/align/align.h"
#include "slamdb/synthetic/synthesize.h"

// Sessions that are made, aligned, and held against the truth: for the tests, and for the table of docs/align.md.
namespace slamdb::testing {

// Two sessions as SLAM makes them: descriptors differ as in real maps, noise and outliers with the seed.
SyntheticOptions PairOfSessions(Sensor sensor, bool inertial, double overlap, std::uint64_t seed);
// The same of two rooms that look alike.
SyntheticOptions PairOfLookAlikes(Sensor sensor, bool inertial, std::uint64_t seed);

struct TransformError {
  double degrees = 0, metres = 0, scale = 0;  // metres: root mean square over the second map's keyframes; a share
  bool small() const { return degrees < 1.5 && metres < 0.1 && scale < 0.03; }
};

// How far a transform between the first two maps is from the truth.
TransformError ErrorOf(const SyntheticSessions& sessions, const Similarity3d& first_from_second);
Similarity3d TrueTransform(const SyntheticSessions& sessions);

// What became of two sessions.
struct Outcome {
  Alignment alignment;
  TransformError error;  // where there is a transform

  bool aligned() const { return alignment.verdict == AlignmentVerdict::kAligned; }
  bool found() const { return aligned() && error.small(); }
};
Outcome AlignSessions(const SyntheticSessions& sessions, const AlignOptions& options = {});

// For messages of tests: verdict, reason and figures.
std::string Describe(const Outcome& outcome);

}  // namespace slamdb::testing
