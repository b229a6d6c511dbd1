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
    const Similarity3d first_from_second = truth();
    const double most = 1e-4 / sessions.room_from_map[0].scale;  // a tenth of a millimetre
    for (std::uint32_t b = 0; b < second.points().size(); ++b) {
      const Eigen::Vector3d position = first_from_second * second.points()[b].position;
      for (std::uint32_t a = 0; a < first.points().size(); ++a)
        if ((first.points()[a].position - position).squaredNorm() < most * most && !first.SightingsOf(a).empty() &&
            !second.SightingsOf(b).empty())
          matches.push_back({{a, first.SightingsOf(a).front()}, {b, second.SightingsOf(b).front()}});
    }
    return matches;
  }
};

}  // namespace slamdb::testing
