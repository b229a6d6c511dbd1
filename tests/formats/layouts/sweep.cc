// SPDX-License-Identifier: BSD-3-Clause
#include <chrono>
#include <cstdio>
#include <map>
#include <string>

#include "slamdb/base/error.h"
#include "slamdb/formats/orbslam3/infer_layout.h"
#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "tests/formats/layouts/invented_layouts.h"

// How many invented layouts are found: layouts_sweep ATLAS INSERTIONS REMOVALS FIRST COUNT [CLASS...]
//   exact  read as the fork's own layout reads it, and written back byte for byte
//   core   the same keyframes, points and observations, written back byte for byte
//   other  written back byte for byte, and read as something else
namespace {

using namespace slamdb;

Atlas ReadIn(const std::string& bytes, const Layout& layout) {
  Notices notices;
  ReadOptions options;
  options.of<Orbslam3ReadOptions>().layout = ToJson(layout);
  return ReadOrbslam3({std::as_bytes(std::span(bytes)), "forged"}, options, notices);
}

std::string Try(const std::string& bytes, const Layout& layout) {
  const Atlas expected = ReadIn(bytes, layout);
  try {
    const InferredLayout inferred = InferLayout({std::as_bytes(std::span(bytes)), "forged"});
    if (std::getenv("SWEEP_SHOW") != nullptr)
      for (const auto* list : {&inferred.differences, &inferred.alternatives, &inferred.doubts})
        for (const std::string& line : *list) std::printf("    %s\n", line.c_str());
    if (!inferred.same_bytes) return "bytes";
    const Atlas found = ReadIn(bytes, inferred.layout);
    if (testing::OwnBytes(found) == testing::OwnBytes(expected)) return "exact";
    return testing::SameCore(found, expected) ? "core" : "other";
  } catch (const Error& error) {
    return std::string("none: ") + error.what();
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 6) {
    std::fputs("layouts_sweep ATLAS INSERTIONS REMOVALS FIRST COUNT [CLASS...]\n", stderr);
    return 2;
  }
  Notices notices;
  const Atlas atlas = ReadOrbslam3(argv[1], {}, notices);
  testing::InventionOptions options{std::stoi(argv[2]), std::stoi(argv[3]), {argv + 6, argv + argc}};
  std::map<std::string, int> counts;
  double slowest = 0;
  for (std::uint64_t seed = std::stoull(argv[4]), end = seed + std::stoull(argv[5]); seed < end; ++seed) {
    std::mt19937_64 random(seed);
    const testing::Invention invention = testing::InventLayout(random, options);
    const std::string bytes = testing::Forge(atlas, invention.layout, random);
    const auto start = std::chrono::steady_clock::now();
    const std::string result = Try(bytes, invention.layout);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    slowest = std::max(slowest, seconds);
    ++counts[result.substr(0, result.find(':'))];
    std::printf("%llu %s %.1f s", static_cast<unsigned long long>(seed), result.c_str(), seconds);
    for (const std::string& change : invention.changes) std::printf("  %s", change.c_str());
    std::printf("\n");
    std::fflush(stdout);
  }
  for (const auto& [result, count] : counts) std::printf("%s %d\n", result.c_str(), count);
  std::printf("slowest %.1f s\n", slowest);
}
