// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/postgresql/detail/load.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/parallel.h"
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

// A map while it is loaded.
struct MapRows {
  std::int64_t row = 0;
  std::vector<std::int64_t> keyframes, points, landmarks;  // rows, ascending
  rows::ListOrder keyframe_order, point_order, landmark_order;
};

class Loader {
 public:
  Loader(Connection& connection, const Named& named, const ReadOptions& options)
      : connection_(connection), options_(options), selection_(options.selection), named_(named) {}

  Atlas Run() {
    LoadHeader();
    LoadCameras();
    LoadMaps();
    LoadRepeated();
    LoadKeyframes();
    if (options_.features != FeatureColumns::kNone) LoadFeatures();
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
    VisitList(Concat(rows::kKeyframeColumns, ", children, connections, weights, loop_edges, merge_edges, carried"),
              "keyframe", [&](std::size_t i, const Row& row) {
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
          const auto text = [&](std::size_t column) {
            const Bytes bytes = row.Blob(column);
            return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
          };
          waiting.push_back({by_row[i], next++, row.Integer(1), text(2), text(3)});
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
    VisitList(Concat(rows::kPointColumns, ", ", rows::kPointTrackingColumns,
                     ", seen_by, left_keypoints, right_keypoints, carried"),
              "map_point", [&](std::size_t i, const Row& row) {
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
                RequireSame(
                    "map_point", number,
                    same && hashes.points.back() == row.Integer(2) && hashes.observations.back() == row.Integer(3));
                maps_[i].points.push_back(number);
                atlas_.maps[i].points.push_back(std::move(point));
              });
  }

  void LoadLandmarks() {
    VisitList(rows::kLandmarkColumns, "landmark", [&](std::size_t i, const Row& row) {
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
};

}  // namespace

Atlas LoadAtlas(Connection& connection, const Named& named, const ReadOptions& options) {
  return Loader(connection, named, options).Run();
}

}  // namespace slamdb::postgresql
