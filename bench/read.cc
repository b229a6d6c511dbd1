// SPDX-License-Identifier: BSD-3-Clause
// slamdb_read_bench FILE: for each line of standard input, a number, reads the atlas so many times, on one core, and
// prints the seconds of processor time that took. bench/python.py holds Python's slamdb.read against it.
#include <time.h>

#include <cstdio>
#include <exception>
#include <iostream>
#include <string>

#include "slamdb/formats/formats.h"

namespace {

double ProcessorSeconds() {
  timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  constexpr double kNano = 1e-9;
  return static_cast<double>(now.tv_sec) + kNano * static_cast<double>(now.tv_nsec);
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 2) return 2;
  for (std::string line; std::getline(std::cin, line);) {
    const double before = ProcessorSeconds();
    for (int left = std::stoi(line); left > 0; --left)
      (void)slamdb::ReadAtlas(argv[1], {.threads = 1});  // and lets go of it
    std::printf("%.9f\n", ProcessorSeconds() - before);
    std::fflush(stdout);
  }
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
