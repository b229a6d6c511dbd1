// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "slamdb/base/detail/pipeline.h"
#include "slamdb/formats/rows/detail/features_blob.h"
#include "slamdb/formats/rows/detail/keyframe_row.h"
#include "slamdb/formats/rows/detail/row_changes.h"
#include "slamdb/formats/sqlite/detail/batch_insert.h"
#include "slamdb/formats/sqlite/detail/carried.h"
#include "slamdb/formats/sqlite/detail/pictures.h"
#include "slamdb/formats/sqlite/detail/save.h"
#include "slamdb/model/detail/record.h"

namespace slamdb::sqlite {
namespace {

// One row of the table keyframe.
class KeyframeWriter {
 public:
  explicit KeyframeWriter(SaveContext& context)
      : atlas_(context.atlas),
        past_(context.past),
        carried_(context.database, CarriedKind::kKeyframe),
        remove_(context.database, "DELETE FROM keyframe WHERE row = ?1", "table keyframe"),
        is_at_(context.database,
               "SELECT 1 FROM keyframe WHERE row = ?1 AND qw IS ?2 AND qx IS ?3 AND qy IS ?4 AND qz IS ?5 AND tx IS ?6 "
               "AND ty IS ?7 AND tz IS ?8",
               "table keyframe"),
        insert_(
            context.database,
            "INSERT OR ROLLBACK INTO keyframe VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, "
            "?15, "
            "?16, ?17, ?18, ?19, ?20, ?21, ?22, ?23, ?24, ?25, ?26, ?27, ?28, ?29, ?30, ?31, ?32, ?33, ?34, ?35, ?36, "
            "?37, ?38, ?39, ?40, ?41, ?42)",
            "table keyframe") {}

  // Whether the pose that is stored is another one.
  bool Moves(std::int64_t row, const KeyFrame& keyframe) {
    const detail::KeyframeReals reals = detail::RealsOf(keyframe);  // the pose is in front
    is_at_.Bind(1, row);
    for (int i = 0; i < 7; ++i) is_at_.BindReal(2 + i, reals[static_cast<std::size_t>(i)]);
    const bool is_there = is_at_.Step();
    is_at_.Reset();
    return !is_there;
  }

  void Write(std::int64_t map, const ListPlan::Entry& entry, const KeyFrame& keyframe, std::int64_t hash,
             std::int64_t links_hash) {
    past_.Keep(Part::kKeyframe, entry.row);
    past_.Keep(Part::kCarriedByKeyframe, entry.row);
    if (entry.stored != nullptr) {
      remove_.Bind(1, entry.row).Run();
      carried_.Remove(entry.row);
    }
    insert_.BindAll(row_.Of({entry.row, map, atlas_, entry.unique, hash, links_hash}, keyframe)).Run();
    carried_.Write(entry.row, keyframe.carried);
  }

 private:
  std::int64_t atlas_;
  PastWriter& past_;
  CarriedWriter carried_;
  Statement remove_, is_at_, insert_;
  rows::KeyframeRow row_;
};

// The rows of keyframe_link. Flush() after the last.
class LinkWriter {
 public:
  explicit LinkWriter(SaveContext& context)
      : remove_(context.database, "DELETE FROM keyframe_link WHERE keyframe = ?1", "table keyframe_link"),
        insert_(context.database, "keyframe_link", 6),
        past_(context.past),
        database_(context.database) {}

  std::uint64_t Remove(std::int64_t row) {
    past_.Keep(Part::kLinks, row);
    remove_.Bind(1, row).Run();
    return static_cast<std::uint64_t>(sqlite3_changes(database_.handle()));
  }
  std::uint64_t Write(std::int64_t map, std::int64_t row, const KeyFrame& keyframe) {
    const auto add = [&](std::string_view kind, std::size_t position, KeyFrameId target, Value weight) {
      insert_.Add(std::array<Value, 6>{row, kind, static_cast<std::int64_t>(position), map,
                                       ValueOrNull(ToReference(target)), weight});
    };
    const auto add_list = [&](std::string_view kind, const Column<KeyFrameId>& targets) {
      for (std::size_t i = 0; i < targets.size(); ++i) add(kind, i, targets[i], Value());
    };
    add_list("child", keyframe.children);
    for (std::size_t i = 0; i < keyframe.connections.size(); ++i)
      add("covisible", i, keyframe.connections[i].keyframe, std::int64_t{keyframe.connections[i].weight});
    add_list("loop", keyframe.loop_edges);
    add_list("merge", keyframe.merge_edges);
    return CountLinks(keyframe);
  }
  void Flush() { insert_.Flush(); }

 private:
  Statement remove_;
  BatchInsert insert_;
  PastWriter& past_;
  Database& database_;
};

std::vector<std::int64_t> StoredFeatureHashes(Database& database, std::int64_t map, std::span<const StoredRow> stored) {
  Statement statement(database, "SELECT keyframe, hash FROM keyframe_features WHERE keyframe BETWEEN ?1 AND ?2",
                      "table keyframe_features");
  statement.Bind(1, FirstRowOfMap(map)).Bind(2, LastRowOfMap(map));
  std::vector<std::int64_t> hashes(stored.size());
  std::size_t i = 0;
  while (statement.Step()) {
    while (i < stored.size() && stored[i].row < statement.Integer(0)) ++i;
    if (i < stored.size() && stored[i].row == statement.Integer(0)) hashes[i] = statement.Integer(1);
  }
  return hashes;
}

// Whether the features of a keyframe, the same as before, have to be packed anew all the same: grids that follow from
// the keypoints are left out of the blob (features_blob.cc), and follow from the image bounds and the kind of camera
// too.
class GridSources {
 public:
  explicit GridSources(Database& database)
      : select_(database, "SELECT left_features, details FROM keyframe WHERE row = ?1", "table keyframe") {}

  bool Differ(std::int64_t row, const KeyFrame& keyframe) {
    KeyFrame stored;
    select_.Reset();
    if (!select_.Bind(1, row).Step()) return true;
    stored.features.left_count = static_cast<std::int32_t>(select_.Integer(0));
    try {
      detail::DecodeDetails(select_.Blob(1), stored);
    } catch (const Error&) {
      return true;
    }
    return stored.bounds != keyframe.bounds ||
           stored.features.is_fisheye_stereo() != keyframe.features.is_fisheye_stereo();
  }

 private:
  Statement select_;
};

// Features are packed on all threads, and inserted by this one.
void WriteFeatures(SaveContext& context, const ListPlan& plan, const Map& map, const AtlasHashes::OfMap& hashes,
                   const std::vector<std::size_t>& changed) {
  PictureWriter pictures(context.database);
  Statement insert(context.database,
                   "INSERT OR REPLACE INTO keyframe_features (keyframe, hash, points, picture) VALUES (?1, ?2, ?3, ?4)",
                   "table keyframe_features");
  constexpr std::size_t kTail = 2 * sizeof(std::int64_t);  // behind picture and points: the picture's size and hash
  const auto pack = [&](std::size_t i, std::string& bytes) {
    detail::ByteWriter out(std::move(bytes));
    rows::EncodePicture(map.keyframes[changed[i]], out);
    const auto size = static_cast<std::int64_t>(out.bytes().size());
    const std::int64_t hash = HashOfPicture(out.bytes());
    rows::EncodePoints(map.keyframes[changed[i]], out);
    out.Put(size);
    out.Put(hash);
    bytes = out.Take();
  };
  const auto write = [&](std::size_t i, const std::string& bytes) {
    const Bytes packed = std::as_bytes(std::span(bytes));
    detail::ByteReader tail(packed.last(kTail));
    const auto size = static_cast<std::size_t>(tail.Get<std::int64_t>());
    const auto hash = tail.Get<std::int64_t>();
    const std::size_t k = changed[i];
    const std::int64_t row = plan.entries[k].row;
    if (plan.entries[k].stored != nullptr) context.past.Keep(Part::kFeatures, row);
    insert.Bind(1, row).Bind(2, hashes.features[k]).BindBlob(3, packed.subspan(size, packed.size() - size - kTail));
    insert.Bind(4, pictures.RowOf(packed.first(size), hash)).Run();
    context.Report(100);
  };
  detail::ProduceInOrder<std::string>(changed.size(), context.options.threads, pack, write);
}

void RemoveKeyframes(SaveContext& context, LinkWriter& links, const std::vector<std::int64_t>& rows) {
  if (rows.empty()) return;
  Statement features(context.database, "DELETE FROM keyframe_features WHERE keyframe = ?1", "table keyframe_features");
  Statement keyframe(context.database, "DELETE FROM keyframe WHERE row = ?1", "table keyframe");
  CarriedWriter carried(context.database, CarriedKind::kKeyframe);
  for (const std::int64_t row : rows) {
    for (const Part part : {Part::kKeyframe, Part::kFeatures, Part::kCarriedByKeyframe}) context.past.Keep(part, row);
    context.changes["keyframe_link"].deleted += links.Remove(row);
    features.Bind(1, row).Run();
    keyframe.Bind(1, row).Run();
    carried.Remove(row);
  }
  context.map.keyframes_removed += rows.size();
  context.changes["keyframe"].deleted += rows.size();
  context.changes["keyframe_features"].deleted += rows.size();
}

}  // namespace

std::vector<std::int64_t> SaveKeyframes(SaveContext& context, std::int64_t row, const Map& map,
                                        const AtlasHashes::OfMap& hashes) {
  const std::vector<StoredRow> stored =
      ReadStoredRows(context.database, "keyframe", "links_hash", row, map.keyframes.size());
  const std::vector<std::int64_t> stored_features = StoredFeatureHashes(context.database, row, stored);
  const ListPlan plan = rows::PlanOf(map.keyframes, stored, row);
  LinkWriter links(context);
  KeyframeWriter keyframes(context);
  RemoveKeyframes(context, links, plan.removed);

  GridSources grid_sources(context.database);
  std::vector<std::size_t> changed_features;
  for (std::size_t i = 0; i < plan.entries.size(); ++i) {
    const ListPlan::Entry& entry = plan.entries[i];
    const StoredRow* old = entry.stored;
    const bool same_row = rows::HasRow(entry, hashes.keyframes[i]);
    const bool same_links = rows::HasDetails(entry, hashes.links[i]);
    const bool same_features = old != nullptr &&
                               stored_features[static_cast<std::size_t>(old - stored.data())] == hashes.features[i] &&
                               (same_row || !grid_sources.Differ(entry.row, map.keyframes[i]));
    if (old == nullptr) ++context.map.keyframes_added;
    if (old != nullptr && !same_row && keyframes.Moves(entry.row, map.keyframes[i])) ++context.map.keyframes_moved;
    if (!same_row || !same_links) keyframes.Write(row, entry, map.keyframes[i], hashes.keyframes[i], hashes.links[i]);
    if (!same_features) changed_features.push_back(i);
    rows::Count(context.changes["keyframe"], same_row && same_links, old == nullptr);
    rows::Count(context.changes["keyframe_features"], same_features, old == nullptr);
  }
  for (std::size_t i = 0; i < plan.entries.size(); ++i) {
    const KeyFrame& keyframe = map.keyframes[i];
    TableChanges& changes = context.changes["keyframe_link"];
    if (rows::HasDetails(plan.entries[i], hashes.links[i])) {
      changes.unchanged += CountLinks(keyframe);
      continue;
    }
    if (plan.entries[i].stored != nullptr) changes.deleted += links.Remove(plan.entries[i].row);
    changes.inserted += links.Write(row, plan.entries[i].row, keyframe);
  }
  links.Flush();
  context.Report(100 * (plan.entries.size() - changed_features.size()));
  WriteFeatures(context, plan, map, hashes, changed_features);
  SaveOrder(context, row, "keyframe", plan);
  std::vector<std::int64_t> rows;
  for (const ListPlan::Entry& entry : plan.entries) rows.push_back(entry.row);
  return rows;
}

}  // namespace slamdb::sqlite
