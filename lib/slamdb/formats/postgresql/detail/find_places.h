// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "slamdb/formats/postgresql/detail/connection.h"
#include "slamdb/formats/postgresql/detail/partition.h"
#include "slamdb/formats/rows/detail/place_table.h"

// Which atlases know a picture (Store::PlacesLike), in two steps:
//   1. The server holds it against all rows of `place`, an eighth of a store's keyframes, and names those most like it.
//   2. Of their maps the keyframes are fetched and compared one by one (rows/place_table.h).
// A store of few places is fetched as a whole.
namespace slamdb::postgresql {

using MapKey = std::pair<std::int64_t, std::int64_t>;  // atlas and row of a map

class PlaceFinder {
 public:
  PlaceFinder(std::span<const std::span<const Descriptor>> pictures, const PlaceOptions& options);

  // To be called for every partition, or once for all, Partition(); in the caller's transaction. What it throws leaves
  // all as it was.
  void Read(Connection& connection, const Partition& partition);
  StoredPlaces Find() &&;

 private:
  // What one partition has.
  struct Part {
    std::map<MapKey, rows::PlaceMap> maps;
    std::map<MapKey, std::vector<rows::PlaceKeyframe>> keyframes;
    std::vector<rows::PlaceWords> others;
  };

  std::set<MapKey> MapsLikeAny(Connection& connection, const Partition& partition) const;
  // `only`: null for all maps.
  static void ReadMaps(Connection& connection, const Partition& partition, const std::set<MapKey>* only, Part& part);

  const PlaceOptions& options_;
  std::vector<rows::PlaceWords> pictures_;
  std::map<std::int64_t, rows::PlaceMap> maps_;
  std::vector<rows::PlaceKeyframe> keyframes_;
  std::vector<rows::PlaceWords> others_;  // keyframes of the store at large
};

}  // namespace slamdb::postgresql
