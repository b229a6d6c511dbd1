// SPDX-License-Identifier: BSD-3-Clause
// A program with archives of its own, of stock Boost.Serialization, that hold slamdb's types.
//
//   boost_archive map.osa folder
//
// keeps the best seen points of an ORB-SLAM3 atlas in folder/landmarks.bin, together with what only this program knows
// of them, reads them back, and writes the atlas to folder/copy.osa, which ORB-SLAM3 and slamdb read.

#include <algorithm>
#include <boost/archive/binary_iarchive.hpp>
#include <boost/archive/binary_oarchive.hpp>
#include <boost/serialization/string.hpp>
#include <boost/serialization/vector.hpp>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include "slamdb/boost.h"

namespace {

// The program's own class: a map point and what it knows of it.
struct Landmark {
  slamdb::MapPoint point;
  std::string name;
  double confidence = 0;

  template <class Archive>
  void serialize(Archive& archive, const unsigned int /*version*/) {
    archive& point& name& confidence;
  }
};

struct Logbook {
  std::string robot;
  slamdb::Camera camera;
  std::vector<Landmark> landmarks;

  template <class Archive>
  void serialize(Archive& archive, const unsigned int /*version*/) {
    archive& robot& camera& landmarks;
  }
};

template <class Value>
Value Load(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  boost::archive::binary_iarchive archive(stream);
  Value value;
  archive >> value;
  return value;
}

template <class Value>
void Save(const Value& value, const std::string& path) {
  std::ofstream stream(path, std::ios::binary);
  boost::archive::binary_oarchive archive(stream);
  archive << value;
}

Logbook WriteUp(const slamdb::Atlas& atlas) {
  Logbook logbook{.robot = "robot 7", .camera = atlas.cameras.at(0), .landmarks = {}};
  for (const slamdb::Map& map : atlas.maps) {
    for (const slamdb::MapPoint& point : map.points) {
      if (point.observations.size() < 5) continue;
      const double confidence = 1 - 1 / static_cast<double>(point.observations.size());
      logbook.landmarks.push_back({point, "landmark " + std::to_string(point.id.value()), confidence});
    }
  }
  return logbook;
}

}  // namespace

int main(int count, char** arguments) try {
  if (count != 3) {
    std::cerr << "usage: boost_archive map.osa folder\n";
    return 2;
  }
  const std::string folder = arguments[2];
  const auto atlas = Load<slamdb::Atlas>(arguments[1]);
  Save(WriteUp(atlas), folder + "/landmarks.bin");

  const auto logbook = Load<Logbook>(folder + "/landmarks.bin");
  std::cout << logbook.robot << " with a camera of focal length " << logbook.camera.parameters.at(0) << " knows "
            << logbook.landmarks.size() << " landmarks\n";
  const auto best = std::ranges::max_element(logbook.landmarks, {}, &Landmark::confidence);
  if (best == logbook.landmarks.end()) return 1;
  std::cout << "best is " << best->name << " at " << best->point.position.transpose() << ", seen by "
            << best->point.observations.size() << " keyframes\n";

  Save(atlas, folder + "/copy.osa");
  return 0;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
