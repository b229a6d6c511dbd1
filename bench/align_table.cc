// SPDX-License-Identifier: BSD-3-Clause
// slamdb_align_table [SEEDS [WRONG]]: the table of docs/align.md, as markdown.
// SEEDS pairs of sessions for each sensor and overlap; WRONG pairs of disjoint rooms, and as many of look-alike ones,
// for each sensor. What is not found, or wrongly merged, is told on standard error.
#include <array>
#include <cstdlib>
#include <iostream>
#include <mutex>
#include <vector>

#include "slamdb/base/detail/median.h"
#include "slamdb/base/detail/parallel.h"
#include "tests/align/trial.h"

namespace slamdb::testing {
namespace {

constexpr std::array kOverlaps = {0.1, 0.2, 0.3, 0.5, 0.7, 0.9};

struct Kind {
  const char* name;
  Sensor sensor;
  bool inertial;
  std::uint64_t number;  // each has seeds of its own
};
constexpr std::array kKinds = {Kind{"monocular", Sensor::kMonocular, false, 0},
                               Kind{"monocular-inertial", Sensor::kMonocular, true, 1},
                               Kind{"stereo", Sensor::kStereo, false, 2},
                               Kind{"stereo-inertial", Sensor::kStereo, true, 3},
                               Kind{"RGB-D", Sensor::kRgbd, false, 4},
                               Kind{"RGB-D-inertial", Sensor::kRgbd, true, 5},
                               Kind{"fisheye stereo", Sensor::kFisheyeStereo, false, 6},
                               Kind{"fisheye-inertial", Sensor::kFisheyeStereo, true, 7}};

// What became of the pairs of one cell of the table.
struct Cell {
  int pairs = 0, found = 0, wrong = 0;
  std::vector<double> degrees, metres;
};

// `make` of a seed: two sessions. `same_room`: an alignment near the truth is right.
template <class Make>
Cell Try(const Kind& kind, const char* what, int pairs, bool same_room, const Make& make) {
  Cell cell{.pairs = pairs};
  std::mutex mutex;
  detail::ParallelFor(static_cast<std::size_t>(pairs), 1, 0, [&](std::size_t begin, std::size_t end) {
    for (std::size_t seed = begin; seed < end; ++seed) {
      SyntheticOptions options = make(1000 * kind.number + seed);
      options.threads = 1;
      const Outcome outcome = AlignSessions(SynthesizeSessions(options), {.threads = 1});
      const bool right = same_room && outcome.found();
      const std::scoped_lock lock(mutex);
      cell.found += right ? 1 : 0;
      cell.wrong += outcome.aligned() && !right ? 1 : 0;
      if (right) cell.degrees.push_back(outcome.error.degrees), cell.metres.push_back(outcome.error.metres);
      if (right != same_room || (outcome.aligned() && !right))
        std::cerr << kind.name << ", " << what << ", seed " << seed << ": " << Describe(outcome) << '\n';
    }
  });
  return cell;
}

void PrintRow(const Kind& kind, int seeds, int wrong_pairs) {
  std::cout << "| " << kind.name;
  int wrong = 0, pairs = 0;
  std::vector<double> degrees, metres;
  for (const double overlap : kOverlaps) {
    const Cell cell = Try(kind, ("overlap " + std::to_string(overlap)).c_str(), seeds, true, [&](std::uint64_t seed) {
      return PairOfSessions(kind.sensor, kind.inertial, overlap, seed);
    });
    std::cout << " | " << cell.found;
    wrong += cell.wrong;
    pairs += cell.pairs;
    if (overlap < 0.2) continue;
    degrees.insert(degrees.end(), cell.degrees.begin(), cell.degrees.end());
    metres.insert(metres.end(), cell.metres.begin(), cell.metres.end());
  }
  std::cout << " | " << detail::MedianOf(degrees) << ", " << 1000 * detail::MedianOf(metres) << " | " << wrong << " of "
            << pairs;
  const Cell disjoint = Try(kind, "disjoint", wrong_pairs, false,
                            [&](std::uint64_t seed) { return PairOfSessions(kind.sensor, kind.inertial, 0, seed); });
  const Cell alike = Try(kind, "look-alike", wrong_pairs, false,
                         [&](std::uint64_t seed) { return PairOfLookAlikes(kind.sensor, kind.inertial, seed); });
  std::cout << " | " << disjoint.wrong << " of " << disjoint.pairs << " | " << alike.wrong << " of " << alike.pairs
            << " |\n"
            << std::flush;
}

}  // namespace
}  // namespace slamdb::testing

int main(int argc, char** argv) {
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 20, wrong_pairs = argc > 2 ? std::atoi(argv[2]) : 63;
  std::cout.precision(2);
  std::cout << "| sensor | 10 % | 20 % | 30 % | 50 % | 70 % | 90 % | degrees, mm | wrong | wrong, disjoint | wrong, "
               "look-alike |\n|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const auto& kind : slamdb::testing::kKinds) slamdb::testing::PrintRow(kind, seeds, wrong_pairs);
}
