// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "slamdb/model/features.h"
#include "slamdb/model/ids.h"

namespace slamdb {

// A keyframe of a store that looks like a picture.
struct StoredPlace {
  std::string atlas;  // its name
  MapId map;
  KeyFrameId keyframe;
  // How much more it and its neighbours have in common with the picture than chance gives: standard deviations, summed
  // over the keyframe and three on each side. Pictures of other places come to 6 to 11.
  double likeness = 0;
};

struct PlaceOptions {
  std::size_t places = 6;  // that are most alike, for each picture; their maps are those that are answered
  std::size_t of_map = 3;  // places of each of these maps at most
  bool faint = false;      // also places of a likeness that chance may give, beside ones that are much more alike
  std::vector<std::string> without;  // atlases that are passed over
  int threads = 0;                   // 0: every core
};

struct StoredPlaces {
  std::vector<std::vector<StoredPlace>> by_picture;  // the most alike first
  // Atlases of which the store does not know what all their keyframes look like, ascending: the places of these are not
  // among the answers.
  std::vector<std::string> unknown;
  // Those of a fleet whose server does not answer, ascending.
  std::vector<std::string> unreachable;
};

}  // namespace slamdb
