// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/salvage.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <span>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/run_files.h"
#include "slamdb/formats/rows/detail/plan.h"
#include "slamdb/formats/rows/options.h"
#include "slamdb/formats/rows/stored.h"
#include "slamdb/formats/sqlite/detail/files_beside.h"
#include "slamdb/formats/sqlite/detail/identity.h"
#include "slamdb/formats/sqlite/detail/image.h"
#include "slamdb/formats/sqlite/detail/list_order.h"
#include "slamdb/formats/sqlite/detail/load.h"
#include "slamdb/formats/sqlite/detail/migrations.h"

namespace slamdb::sqlite {
namespace {

constexpr std::size_t kKeyframesPerRead = 16, kPointsPerRead = 1024, kLandmarksPerRead = 256;
constexpr std::size_t kMostNotes = 100;  // a lost page of points is hundreds of rows

// `map_point 17`, `the links of keyframe 3`.
std::string ToString(const EditedRow& row) {
  constexpr std::pair<std::string_view, std::string_view> kParts[] = {
      {"keyframe_link", "the links of keyframe"},
      {"keyframe_features", "the features of keyframe"},
      {"observation", "the observations of map_point"},
  };
  std::string_view what = row.table;
  for (const auto& [table, part] : kParts)
    if (row.table == table) what = part;
  return detail::Concat(what, " ", row.id);
}

class StoreSalvager {
 public:
  StoreSalvager(Database& database, std::int64_t atlas) : database_(database), atlas_(atlas) {}

  Salvage Run() {
    Atlas& atlas = salvage_.atlas;
    Try([&] { LoadHeader(database_, atlas_, atlas); });
    Try([&] { LoadCameras(database_, atlas_, atlas); });
    Try([&] {
      atlas.repeated_maps = LoadRepeated(database_, atlas_, "maps", 0);
      atlas.repeated_cameras = LoadRepeated(database_, atlas_, "cameras", 0);
    });
    std::vector<std::int64_t> maps;
    Try([&] { maps = RowsOfMaps(database_, atlas_); });
    salvage_.maps_listed = maps.size();
    for (const std::int64_t row : maps) {
      if (row < 1 || row > 0x7fffffff)
        Note(DamagedRow(database_, "map", row));
      else
        ReadMap(row);
    }
    const bool all_there = CompareCounts();
    CompareHash(maps, all_there);
    if (database_.edits() != nullptr)
      for (const EditedRow& edit : *database_.edits()) salvage_.accepted.push_back(ToString(edit));
    return std::move(salvage_);
  }

 private:
  template <class Read>
  bool Try(const Read& read) {
    try {
      read();
      return true;
    } catch (const Error& error) {
      Note(error);
      return false;
    }
  }
  void Note(const Error& error) {
    if (salvage_.damage.size() >= kMostNotes) return;
    salvage_.damage.push_back((error.place().empty() ? "" : error.place() + ": ") + error.problem());
  }

  void ReadMap(std::int64_t row) {
    Map map;
    SalvagedMap read;
    if (!Try([&] { map = LoadMapHeader(database_, atlas_, row); })) map.id = MapId(salvage_.atlas.maps.size());
    read.id = map.id;
    const auto cannot = [](std::int64_t, auto&) { return false; };
    ReadList(
        row, "keyframe", "keyframe", kKeyframesPerRead, map.keyframes, read.keyframes,
        [&](auto rows, auto entities) { LoadKeyframeRows(rows, {}, entities); },
        [&](std::int64_t keyframe, KeyFrame& entity) { return LoadWithoutLinks(keyframe, entity, read); });
    ReadList(
        row, "map_point", "point", kPointsPerRead, map.points, read.points,
        [&](auto rows, auto entities) {
          std::vector<std::int64_t> hashes(rows.size()), observations(rows.size());
          LoadPoints(database_, rows, entities, hashes, observations);
        },
        cannot);
    if (VersionOf(database_) >= kFirstVersionWithLandmarks)
      ReadList(
          row, "landmark", "landmark", kLandmarksPerRead, map.landmarks, read.landmarks,
          [&](auto rows, auto entities) { LoadLandmarkRows(database_, rows, entities); }, cannot);
    salvage_.atlas.maps.push_back(std::move(map));
    salvage_.maps.push_back(std::move(read));
  }

  void LoadKeyframeRows(std::span<const std::int64_t> rows, KeyframeParts parts, std::span<KeyFrame> keyframes) {
    std::vector<std::int64_t> hashes(rows.size()), links(rows.size()), features(rows.size());
    LoadKeyframes(database_, rows, parts, keyframes, hashes, links, features);
  }
  // Damaged links cost the links, which can be counted anew, and not the keyframe. Returns whether the rest is whole.
  bool LoadWithoutLinks(std::int64_t row, KeyFrame& keyframe, SalvagedMap& read) {
    try {
      LoadKeyframeRows(std::span(&row, 1), {.links = false}, std::span(&keyframe, 1));
    } catch (const Error&) {  // the first one says what is damaged
      return false;
    }
    read.lost_links.push_back(keyframe.id);
    return true;
  }

  // The rows that a list has. Where its pages are not all readable, every number that may be one of its rows: up to the
  // last one that is known, or else as many as the atlas has, and never more than the file has room for. Nothing when
  // not even that is known, as of landmarks.
  std::optional<std::vector<std::int64_t>> RowsOf(std::int64_t map, const std::string& table) {
    const std::string source =
        detail::Concat(" FROM ", table, " WHERE row BETWEEN ", FirstRowOfMap(map), " AND ", LastRowOfMap(map));
    std::vector<std::int64_t> rows;
    const bool all_known = Try([&] {
      Statement statement(database_, "SELECT row" + source + " ORDER BY row", "table " + table);
      while (statement.Step()) rows.push_back(statement.Integer(0));
    });
    // Nothing records how many landmarks there are: where one is missing between others, it may have been deleted.
    const bool has_gaps = !rows.empty() && rows.back() - rows.front() >= static_cast<std::int64_t>(rows.size());
    if (all_known && !(table == "landmark" && has_gaps)) return rows;
    std::int64_t count = 0;
    if (!Try([&] { count = database_.Integer("SELECT max(row)" + source) - FirstRowOfMap(map) + 1; })) {
      if (table == "landmark") return std::nullopt;
      const std::string column = table == "keyframe" ? "keyframes" : "points";
      Try([&] { count = database_.Integer(detail::Concat("SELECT ", column, " FROM atlas WHERE row = ", atlas_)); });
    }
    constexpr std::int64_t kLeastRowBytes = 16;
    const std::int64_t most =
        database_.Integer("PRAGMA page_count") * database_.Integer("PRAGMA page_size") / kLeastRowBytes;
    if (all_known && count > most) return rows;
    rows.resize(static_cast<std::size_t>(std::clamp<std::int64_t>(count, 0, most)));
    std::iota(rows.begin(), rows.end(), FirstRowOfMap(map));
    return rows;
  }

  // What was changed in a way that no single row tells: taken as it is where edits are accepted.
  void NoteChange(Error error, std::string accepted) {
    if (database_.edits() == nullptr)
      Note(error);
    else
      salvage_.accepted.push_back(std::move(accepted));
  }

  // Rows that somebody deleted are missed by nothing but the numbers that the store records. Returns whether none are.
  bool CompareCounts() {
    bool all_there = true;
    const auto compare = [&](const std::string& entity, std::uint64_t listed) {
      std::int64_t recorded = 0;
      Try([&] {
        recorded = database_.Integer(detail::Concat("SELECT ", entity, "s FROM atlas WHERE row = ", atlas_));
      });
      if (recorded <= 0 || static_cast<std::uint64_t>(recorded) <= listed) return;
      all_there = false;
      NoteChange(Error(ErrorKind::kDamaged, detail::Concat("the store records ", recorded, " ", entity, "s and lists ",
                                                           listed, ": rows were deleted")),
                 detail::Counted(static_cast<std::uint64_t>(recorded) - listed, entity) + " deleted");
    };
    std::uint64_t keyframes = 0, points = 0;
    for (const SalvagedMap& map : salvage_.maps) {
      keyframes += map.keyframes.listed;
      points += map.points.listed;
    }
    compare("map", salvage_.maps_listed);
    compare("keyframe", keyframes);
    compare("point", points);
    return all_there;
  }

  // The atlas' own row, its cameras and its repeated entries have no hash but that of the atlas, which is of all hashes
  // that rows record, too.
  void CompareHash(const std::vector<std::int64_t>& maps, bool all_there) {
    if (IsOfHash(maps)) return;
    if (!salvage_.damage.empty() || !all_there) {
      constexpr const char* kUnknown =
          "whether the rows of table atlas, camera and repeated_entry are as they were saved cannot be told, since "
          "other "
          "rows are lost, with which they have one hash";
      return NoteChange(Error(ErrorKind::kDamaged, kUnknown), kUnknown);
    }
    NoteChange(Error(ErrorKind::kDamaged, database_.path(), PlaceOf("atlas", atlas_),
                     "this row (vocabulary, next ids, encoding), or one of table camera or repeated_entry, was changed "
                     "outside slamdb, or is damaged; which of them cannot be told, since they have one hash"),
               "the row of table atlas, or some of table camera or repeated_entry, which have one hash");
  }
  bool IsOfHash(const std::vector<std::int64_t>& maps) {
    try {
      return RecordedHashes(maps).Combined() ==
             database_.Integer("SELECT hash FROM atlas WHERE row = " + std::to_string(atlas_));
    } catch (const Error&) {
      return false;
    }
  }
  AtlasHashes RecordedHashes(const std::vector<std::int64_t>& maps) {
    AtlasHashes hashes;
    hashes.header = detail::HashOfAtlasHeader(salvage_.atlas, salvage_.atlas.encoding);
    for (const Camera& camera : salvage_.atlas.cameras) hashes.cameras.push_back(detail::HashOf(camera));
    for (const std::int64_t map : maps) {
      AtlasHashes::OfMap& of = hashes.maps.emplace_back();
      of.header = database_.Integer("SELECT hash FROM map WHERE row = " + std::to_string(map));
      TakeHashes(map, "keyframe", "keyframe", "hash, links_hash", {&of.keyframes, &of.links});
      TakeHashes(map, "map_point", "point", "hash, observations_hash", {&of.points, &of.observations});
      TakeHashes(map, "keyframe_features", "keyframe", "hash", {&of.features}, "keyframe");
      if (VersionOf(database_) >= kFirstVersionWithLandmarks)
        TakeHashes(map, "landmark", "landmark", "hash", {&of.landmarks});
    }
    return hashes;
  }
  void TakeHashes(std::int64_t map, const std::string& table, std::string_view order, std::string_view columns,
                  std::initializer_list<std::vector<std::int64_t>*> lists, std::string_view key = "row") {
    Statement statement(database_,
                        detail::Concat("SELECT ", key, ", ", columns, " FROM ", table, " WHERE ", key, " BETWEEN ",
                                       FirstRowOfMap(map), " AND ", LastRowOfMap(map), " ORDER BY ", key),
                        "table " + table);
    std::vector<std::int64_t> rows;
    while (statement.Step()) {
      int column = 0;
      rows.push_back(statement.Integer(column++));
      for (std::vector<std::int64_t>* list : lists) list->push_back(statement.Integer(column++));
    }
    const ListOrder of_list = OrderOf(database_, map, order);
    for (std::vector<std::int64_t>* list : lists) of_list.Sort(rows, *list);
  }

  // `rescue` reads of a row that is damaged what can stand without the rest; false: nothing.
  template <class List, class Load, class Rescue>
  void ReadList(std::int64_t map, const std::string& table, std::string_view order, std::size_t grain, List& list,
                SalvagedList& read, const Load& load, const Rescue& rescue) {
    const std::optional<std::vector<std::int64_t>> rows = RowsOf(map, table);
    rows_read_.clear();
    if (rows) {
      for (std::size_t first = 0; first < rows->size(); first += grain)
        ReadRows(std::span(*rows).subspan(first, std::min(grain, rows->size() - first)), list, load, rescue);
      read.listed = rows->size();
    } else {
      ReadUnknownRows(map, grain, list, load, rescue);
      read.listed = list.size() + 1;  // at least the last one is lost
    }
    read.read = list.size();
    Try([&] { OrderOf(database_, map, order).Sort(rows_read_, list); });
  }

  // Rows whose number is not known are read until a run of them gives nothing.
  template <class List, class Load, class Rescue>
  void ReadUnknownRows(std::int64_t map, std::size_t grain, List& list, const Load& load, const Rescue& rescue) {
    std::vector<std::int64_t> rows(grain);
    std::iota(rows.begin(), rows.end(), FirstRowOfMap(map));
    for (std::size_t before = 0;; before = list.size()) {
      ReadRows(std::span<const std::int64_t>(rows), list, load, rescue);
      if (list.size() == before) return;
      for (std::int64_t& row : rows) row += static_cast<std::int64_t>(grain);
    }
  }

  // Reads rows at once; where that fails, their halves.
  template <class List, class Load, class Rescue>
  void ReadRows(std::span<const std::int64_t> rows, List& list, const Load& load, const Rescue& rescue) {
    std::vector<typename List::value_type> entities(rows.size());
    std::vector<EditedRow>* edits = database_.edits();
    const std::size_t noted = edits == nullptr ? 0 : edits->size();
    try {
      load(rows, std::span(entities));
      std::ranges::move(entities, std::back_inserter(list));
      rows_read_.insert(rows_read_.end(), rows.begin(), rows.end());
    } catch (const Error& error) {
      if (edits != nullptr) edits->resize(noted);
      if (rows.size() == 1) {
        Note(error);
        if (entities.front() = {}; !rescue(rows.front(), entities.front())) return;
        list.push_back(std::move(entities.front()));
        rows_read_.push_back(rows.front());
        return;
      }
      ReadRows(rows.first(rows.size() / 2), list, load, rescue);
      ReadRows(rows.subspan(rows.size() / 2), list, load, rescue);
    }
  }

  Database& database_;
  std::int64_t atlas_;
  std::vector<std::int64_t> rows_read_;  // of the list that is read
  Salvage salvage_;
};

// The only atlas, without the index of names.
std::string OnlyName(Database& database) {
  Statement statement(database, "SELECT count(*), group_concat(name, ', ') FROM atlas NOT INDEXED", "table atlas");
  if (!statement.Step() || statement.Integer(0) == 0)
    throw Error(ErrorKind::kNotFound, database.path(), "", "no atlas could be read");
  if (statement.Integer(0) == 1) return statement.Text(1);
  throw Error(ErrorKind::kUsage, database.path(), "",
              detail::Concat("holds ", statement.Integer(0), " atlases: ", statement.Text(1), "; say which, as ",
                             database.path(), "#NAME"));
}

// Where the schema of `carried` was on a page that is lost, an empty table takes its place. Returns whether it was.
bool ReplaceLostCarried(Database& database) {
  if (VersionOf(database) < kFirstVersionWithCarried) return false;
  try {
    if (HasPlainTable(database, "carried")) return false;
  } catch (const Error&) {  // the schema ends there
  }
  database.Execute("PRAGMA query_only=OFF");
  database.Execute("CREATE TEMP TABLE carried (kind, row, bytes)");  // found before one of the file
  database.Execute("PRAGMA query_only=ON");
  return true;
}

}  // namespace

Salvage SalvageRows(Database& database, std::int64_t atlas) { return StoreSalvager(database, atlas).Run(); }

}  // namespace slamdb::sqlite

namespace slamdb::detail {

Salvage SalvageStore(const std::string& path, const std::string& name, const ReadOptions& options) {
  sqlite::Database database(path, sqlite::Access::kSalvage, options.of<StoreReadOptions>().lock_timeout);
  const sqlite::Image& image = sqlite::ImageSeenBy(database.handle());
  sqlite::CheckIsStore(database, sqlite::NewestVersion(), sqlite::Older::kAccept, sqlite::Derived::kNotNeeded);
  const bool lacks_carried = sqlite::ReplaceLostCarried(database);
  const std::string chosen = name.empty() ? sqlite::OnlyName(database) : name;
  EnterInput(path, chosen);
  sqlite::Statement statement(database, "SELECT row FROM atlas NOT INDEXED WHERE name = ?1", "table atlas");
  if (!statement.BindText(1, chosen).Step())
    throw Error(ErrorKind::kNotFound, path, "", "no atlas named '" + chosen + "' could be read");
  std::vector<sqlite::EditedRow> edits;
  if (options.of<StoreReadOptions>().accept_edits) database.AcceptEdits(&edits);
  Salvage salvage = sqlite::SalvageRows(database, statement.Integer(0));
  if (lacks_carried)
    salvage.damage.insert(salvage.damage.begin(),
                          "table carried: lost, and with it what entities had of a fork's file");
  if (image.changed()) throw Error(ErrorKind::kLocked, path, "", "is being changed while it is read: try again");
  if (image.lacks_pages())
    salvage.damage.insert(salvage.damage.begin(),
                          Concat("the file ends after ", image.file_bytes(), " of ", image.promised_bytes(), " bytes"));
  if (image.lacks_journal())
    salvage.damage.insert(salvage.damage.begin(),
                          "beside it lies the journal of a transaction that did not end (" +
                              sqlite::FilesBeside(path).journal +
                              "), which is damaged itself: what that transaction had changed is not taken back");
  return salvage;
}

}  // namespace slamdb::detail
