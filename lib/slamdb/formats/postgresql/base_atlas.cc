// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/postgresql/detail/base_atlas.h"

#include "slamdb/base/detail/hash.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/formats/rows/detail/features_blob.h"

namespace slamdb::postgresql {

BaseAtlas::BaseAtlas(const Atlas& atlas, int threads) {
  const detail::AtlasHashes hashes = detail::HashesOf(atlas, threads);
  for (std::size_t i = 0; i < atlas.maps.size(); ++i) {
    const Map& map = atlas.maps[i];
    const detail::AtlasHashes::OfMap& of = hashes.maps[i];
    for (std::size_t k = 0; k < map.keyframes.size(); ++k) {
      keyframes.Add(of.keyframes[k], of.links[k], map.keyframes[k]);
      features.Add(of.features[k], of.features[k], map.keyframes[k]);
      by_id[map.keyframes[k].id.value()] = &map.keyframes[k];
    }
    for (std::size_t k = 0; k < map.points.size(); ++k) points.Add(of.points[k], of.observations[k], map.points[k]);
    for (std::size_t k = 0; k < map.landmarks.size(); ++k)
      landmarks.Add(of.landmarks[k], of.landmarks[k], map.landmarks[k]);
  }
}

std::map<Uuid, const KeyFrame*> ByPicture(std::span<const KeyFrame* const> keyframes, int threads) {
  std::vector<Uuid> hashes(keyframes.size());
  detail::ParallelFor(keyframes.size(), 4, threads, [&](std::size_t begin, std::size_t end) {
    detail::ByteWriter out;
    for (std::size_t i = begin; i < end; ++i) {
      out.Clear();
      rows::EncodePicture(*keyframes[i], out);
      hashes[i] = detail::Hash128(out.bytes());
    }
  });
  std::map<Uuid, const KeyFrame*> found;
  for (std::size_t i = 0; i < keyframes.size(); ++i) found[hashes[i]] = keyframes[i];
  return found;
}

}  // namespace slamdb::postgresql
