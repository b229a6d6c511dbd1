// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <span>

#include "slamdb/base/detail/parallel.h"
#include "slamdb/base/detail/task_queue.h"
#include "slamdb/formats/postgresql/detail/loader.h"
#include "slamdb/formats/rows/detail/features_blob.h"

namespace slamdb::postgresql {
namespace {

using detail::Concat;

constexpr std::size_t kFeaturesOfPiece = 8;  // keyframes that a thread unpacks at once
constexpr std::size_t kFeaturesAtOnce = 64;  // that are asked for by their numbers

std::string TextOf(Bytes bytes) { return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()); }

// What the row has of them.
Features CountsOf(const KeyFrame& keyframe) {
  const Features& all = keyframe.features;
  return {.count = all.count, .left_count = all.left_count, .right_count = all.right_count};
}

void TakeFeatures(const KeyFrame& from, KeyFrame& to) {
  const Features counts = CountsOf(to);
  to.features = from.features;
  to.features.count = counts.count;
  to.features.left_count = counts.left_count;
  to.features.right_count = counts.right_count;
}

}  // namespace

// The keyframes whose features are to come, by row.
class Loader::Due {
 public:
  explicit Due(const std::vector<MapRows>& maps) {
    for (std::size_t i = 0; i < maps.size(); ++i)
      for (std::size_t k = 0; k < maps[i].keyframes.size(); ++k) all_.push_back({maps[i].keyframes[k], {i, k}});
    std::ranges::sort(all_, {}, &Entry::row);
  }
  std::size_t size() const { return all_.size(); }
  bool is_empty() const { return next_ == all_.size(); }
  std::int64_t row() const { return all_[next_].row; }  // of the next
  Place Take() { return all_[next_++].place; }

 private:
  struct Entry {
    std::int64_t row = 0;
    Place place;
  };
  std::vector<Entry> all_;
  std::size_t next_ = 0;
};

void Loader::LoadFeatures() {
  struct Piece {
    KeptRows rows;
    std::vector<Place> places;
  };
  Due due(maps_);
  CopyReader reader(
      connection_,
      Concat("SELECT keyframe, hash, points, (SELECT columns FROM picture WHERE picture.atlas = ", named_.atlas,
             " AND picture.hash = features.picture) FROM keyframe_features AS features WHERE ", Mine(),
             OfMap("keyframe"), " ORDER BY keyframe"),
      "table keyframe_features");
  detail::TaskQueue queue(options_.threads);
  std::size_t done = 0;
  auto piece = std::make_shared<Piece>();
  const auto unpack = [&] {
    if (piece->places.empty()) return;
    queue.Do([this, taken = std::exchange(piece, std::make_shared<Piece>())] {
      for (std::size_t k = 0; k < taken->places.size(); ++k) {
        const Row row = taken->rows[k];
        Unpack(taken->places[k], row.Integer(1), row.Blob(2), row.Blob(3));
      }
    });
    if (options_.progress) options_.progress("loading", static_cast<double>(done) / static_cast<double>(due.size()));
  };
  // A failure of what was read before comes first.
  const auto missing = [&](std::int64_t row) {
    unpack();
    queue.Finish();
    return Damaged("keyframe_features", row, "missing");
  };
  while (reader.Next()) {
    const Row row = reader.row();
    if (due.is_empty() || row.Integer(0) < due.row()) continue;  // not selected
    if (row.Integer(0) != due.row() || row.IsNull(3)) throw missing(due.row());
    piece->rows.Keep(reader);
    piece->places.push_back(due.Take());
    ++done;
    if (piece->places.size() == kFeaturesOfPiece) unpack();
  }
  if (!due.is_empty()) throw missing(due.row());
  unpack();
  queue.Finish();
}

void Loader::Unpack(const Place& place, std::int64_t hash, Bytes points, Bytes picture) {
  const std::int64_t row = maps_[place.map].keyframes[place.index];
  KeyFrame& keyframe = atlas_.maps[place.map].keyframes[place.index];
  At("keyframe_features", row, [&] { rows::DecodeFeatures(picture, points, keyframe); });
  const std::int64_t found = detail::HashOfFeatures(keyframe);
  RequireSame("keyframe_features", row, found == hash);
  hashes_.maps[place.map].features[place.index] = found;
}

// ---- in batches

// Which keyframe, and the hash that its features are to have.
struct Loader::Missing {
  Place place;
  std::int64_t row = 0, hash = 0;
};

void Loader::LoadFeaturesInBatches() {
  const std::vector<Missing> missing = FindMissing();
  const auto pictures = base_ == nullptr ? std::map<Uuid, const KeyFrame*>() : PicturesOfBase(missing);
  for (std::size_t begin = 0; begin < missing.size(); begin += kFeaturesAtOnce) {
    const std::size_t count = std::min(kFeaturesAtOnce, missing.size() - begin);
    FetchFeatures(std::span(missing).subspan(begin, count), pictures);
    if (options_.progress)
      options_.progress("loading", static_cast<double>(begin + count) / static_cast<double>(missing.size()));
  }
}

// Takes those that the base has.
std::vector<Loader::Missing> Loader::FindMissing() {
  std::vector<Missing> missing;
  Due due(maps_);
  for (const HashedRow& row : ReadHashes("keyframe_features", "keyframe", "hash")) {
    if (due.is_empty() || row.row < due.row()) continue;  // not selected
    if (row.row != due.row()) break;
    const Place place = due.Take();
    const KeyFrame* same = base_ == nullptr ? nullptr : base_->features.Find(row.hash, row.details);
    if (same == nullptr) {
      missing.push_back({place, row.row, row.hash});
    } else {
      TakeFeatures(*same, atlas_.maps[place.map].keyframes[place.index]);
      hashes_.maps[place.map].features[place.index] = row.hash;
    }
  }
  if (!due.is_empty()) throw Damaged("keyframe_features", due.row(), "missing");
  return missing;
}

// What is another keypoint's point by now is mostly the same picture.
std::map<Uuid, const KeyFrame*> Loader::PicturesOfBase(const std::vector<Missing>& missing) const {
  std::vector<const KeyFrame*> candidates;
  for (const Missing& each : missing) {
    const auto found = base_->by_id.find(atlas_.maps[each.place.map].keyframes[each.place.index].id.value());
    if (found != base_->by_id.end()) candidates.push_back(found->second);
  }
  return ByPicture(candidates, options_.threads);
}

void Loader::FetchFeatures(std::span<const Missing> missing, const std::map<Uuid, const KeyFrame*>& pictures) {
  std::vector<std::int64_t> keyframes;
  for (const Missing& each : missing) keyframes.push_back(each.row);
  std::ranges::sort(keyframes);
  const Result found = connection_.Query(
      Concat("SELECT keyframe, points, picture FROM keyframe_features WHERE ", Mine(), " AND keyframe = ANY ($1)"),
      {std::span<const std::int64_t>(keyframes)}, "table keyframe_features");
  std::map<std::int64_t, std::size_t> by_keyframe;
  std::map<Uuid, std::string> columns;
  std::vector<Uuid> picture_of(found.rows()), wanted;
  for (std::size_t i = 0; i < found.rows(); ++i) {
    by_keyframe[found[i].Integer(0)] = i;
    picture_of[i] = UuidOf(found[i].Blob(2));
    if (!columns.try_emplace(picture_of[i]).second) continue;
    if (const auto same = pictures.find(picture_of[i]); same != pictures.end()) {
      detail::ByteWriter out;
      rows::EncodePicture(*same->second, out);
      columns[picture_of[i]] = out.Take();
    } else {
      wanted.push_back(picture_of[i]);
    }
  }
  FetchPictures(wanted, columns);
  for (const Missing& each : missing)
    if (!by_keyframe.contains(each.row)) throw Damaged("keyframe_features", each.row, "missing");
  detail::ParallelFor(missing.size(), 4, options_.threads, [&](std::size_t begin, std::size_t end) {
    for (const Missing& each : missing.subspan(begin, end - begin)) {
      const std::size_t at = by_keyframe.at(each.row);
      Unpack(each.place, each.hash, found[at].Blob(1), std::as_bytes(std::span(columns.at(picture_of[at]))));
    }
  });
}

void Loader::FetchPictures(const std::vector<Uuid>& wanted, std::map<Uuid, std::string>& columns) {
  if (wanted.empty()) return;
  const Result found = connection_.Query(
      Concat("SELECT hash, columns FROM picture WHERE atlas = ", named_.atlas, " AND hash = ANY ($1)"),
      {std::span<const Uuid>(wanted)}, "table picture");
  for (std::size_t i = 0; i < found.rows(); ++i) {
    columns[UuidOf(found[i].Blob(0))] = TextOf(found[i].Blob(1));
  }
}
Uuid Loader::UuidOf(Bytes bytes) const {
  Uuid uuid{};
  if (bytes.size() != uuid.size()) throw Damaged("picture", 0, "a hash of another length");
  std::ranges::copy(bytes, uuid.begin());
  return uuid;
}

}  // namespace slamdb::postgresql
