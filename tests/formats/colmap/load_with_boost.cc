// SPDX-License-Identifier: BSD-3-Clause
// load_with_boost ATLAS: loads an .osa file as ORB-SLAM3 does, with stock Boost.Serialization, and says what is in it.
#include <exception>
#include <iostream>

#include "tests/support/boost_reference/boost_reference.h"

int main(int argc, char** argv) try {
  if (argc != 2) return 2;
  const slamdb::Atlas atlas = slamdb::reference::Load(argv[1], slamdb::reference::Encoding::kBinary);
  std::size_t keyframes = 0, points = 0;
  for (const slamdb::Map& map : atlas.maps) {
    keyframes += map.keyframes.size();
    points += map.points.size();
  }
  std::cout << atlas.maps.size() << " maps, " << keyframes << " keyframes, " << points << " points\n";
  return keyframes > 0 ? 0 : 1;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
