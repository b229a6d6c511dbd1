// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/postgresql/detail/load.h"

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/formats/postgresql/detail/base_atlas.h"
#include "slamdb/formats/postgresql/detail/big_endian.h"
#include "slamdb/formats/postgresql/detail/schema.h"
#include "slamdb/formats/rows/detail/features_blob.h"
#include "slamdb/formats/rows/detail/keyframe_row.h"
#include "slamdb/formats/rows/detail/landmark_row.h"
#include "slamdb/formats/rows/detail/list_order.h"
#include "slamdb/formats/rows/detail/map_rows.h"
#include "slamdb/formats/rows/detail/plan.h"
#include "slamdb/formats/rows/detail/point_row.h"
#include "slamdb/model/detail/row_hash.h"

namespace slamdb::postgresql {
namespace {

using detail::AtlasHashes;
using detail::Concat;

constexpr std::size_t kFeaturesAtOnce = 64;  // keyframes whose features are held packed
constexpr std::size_t kRowsAtOnce = 4096;    // that are asked for by their numbers

// A row by its hashes.
struct HashedRow {
  std::int64_t row = 0, hash = 0, details = 0;
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
  Loader(Connection& connection, const Named& named, const ReadOptions& options, const BaseAtlas* base = nullptr)
      : connection_(connection), options_(options), selection_(options.selection), named_(named), base_(base) {}

  Atlas Run() {
    LoadHeader();
    LoadCameras();
    LoadMaps();
    LoadRepeated();
    LoadKeyframes();
    if (base_ != nullptr)
      LoadFeaturesOnto();
    else if (options_.features != FeatureColumns::kNone)
      LoadFeatures();
    LoadPoints();
    LoadLandmarks();
    SortLists();
    if (selection_.everything() && options_.features != FeatureColumns::kNone) CheckHash();
    return std::move(atlas_);
  }

 private:
  std::string Mine(std::string_view prefix = {}) const { return InRevision(named_.atlas, named_.number, prefix); }

  Error Damaged(std::string_view table, std::int64_t row, const std::string& problem = {}) const {
    return Error(ErrorKind::kDamaged, connection_.path(), Concat("table ", table, ", row ", row),
                 problem.empty() ? "differs from its hash: the store is damaged, or was edited by another program"
                                 : problem + ": the store is damaged");
  }
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
  Boxed<Carried> CarriedIn(const Row& row, std::size_t column, std::string_view table, std::int64_t number) const {
    if (row.IsNull(column)) return {};
    return At(table, number, [&] { return detail::DecodeCarried(row.Blob(column)); });
  }

  void LoadHeader() {
    const Result found = connection_.Query(
        Concat("SELECT ", rows::kHeaderColumns, ", carried, hash FROM revision WHERE atlas = $1 AND number = $2"),
        {named_.atlas, named_.number}, "table revision");
    if (found.rows() == 0) throw Damaged("revision", named_.number, "missing");
    rows::ReadHeader(found[0], atlas_);
    atlas_.carried = CarriedIn(found[0], 13, "revision", named_.number);
    hash_ = found[0].Integer(14);
  }

  void LoadCameras() {
    const Result found = connection_.Query(
        Concat("SELECT ", rows::kCameraColumns, ", carried FROM camera WHERE ", Mine(), " ORDER BY position"), {},
        "table camera");
    for (std::size_t i = 0; i < found.rows(); ++i) {
      const Row row = found[i];
      const auto number = static_cast<std::int64_t>(i);
      atlas_.cameras.push_back(At("camera", number, [&] { return rows::ReadCamera(row); }));
      atlas_.cameras.back().carried = CarriedIn(row, 6, "camera", number);
    }
  }

  void LoadMaps() {
    const Result found =
        connection_.Query(Concat("SELECT ", rows::kMapColumns,
                                 ", row, origins, keyframe_order, point_order, landmark_order, carried FROM "
                                 "map WHERE ",
                                 Mine(), " ORDER BY position"),
                          {}, "table map");
    for (std::size_t i = 0; i < found.rows(); ++i) {
      const Row row = found[i];
      const std::int64_t number = row.Integer(11);
      if (number < 1 || number > 0x7fffffff) throw Damaged("map", number, "no row number of a map");
      Map map = rows::ReadMap(row);
      if (selection_.map && *selection_.map != map.id) continue;
      std::vector<std::int64_t> origins;
      row.Integers64(12, origins);
      for (const std::int64_t id : origins) map.origins.push_back(KeyFrameId(static_cast<std::uint64_t>(id)));
      map.carried = CarriedIn(row, 16, "map", number);
      stored_header_hashes_.push_back(row.Integer(10));
      const auto order = [&](std::size_t column) {
        return row.IsNull(column) ? rows::ListOrder()
                                  : At("map", number, [&] { return rows::ListOrder(row.Blob(column)); });
      };
      maps_.push_back({number, {}, {}, {}, order(13), order(14), order(15)});
      atlas_.maps.push_back(std::move(map));
    }
    hashes_.maps.resize(maps_.size());
  }

  void LoadRepeated() {
    const Result found =
        connection_.Query(Concat("SELECT position, owner_map, entry, list, map FROM repeated_entry WHERE ", Mine(),
                                 " ORDER BY list, map, sequence"),
                          {}, "table repeated_entry");
    for (std::size_t i = 0; i < found.rows(); ++i) {
      const Row row = found[i];
      if (auto* list = ListNamed(row.Text(3), row.Integer(4))) list->push_back(rows::ReadRepeated(row));
    }
    for (std::size_t i = 0; i < maps_.size(); ++i)
      RequireSame("map", maps_[i].row, detail::HashOfHeader(atlas_.maps[i]) == stored_header_hashes_[i]);
    if (selection_.everything()) return;
    // Their positions and rows mean those of the whole lists.
    atlas_.repeated_maps.clear();
    atlas_.repeated_cameras.clear();
    for (Map& map : atlas_.maps) {
      map.repeated_keyframes.clear();
      map.repeated_points.clear();
    }
  }
  std::vector<RepeatedEntry>* ListNamed(std::string_view list, std::int64_t map) {
    if (list == "maps") return &atlas_.repeated_maps;
    if (list == "cameras") return &atlas_.repeated_cameras;
    const std::size_t i = IndexOf(map);
    if (i == maps_.size()) return nullptr;
    return list == "points" ? &atlas_.maps[i].repeated_points : &atlas_.maps[i].repeated_keyframes;
  }
  // Of a map by its row; as many as there are: it is not selected.
  std::size_t IndexOf(std::int64_t map) const {
    return static_cast<std::size_t>(std::ranges::find(maps_, map, &MapRows::row) - maps_.begin());
  }

  // ` AND map = 3` where one map alone is wanted, so that nothing else is sent.
  std::string OfMap() const {
    return selection_.map && maps_.size() == 1 ? Concat(" AND row BETWEEN ", rows::FirstRowOfMap(maps_[0].row), " AND ",
                                                        rows::LastRowOfMap(maps_[0].row))
                                               : std::string();
  }

  // ---- what the base has

  // The hashes of rows, by row: 24 bytes each, many in one value.
  std::vector<HashedRow> ReadHashes(std::string_view table, std::string_view key, std::string_view details) {
    std::vector<HashedRow> rows;
    connection_.CopyOut(
        Concat("SELECT string_agg(int8send(", key, ") || int8send(hash) || int8send(", details,
               "), ''::bytea ORDER BY ", key, ") FROM ", table, " WHERE ", Mine(), " GROUP BY ", key,
               " >> 12 ORDER BY ", key, " >> 12"),
        [&](const Row& row) {
          const Bytes bytes = row.Blob(0);
          for (std::size_t at = 0; at + 24 <= bytes.size(); at += 24)
            rows.push_back({BigEndian<std::int64_t>(&bytes[at]), BigEndian<std::int64_t>(&bytes[at + 8]),
                            BigEndian<std::int64_t>(&bytes[at + 16])});
        },
        Concat("table ", table));
    return rows;
  }

  // Calls, by row, take(index of the map, row, entity) for what the base has, and visit(index of the map, row) for the
  // rest, which alone is sent.
  template <class Entity, class Visit, class Take>
  void VisitMissing(std::string_view columns, std::string_view table, std::string_view details,
                    const ByHash<Entity>& there, const Visit& visit, const Take& take) {
    const std::vector<HashedRow> rows = ReadHashes(table, "row", details);
    const auto find = [&](const HashedRow& row) { return there.Find(row.hash, row.details); };
    for (std::size_t begin = 0, end = 0; begin < rows.size(); begin = end) {
      std::vector<std::int64_t> missing;
      for (end = begin; end < rows.size() && missing.size() < kRowsAtOnce; ++end)
        if (find(rows[end]) == nullptr) missing.push_back(rows[end].row);
      std::optional<Result> sent;
      if (!missing.empty())
        sent = connection_.Query(
            Concat("SELECT ", columns, " FROM ", table, " WHERE ", Mine(), " AND row = ANY ($1) ORDER BY row"),
            {std::span<const std::int64_t>(missing)}, Concat("table ", table));
      if (sent && sent->rows() != missing.size()) throw Damaged(table, missing.front(), "rows are missing behind it");
      std::size_t next = 0, i = maps_.size();
      for (std::size_t k = begin; k < end; ++k) {
        if (const std::int64_t map = rows::MapOfRow(rows[k].row); i == maps_.size() || maps_[i].row != map)
          i = IndexOf(map);
        if (i == maps_.size()) throw Damaged(table, rows[k].row, "of no map");
        if (const Entity* entity = find(rows[k]))
          take(i, rows[k], *entity);
        else
          visit(i, (*sent)[next++]);
      }
    }
  }

  // Calls visit(index of the map, row) for rows of a list, by row, of the maps that are selected.
  template <class Visit>
  void VisitList(std::string_view columns, std::string_view table, const Visit& visit) {
    std::int64_t map = 0;
    std::size_t i = maps_.size();
    connection_.CopyOut(
        Concat("SELECT ", columns, " FROM ", table, " WHERE ", Mine(), OfMap(), " ORDER BY row"),
        [&](const Row& row) {
          if (const std::int64_t of = rows::MapOfRow(row.Integer(0)); of != map) {
            map = of;
            i = IndexOf(map);
          }
          if (i < maps_.size()) visit(i, row);
        },
        Concat("table ", table));
  }

  void LoadKeyframes() {
    std::vector<std::int64_t> ids;
    std::vector<std::int32_t> weights;
    const auto visit = [&](std::size_t i, const Row& row) {
      const std::int64_t number = row.Integer(0);
      KeyFrame keyframe;
      const bool same = At("keyframe", number, [&] { return rows::ReadKeyframe(row, keyframe); });
      if (!selection_.Has(keyframe)) return;
      const auto read = [&](std::size_t column, auto& list) {
        ids.clear();
        row.Integers64(column, ids);
        list.assign(reinterpret_cast<const KeyFrameId*>(ids.data()),
                    reinterpret_cast<const KeyFrameId*>(ids.data()) + ids.size());
      };
      static_assert(sizeof(KeyFrameId) == sizeof(std::int64_t));
      read(39, keyframe.children);
      read(42, keyframe.loop_edges);
      read(43, keyframe.merge_edges);
      ids.clear();
      weights.clear();
      row.Integers64(40, ids);
      row.Integers32(41, weights);
      RequireSame("keyframe", number, ids.size() == weights.size());
      for (std::size_t k = 0; k < ids.size(); ++k)
        keyframe.connections.push_back({KeyFrameId(static_cast<std::uint64_t>(ids[k])), weights[k]});
      keyframe.carried = CarriedIn(row, 44, "keyframe", number);
      AtlasHashes::OfMap& hashes = hashes_.maps[i];
      hashes.keyframes.push_back(detail::HashOfRow(keyframe));
      hashes.links.push_back(detail::HashOfLinks(keyframe));
      RequireSame("keyframe", number,
                  same && hashes.keyframes.back() == row.Integer(2) && hashes.links.back() == row.Integer(3));
      maps_[i].keyframes.push_back(number);
      atlas_.maps[i].keyframes.push_back(std::move(keyframe));
    };
    const std::string columns =
        Concat(rows::kKeyframeColumns, ", children, connections, weights, loop_edges, merge_edges, carried");
    if (base_ == nullptr)
      VisitList(columns, "keyframe", visit);
    else
      VisitMissing(columns, "keyframe", "links_hash", base_->keyframes, visit,
                   [&](std::size_t i, const HashedRow& row, const KeyFrame& keyframe) {
                     hashes_.maps[i].keyframes.push_back(row.hash);
                     hashes_.maps[i].links.push_back(row.details);
                     maps_[i].keyframes.push_back(row.row);
                     KeyFrame& taken = atlas_.maps[i].keyframes.emplace_back(keyframe);
                     taken.features = CountsOf(keyframe);
                   });
    for (std::size_t i = 0; i < maps_.size(); ++i) hashes_.maps[i].features.resize(maps_[i].keyframes.size());
  }

  // ---- features, which are most of an atlas

  struct Packed {
    std::size_t map, index;
    std::int64_t hash;
    std::string points, picture;
  };

  void LoadFeatures() {
    std::vector<Packed> waiting;
    std::size_t i = 0, next = 0, done = 0, all = 0;  // the keyframe that is due: of map i
    for (const MapRows& map : maps_) all += map.keyframes.size();
    std::vector<std::size_t> by_row(maps_.size());  // maps by their rows, as keyframes come
    for (std::size_t k = 0; k < by_row.size(); ++k) by_row[k] = k;
    std::ranges::sort(by_row, {}, [&](std::size_t k) { return maps_[k].row; });
    const auto skip_ended = [&] {
      while (i < by_row.size() && next == maps_[by_row[i]].keyframes.size()) {
        ++i;
        next = 0;
      }
    };
    skip_ended();
    const std::string of_map = OfMap().empty() ? "" : " AND features.keyframe" + OfMap().substr(sizeof(" AND row") - 1);
    connection_.CopyOut(
        Concat(
            "SELECT keyframe, features.hash, points, columns FROM keyframe_features AS features LEFT JOIN picture ON "
            "picture.atlas = features.atlas AND picture.hash = features.picture WHERE ",
            Mine("features."), of_map, " ORDER BY keyframe"),
        [&](const Row& row) {
          if (i == by_row.size() || row.Integer(0) < maps_[by_row[i]].keyframes[next]) return;  // not selected
          const std::int64_t due = maps_[by_row[i]].keyframes[next];
          if (row.Integer(0) != due || row.IsNull(3)) throw Damaged("keyframe_features", due, "missing");
          waiting.push_back({by_row[i], next++, row.Integer(1), TextOf(row.Blob(2)), TextOf(row.Blob(3))});
          skip_ended();
          if (waiting.size() < kFeaturesAtOnce) return;
          Unpack(waiting);
          done += waiting.size();
          waiting.clear();
          if (options_.progress) options_.progress("loading", static_cast<double>(done) / static_cast<double>(all));
        },
        "table keyframe_features");
    Unpack(waiting);
    if (i < by_row.size()) throw Damaged("keyframe_features", maps_[by_row[i]].keyframes[next], "missing");
  }

  // Whose features the base does not have, and the hash that they are to have.
  struct Missing {
    std::size_t map, index;
    std::int64_t row, hash;
  };

  void LoadFeaturesOnto() {
    std::vector<Missing> missing;
    std::vector<std::size_t> next(maps_.size());
    for (const HashedRow& row : ReadHashes("keyframe_features", "keyframe", "hash")) {
      const std::size_t i = IndexOf(rows::MapOfRow(row.row));
      if (i == maps_.size() || next[i] == maps_[i].keyframes.size() || maps_[i].keyframes[next[i]] != row.row)
        throw Damaged("keyframe_features", row.row, "of no keyframe, or one before it is missing");
      const std::size_t k = next[i]++;
      if (const KeyFrame* same = base_->features.Find(row.hash, row.details)) {
        TakeFeatures(*same, atlas_.maps[i].keyframes[k]);
        hashes_.maps[i].features[k] = row.hash;
      } else {
        missing.push_back({i, k, row.row, row.hash});
      }
    }
    for (std::size_t i = 0; i < maps_.size(); ++i)
      if (next[i] < maps_[i].keyframes.size())
        throw Damaged("keyframe_features", maps_[i].keyframes[next[i]], "missing");
    const std::map<Uuid, const KeyFrame*> pictures = PicturesOfBase(missing);
    for (std::size_t begin = 0; begin < missing.size(); begin += kFeaturesAtOnce) {
      const std::size_t end = std::min(begin + kFeaturesAtOnce, missing.size());
      FetchFeatures(
          {missing.begin() + static_cast<std::ptrdiff_t>(begin), missing.begin() + static_cast<std::ptrdiff_t>(end)},
          pictures);
      if (options_.progress)
        options_.progress("loading", static_cast<double>(end) / static_cast<double>(missing.size()));
    }
  }
  // What the row has of them.
  static Features CountsOf(const KeyFrame& keyframe) {
    const Features& all = keyframe.features;
    return {.count = all.count, .left_count = all.left_count, .right_count = all.right_count};
  }
  static void TakeFeatures(const KeyFrame& from, KeyFrame& to) {
    const Features counts = CountsOf(to);
    to.features = from.features;
    to.features.count = counts.count;
    to.features.left_count = counts.left_count;
    to.features.right_count = counts.right_count;
  }
  // What is another keypoint's point by now is mostly the same picture.
  std::map<Uuid, const KeyFrame*> PicturesOfBase(const std::vector<Missing>& missing) const {
    std::vector<const KeyFrame*> candidates;
    for (const Missing& each : missing) {
      const auto found = base_->by_id.find(atlas_.maps[each.map].keyframes[each.index].id.value());
      if (found != base_->by_id.end()) candidates.push_back(found->second);
    }
    return ByPicture(candidates, options_.threads);
  }
  void FetchFeatures(const std::vector<Missing>& missing, const std::map<Uuid, const KeyFrame*>& pictures) {
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
    std::vector<Packed> packed;
    for (const Missing& each : missing) {
      const auto at = by_keyframe.find(each.row);
      if (at == by_keyframe.end()) throw Damaged("keyframe_features", each.row, "missing");
      packed.push_back(
          {each.map, each.index, each.hash, TextOf(found[at->second].Blob(1)), columns.at(picture_of[at->second])});
    }
    Unpack(packed);
  }
  void FetchPictures(const std::vector<Uuid>& wanted, std::map<Uuid, std::string>& columns) {
    if (wanted.empty()) return;
    const Result found = connection_.Query(
        Concat("SELECT hash, columns FROM picture WHERE atlas = ", named_.atlas, " AND hash = ANY ($1)"),
        {std::span<const Uuid>(wanted)}, "table picture");
    for (std::size_t i = 0; i < found.rows(); ++i) {
      columns[UuidOf(found[i].Blob(0))] = TextOf(found[i].Blob(1));
    }
  }
  Uuid UuidOf(Bytes bytes) const {
    Uuid uuid{};
    if (bytes.size() != uuid.size()) throw Damaged("picture", 0, "a hash of another length");
    std::ranges::copy(bytes, uuid.begin());
    return uuid;
  }
  static std::string TextOf(Bytes bytes) {
    return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }

  void Unpack(const std::vector<Packed>& all) {
    detail::ParallelFor(all.size(), 4, options_.threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        const Packed& each = all[k];
        const std::int64_t row = maps_[each.map].keyframes[each.index];
        KeyFrame& keyframe = atlas_.maps[each.map].keyframes[each.index];
        At("keyframe_features", row, [&] {
          rows::DecodeFeatures(std::as_bytes(std::span(each.picture)), std::as_bytes(std::span(each.points)), keyframe);
        });
        const std::int64_t hash = detail::HashOfFeatures(keyframe);
        RequireSame("keyframe_features", row, hash == each.hash);
        hashes_.maps[each.map].features[each.index] = hash;
      }
    });
  }

  void LoadPoints() {
    std::vector<std::int64_t> seen_by;
    std::vector<std::int32_t> left, right;
    const auto visit = [&](std::size_t i, const Row& row) {
      const std::int64_t number = row.Integer(0);
      MapPoint point;
      const bool same =
          rows::ReadPoint(row, point, [&] { return Damaged("map_point", number, "blob of wrong length"); });
      if (!selection_.Has(point)) return;
      seen_by.clear();
      left.clear();
      right.clear();
      row.Integers64(24, seen_by);
      row.Integers32(25, left);
      row.Integers32(26, right);
      RequireSame("map_point", number, left.size() == seen_by.size() && right.size() == seen_by.size());
      point.observations.reserve(seen_by.size());
      for (std::size_t k = 0; k < seen_by.size(); ++k)
        point.observations.push_back({KeyFrameId(static_cast<std::uint64_t>(seen_by[k])), left[k], right[k]});
      point.carried = CarriedIn(row, 27, "map_point", number);
      AtlasHashes::OfMap& hashes = hashes_.maps[i];
      hashes.points.push_back(detail::HashOfRow(point));
      hashes.observations.push_back(detail::HashOf(point.observations));
      RequireSame("map_point", number,
                  same && hashes.points.back() == row.Integer(2) && hashes.observations.back() == row.Integer(3));
      maps_[i].points.push_back(number);
      atlas_.maps[i].points.push_back(std::move(point));
    };
    const std::string columns = Concat(rows::kPointColumns, ", ", rows::kPointTrackingColumns,
                                       ", seen_by, left_keypoints, right_keypoints, carried");
    if (base_ == nullptr)
      VisitList(columns, "map_point", visit);
    else
      VisitMissing(columns, "map_point", "observations_hash", base_->points, visit,
                   [&](std::size_t i, const HashedRow& row, const MapPoint& point) {
                     hashes_.maps[i].points.push_back(row.hash);
                     hashes_.maps[i].observations.push_back(row.details);
                     maps_[i].points.push_back(row.row);
                     atlas_.maps[i].points.push_back(point);
                   });
  }

  void LoadLandmarks() {
    const auto visit = [&](std::size_t i, const Row& row) {
      const std::int64_t number = row.Integer(0);
      Landmark landmark;
      const bool same = At("landmark", number, [&] {
        return rows::ReadLandmark(row, landmark, [&] { return Damaged("landmark", number, "blob of wrong length"); });
      });
      const std::int64_t hash = detail::HashOf(landmark);
      RequireSame("landmark", number, same && hash == row.Integer(2));
      if (selection_.box && !selection_.box->contains(landmark.mean.cast<float>())) return;
      maps_[i].landmarks.push_back(number);
      hashes_.maps[i].landmarks.push_back(hash);
      atlas_.maps[i].landmarks.push_back(std::move(landmark));
    };
    if (base_ == nullptr)
      VisitList(rows::kLandmarkColumns, "landmark", visit);
    else
      VisitMissing(rows::kLandmarkColumns, "landmark", "hash", base_->landmarks, visit,
                   [&](std::size_t i, const HashedRow& row, const Landmark& landmark) {
                     maps_[i].landmarks.push_back(row.row);
                     hashes_.maps[i].landmarks.push_back(row.hash);
                     atlas_.maps[i].landmarks.push_back(landmark);
                   });
  }

  // Brings what came in the order of rows into that of the lists.
  void SortLists() {
    for (std::size_t i = 0; i < maps_.size(); ++i) {
      AtlasHashes::OfMap& of = hashes_.maps[i];
      Map& map = atlas_.maps[i];
      const MapRows& rows = maps_[i];
      At("map", rows.row, [&] {
        rows.keyframe_order.Sort(rows.keyframes, map.keyframes, of.keyframes, of.links, of.features);
        rows.point_order.Sort(rows.points, map.points, of.points, of.observations);
        rows.landmark_order.Sort(rows.landmarks, map.landmarks, of.landmarks);
      });
    }
  }

  // Where all was read, it has the hash that is stored.
  void CheckHash() {
    hashes_.header = detail::HashOfAtlasHeader(atlas_, atlas_.encoding);
    for (const Camera& camera : atlas_.cameras) hashes_.cameras.push_back(detail::HashOf(camera));
    for (std::size_t i = 0; i < atlas_.maps.size(); ++i) hashes_.maps[i].header = detail::HashOfHeader(atlas_.maps[i]);
    RequireSame("revision", named_.number, hashes_.Combined() == hash_);
  }

  Connection& connection_;
  const ReadOptions& options_;
  const Selection& selection_;
  Named named_;
  Atlas atlas_;
  AtlasHashes hashes_;
  std::vector<MapRows> maps_;
  std::vector<std::int64_t> stored_header_hashes_;
  std::int64_t hash_ = 0;  // of the revision
  const BaseAtlas* base_;  // null: there is none
};

}  // namespace

Atlas LoadAtlas(Connection& connection, const Named& named, const ReadOptions& options) {
  return Loader(connection, named, options).Run();
}

Atlas LoadOnto(Connection& connection, const Named& named, const Atlas& base, const ReadOptions& options) {
  const ReadOptions whole{.threads = options.threads, .progress = options.progress};
  if (base.maps.empty()) return LoadAtlas(connection, named, whole);
  const BaseAtlas at_hand(base, options.threads);
  return Loader(connection, named, whole, &at_hand).Run();
}

}  // namespace slamdb::postgresql
