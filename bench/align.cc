// SPDX-License-Identifier: BSD-3-Clause
// slamdb_align_bench [KEYFRAMES POINTS]...: two made sessions of so many keyframes and points, which share a third of
// their arc, aligned, joined, fused, and optimised at the seam; a row of a Markdown table each.
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>

#include "slamdb/align/optimize_joined.h"
#include "slamdb/synthetic/synthesize.h"

namespace slamdb {
namespace {

SyntheticSessions MakeSessions(std::size_t keyframes, std::size_t points) {
  SyntheticOptions options{.sensor = Sensor::kRgbd, .maps = 2};
  options.keyframes = keyframes;
  options.points = points;
  options.features = 1000;
  options.flipped_bits = 24;
  options.outliers = 0.04;
  options.sessions = SessionOptions{.overlap = 0.3};
  return SynthesizeSessions(options);
}

// Wall clock, and of all cores.
struct Spent {
  std::chrono::steady_clock::time_point begin = std::chrono::steady_clock::now();
  std::clock_t cores = std::clock();

  std::string Text() const {
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "%.2f s, %.2f s of cores",
                  std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(),
                  static_cast<double>(std::clock() - cores) / CLOCKS_PER_SEC);
    return text.data();
  }
};

double PeakMegabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

void Measure(std::size_t keyframes, std::size_t points) {
  Atlas atlas = MakeSessions(keyframes, points).atlas;
  const double before = PeakMegabytes();
  const Spent spent;
  const JoinAlignedReport joined = JoinAlignedMaps(atlas);
  const std::string joining = spent.Text();
  if (joined.joins.empty()) {
    std::printf("| %zu, %zu | not joined: %s |\n", keyframes, points,
                joined.aligned.links.front().alignment.reason.c_str());
    return;
  }
  const double memory = PeakMegabytes() - before;
  const auto tighten = [&](OptimizeMethod method) {
    Atlas copy = atlas;
    const Spent tightening;
    if (CanOptimize()) OptimizeJoined(copy, joined, {.method = method});
    return tightening.Text();
  };
  const std::string graph = tighten(OptimizeMethod::kPoseGraph), seam = tighten(OptimizeMethod::kSeam);
  std::printf("| %zu, %zu | %s | %s | %s | %.0f MB |\n", keyframes, points, joining.c_str(), graph.c_str(),
              seam.c_str(), memory);
}

// In a process of its own, whose peak of memory is its own.
void MeasureApart(std::size_t keyframes, std::size_t points) {
  std::fflush(stdout);
  const pid_t child = fork();
  if (child == 0) {
    Measure(keyframes, points);
    std::fflush(stdout);
    _exit(0);
  }
  waitpid(child, nullptr, 0);
}

}  // namespace
}  // namespace slamdb

int main(int count, char** values) {
  std::puts(
      "| keyframes, points of each | align, join, fuse | pose graph, search | seam | memory |\n|---|---|---|---|---|");
  if (count < 3) slamdb::MeasureApart(500, 50000);
  for (int i = 1; i + 1 < count; i += 2)
    slamdb::MeasureApart(std::strtoull(values[i], nullptr, 10), std::strtoull(values[i + 1], nullptr, 10));
  return 0;
}
