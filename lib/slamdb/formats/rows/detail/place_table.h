// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "slamdb/formats/rows/detail/place_words.h"
#include "slamdb/formats/rows/places.h"

// What all keyframes of a store look like, and which of them look like a picture (Store::PlacesLike):
// 1. Rows of keyframe_words are read, by map and id of the keyframe, which is their order in time: all of a file, of a
//    server those of the maps that have places like the picture.
// 2. A picture is held against each: the words that both have, weighed by how rare they are in real maps, beside what
//    chance gives for so many words of so rare ones.
// 3. Neighbours in time vote together; the best of them stands for the place.
namespace slamdb::rows {

struct PlaceMap {
  std::string atlas;
  MapId id;
};

struct PlaceKeyframe {
  std::int64_t map = 0;  // key of the map
  std::uint64_t id = 0;
  PlaceWords words{};      // none: it is not asked
  bool is_unknown = true;  // the store has no words of it
};

// `maps`: by what keyframes call them. `keyframes`: in any order. `others`: what the store's keyframes look like at
// large, where `keyframes` are not all of them, but chosen for these pictures.
StoredPlaces FindPlaces(const std::map<std::int64_t, PlaceMap>& maps, std::vector<PlaceKeyframe> keyframes,
                        std::span<const PlaceWords> others, std::span<const PlaceWords> pictures,
                        const PlaceOptions& options);

}  // namespace slamdb::rows
