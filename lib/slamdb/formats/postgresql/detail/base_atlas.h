// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "slamdb/formats/postgresql/detail/parameter.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/detail/row_hash.h"

// An atlas that is at hand while another one is loaded, by the hashes of what is in it: what both have need not be
// sent.
namespace slamdb::postgresql {

// Entities by the hashes of their row and of what hangs on it; once more the same where nothing does.
template <class Entity>
class ByHash {
 public:
  void Add(std::int64_t hash, std::int64_t details, const Entity& entity) { all_[hash] = {details, &entity}; }
  // Null: there is none.
  const Entity* Find(std::int64_t hash, std::int64_t details) const {
    const auto found = all_.find(hash);
    return found != all_.end() && found->second.first == details ? found->second.second : nullptr;
  }

 private:
  std::unordered_map<std::int64_t, std::pair<std::int64_t, const Entity*>> all_;
};

// Keeps addresses in the atlas.
struct BaseAtlas {
  BaseAtlas(const Atlas& atlas, int threads);

  ByHash<KeyFrame> keyframes, features;  // features: keyframes by the hash of theirs
  ByHash<MapPoint> points;
  ByHash<Landmark> landmarks;
  std::unordered_map<std::uint64_t, const KeyFrame*> by_id;
};

// Keyframes by the hashes of their pictures, as a store has them.
std::map<Uuid, const KeyFrame*> ByPicture(std::span<const KeyFrame* const> keyframes, int threads);

}  // namespace slamdb::postgresql
