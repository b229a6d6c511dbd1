// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <type_traits>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/hash.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/base/detail/pipeline.h"
#include "slamdb/formats/postgresql/detail/save.h"
#include "slamdb/formats/rows/detail/features_blob.h"

// Features: packed on all threads, sent by the calling one.
namespace slamdb::postgresql {

using detail::Concat;
using rows::Value;

namespace {

std::set<Uuid> StoredPictures(SaveContext& context) {
  std::set<Uuid> pictures;
  if (context.is_new || context.rewrites) return pictures;
  context.connection.CopyOut(
      Concat("SELECT hash FROM picture WHERE atlas = ", context.atlas),
      [&](const Row& row) {
        const Bytes bytes = row.Blob(0);
        Uuid hash;
        if (bytes.size() != hash.size())
          throw Error(ErrorKind::kDamaged, context.connection.path(), "table picture", "a hash of another length");
        std::ranges::copy(bytes, hash.begin());
        pictures.insert(hash);
      },
      "table picture");
  return pictures;
}

Uuid HashOfPicture(const KeyFrame& keyframe) {
  detail::ByteWriter out;
  rows::EncodePicture(keyframe, out);
  return detail::Hash128(out.bytes());
}

// Removes those that are written anew.
void RemovePictures(SaveContext& context, const std::vector<MapToSave>& maps, const ListPlaces& changed) {
  std::vector<Uuid> hashes(changed.size());
  detail::ParallelFor(changed.size(), 8, context.options.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n)
      hashes[n] = HashOfPicture(maps[changed[n].first].map.keyframes[changed[n].second]);
  });
  context.connection.Query("DELETE FROM picture WHERE atlas = $1 AND hash = ANY ($2)",
                           {context.atlas, std::span<const Uuid>(hashes)}, "table picture");
}

// Those that the atlas does not have yet; the hash of each that it comes to have.
std::vector<Uuid> WritePictures(SaveContext& context, const std::vector<MapToSave>& maps, const ListPlaces& changed) {
  std::vector<Uuid> hashes(changed.size());
  std::set<Uuid> stored = StoredPictures(context);
  // Those of earlier revisions that are not what their hash says, too, are as they were again where this one has them.
  if (context.rewrites) RemovePictures(context, maps, changed);
  std::optional<CopyIn> copy;  // mostly none is new
  const auto pack = [&](std::size_t n, std::string& bytes) {
    detail::ByteWriter out(std::move(bytes));
    rows::EncodePicture(maps[changed[n].first].map.keyframes[changed[n].second], out);
    hashes[n] = detail::Hash128(out.bytes());
    bytes = out.Take();
  };
  const auto write = [&](std::size_t n, const std::string& bytes) {
    context.Report(100);
    if (!stored.insert(hashes[n]).second) return;
    if (!copy) copy.emplace(context.connection, PictureTable().target, PictureTable().types, context.way());
    copy->Add(std::array<Value, 3>{context.atlas, Bytes(hashes[n]), std::as_bytes(std::span(bytes))});
  };
  detail::ProduceInOrder<std::string>(changed.size(), context.options.threads, pack, write);
  if (copy) copy->Finish();
  return hashes;
}

}  // namespace

std::int64_t SourceHashOf(const KeyFrame& keyframe) {
  detail::ByteWriter out;
  const ImageBounds& bounds = keyframe.bounds;
  static_assert(std::is_trivially_copyable_v<ImageBounds>);
  out.PutBytes(std::as_bytes(std::span(&bounds, 1)));
  out.Put(static_cast<std::uint8_t>(keyframe.features.is_fisheye_stereo()));
  return static_cast<std::int64_t>(detail::HashBytes(out.bytes()));
}

void WriteFeatures(SaveContext& context, const std::vector<MapToSave>& maps, const std::vector<ListPlans>& plans,
                   const ListPlaces& changed) {
  if (changed.empty()) return;
  const std::vector<Uuid> pictures = WritePictures(context, maps, changed);
  CopyIn copy(context.connection, FeaturesTable().target, FeaturesTable().types, context.way());
  detail::ByteWriter points;
  for (std::size_t n = 0; n < changed.size(); ++n) {
    const auto& [i, k] = changed[n];
    const KeyFrame& keyframe = maps[i].map.keyframes[k];
    points.Clear();
    rows::EncodePoints(keyframe, points);
    copy.Add(std::array<Value, 7>{context.atlas, plans[i].keyframes.entries[k].row, maps[i].hashes.features[k],
                                  SourceHashOf(keyframe), points.bytes(), Bytes(pictures[n]), context.revision});
  }
  copy.Finish();
}

}  // namespace slamdb::postgresql
