// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/detail/concat.h"
#include "slamdb/formats/format.h"
#include "slamdb/formats/postgresql/detail/base_atlas.h"
#include "slamdb/formats/postgresql/detail/connection.h"
#include "slamdb/formats/postgresql/detail/kept_rows.h"
#include "slamdb/formats/postgresql/detail/names.h"
#include "slamdb/formats/rows/detail/list_order.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/detail/row_hash.h"

// What load.cc is made of. The calling thread reads; what it reads is decoded and held against its hashes by all
// threads, and comes into the lists in order.
namespace slamdb::postgresql {

// A row by its hashes.
struct HashedRow {
  std::int64_t row = 0, hash = 0, details = 0;
};

// An entity of a list.
template <class Entity>
struct Decoded {
  HashedRow row;
  std::size_t map = 0;  // index of its map
  Entity entity;
};

// A map while it is loaded.
struct MapRows {
  std::int64_t row = 0;
  std::vector<std::int64_t> keyframes, points, landmarks;  // rows, ascending
  rows::ListOrder keyframe_order, point_order, landmark_order;
};

class Loader {
 public:
  // With a `base` all is loaded, whatever the options select.
  Loader(Connection& connection, const Named& named, const ReadOptions& options, const BaseAtlas* base = nullptr);
  Atlas Run();

 private:
  // ---- what is no list (load.cc)
  void LoadHeader();
  void LoadCameras();
  void LoadMaps();
  void LoadRepeated();
  std::vector<RepeatedEntry>* ListNamed(std::string_view list, std::int64_t map);
  void SortLists();
  void CheckHash();

  // ---- the lists (load_lists.cc)
  void LoadKeyframes();
  void LoadPoints();
  void LoadLandmarks();
  // What rows are decoded with.
  struct Buffers {
    std::vector<std::int64_t> ids;
    std::vector<std::int32_t> left, right;
  };
  // Sets entity and row. False: it is not selected.
  bool Decode(const Row& row, Buffers& buffers, Decoded<KeyFrame>& keyframe) const;
  bool Decode(const Row& row, Buffers& buffers, Decoded<MapPoint>& point) const;
  bool Decode(const Row& row, Buffers& buffers, Decoded<Landmark>& landmark) const;
  template <class Entity>
  std::vector<Decoded<Entity>> DecodeAll(const KeptRows& rows) const;
  // Puts it at the end of its list.
  void Append(Decoded<KeyFrame>&& keyframe);
  void Append(Decoded<MapPoint>&& point);
  void Append(Decoded<Landmark>&& landmark);
  template <class Entity>
  void LoadAll(std::string_view columns, std::string_view table);
  // What the base has is taken, the rest alone is sent. `details` is the column of the second hash.
  template <class Entity>
  void LoadMissing(std::string_view columns, std::string_view table, std::string_view details,
                   const ByHash<Entity>& there);
  // The hashes of rows, by row.
  std::vector<HashedRow> ReadHashes(std::string_view table, std::string_view key, std::string_view details);

  // ---- features, which are most of an atlas (load_features.cc)
  struct Place {
    std::size_t map = 0, index = 0;
  };
  class Due;
  struct Missing;
  void LoadFeatures();
  // Some keyframes a question: only those that are selected, or that the base does not have; or from another server,
  // which would be asked for each picture by itself.
  void LoadFeaturesInBatches();
  std::vector<Missing> FindMissing();
  std::map<Uuid, const KeyFrame*> PicturesOfBase(const std::vector<Missing>& missing) const;
  void FetchFeatures(std::span<const Missing> missing, const std::map<Uuid, const KeyFrame*>& pictures);
  void FetchPictures(const std::vector<Uuid>& wanted, std::map<Uuid, std::string>& columns);
  Uuid UuidOf(Bytes bytes) const;
  void Unpack(const Place& place, std::int64_t hash, Bytes points, Bytes picture);

  // ---- what all do
  // Which rows are of the revision, as SQL.
  std::string Mine() const;
  // ` AND row BETWEEN ...` where one map alone is wanted, so that nothing else is sent.
  std::string OfMap(std::string_view row = "row") const;
  // Of a map by its row; as many as there are: it is not selected.
  std::size_t IndexOf(std::int64_t map) const;
  Error Damaged(std::string_view table, std::int64_t row, const std::string& problem = {}) const;
  // Runs `decode`, and says where when bytes are damaged.
  template <class Decode>
  auto At(std::string_view table, std::int64_t row, const Decode& decode) const {
    try {
      return decode();
    } catch (const Error& error) {
      if (!error.path().empty() || error.kind() != ErrorKind::kDamaged) throw;
      throw Damaged(table, row, error.problem());
    }
  }
  void RequireSame(std::string_view table, std::int64_t row, bool same) const {
    if (!same) throw Damaged(table, row);
  }
  Boxed<Carried> CarriedIn(const Row& row, std::size_t column, std::string_view table, std::int64_t number) const;

  Connection& connection_;
  const ReadOptions& options_;
  const Selection& selection_;
  Named named_;
  bool is_remote_ = false;  // its rows are on another server
  Atlas atlas_;
  detail::AtlasHashes hashes_;
  std::vector<MapRows> maps_;
  std::vector<std::int64_t> stored_header_hashes_;
  std::int64_t hash_ = 0;  // of the revision
  const BaseAtlas* base_;  // null: there is none
};

}  // namespace slamdb::postgresql
