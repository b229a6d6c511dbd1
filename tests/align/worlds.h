// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include "slamdb/align/detail/candidates.h"
#include "slamdb/align/detail/hypothesis.h"
#include "slamdb/align/detail/prepared_map.h"
#include "slamdb/synthetic/synthesize.h"

// Small worlds for the tests of this folder.
namespace slamdb::testing {

// Two sessions without noise that share half of their arcs.
inline SyntheticOptions SmallPair(Sensor sensor = Sensor::kRgbd, bool inertial = false) {
  SyntheticOptions options{.sensor = sensor, .inertial = inertial, .maps = 2};
  options.keyframes = 14;
  options.points = 600;
  options.features = sensor == Sensor::kFisheyeStereo ? 1200 : 600;
  options.pixel_noise = 0;
  options.sessions = SessionOptions{.overlap = 0.5};
  return options;
}

// Its maps, ready to be aligned. Not to be moved, as parts refer to others.
struct PreparedPair {
  explicit PreparedPair(const SyntheticOptions& options) : sessions(SynthesizeSessions(options)) {}
  PreparedPair(const PreparedPair&) = delete;
  PreparedPair& operator=(const PreparedPair&) = delete;

  Similarity3d truth() const { return sessions.room_from_map[0].Inverse() * sessions.room_from_map[1]; }

  SyntheticSessions sessions;
  detail::PreparedMaps maps{std::array{MapRef{&sessions.atlas, 0}, MapRef{&sessions.atlas, 1}}, {.threads = 1}};
  detail::MapPair pair{maps[0], maps[1], detail::PairGeometry(maps[0].views, maps[1].views)};

  // Pairs of points that are one by how the maps truly lie, each with a picture of either.
  std::vector<detail::PointMatch> TrueMatches() const {
    std::vector<detail::PointMatch> matches;
    const auto &first = maps[0].views, &second = maps[1].views;
    for (std::uint32_t a = 0; a < first.points().size(); ++a)
      for (std::uint32_t b = 0; b < second.points().size(); ++b)
        if ((first.points()[a].position - truth() * second.points()[b].position).norm() < 1e-4 * truth().scale &&
            !first.SightingsOf(a).empty() && !second.SightingsOf(b).empty())
          matches.push_back({{a, first.SightingsOf(a).front()}, {b, second.SightingsOf(b).front()}});
    return matches;
  }
};

}  // namespace slamdb::testing
