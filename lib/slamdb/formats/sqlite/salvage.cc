// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/sqlite/detail/salvage.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <span>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/run_files.h"
#include "slamdb/formats/sqlite/detail/identity.h"
#include "slamdb/formats/sqlite/detail/image.h"
#include "slamdb/formats/sqlite/detail/load.h"
#include "slamdb/formats/sqlite/detail/migrations.h"
#include "slamdb/formats/sqlite/detail/plan.h"
#include "slamdb/formats/sqlite/options.h"
#include "slamdb/formats/sqlite/store.h"

namespace slamdb::sqlite {
namespace {

constexpr std::size_t kKeyframesPerRead = 16, kPointsPerRead = 1024, kLandmarksPerRead = 256;
constexpr std::size_t kMostNotes = 100;  // a lost page of points is hundreds of rows

class StoreSalvager {
 public:
  StoreSalvager(Database& database, std::int64_t atlas) : database_(database), atlas_(atlas) {}

  Salvage Run() {
    Atlas& atlas = salvage_.atlas;
    Try([&] { LoadHeader(database_, atlas_, atlas); });
    Try([&] { LoadCameras(database_, atlas_, atlas); });
    std::vector<std::int64_t> maps;
    Try([&] { maps = RowsOfMaps(database_, atlas_); });
    salvage_.maps_listed = maps.size();
    for (const std::int64_t row : maps) {
      if (row < 1 || row > 0x7fffffff)
        Note(DamagedRow(database_, "map", row));
      else
        ReadMap(row);
    }
    CompareCounts();
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
    ReadList(row, "keyframe", kKeyframesPerRead, map.keyframes, read.keyframes, [&](auto rows, auto entities) {
      std::vector<std::int64_t> hashes(rows.size()), links(rows.size()), features(rows.size());
      LoadKeyframes(database_, rows, true, entities, hashes, links, features);
    });
    ReadList(row, "map_point", kPointsPerRead, map.points, read.points, [&](auto rows, auto entities) {
      std::vector<std::int64_t> hashes(rows.size()), observations(rows.size());
      LoadPoints(database_, rows, entities, hashes, observations);
    });
    if (VersionOf(database_) >= kFirstVersionWithLandmarks)
      ReadList(row, "landmark", kLandmarksPerRead, map.landmarks, read.landmarks,
               [&](auto rows, auto entities) { LoadLandmarkRows(database_, rows, entities); });
    salvage_.atlas.maps.push_back(std::move(map));
    salvage_.maps.push_back(read);
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

  // Last rows that somebody deleted are missed by nothing but the numbers that the store records.
  void CompareCounts() {
    const auto compare = [&](const std::string& table, std::uint64_t listed) {
      std::int64_t recorded = 0;
      Try([&] {
        recorded = database_.Integer("SELECT " + table + " FROM atlas WHERE row = " + std::to_string(atlas_));
      });
      if (recorded <= 0 || static_cast<std::uint64_t>(recorded) <= listed) return;
      Note(Error(ErrorKind::kDamaged, "the store records " + std::to_string(recorded) + " " + table + " and lists " +
                                          std::to_string(listed) + ": rows were deleted"));
    };
    std::uint64_t keyframes = 0, points = 0;
    for (const SalvagedMap& map : salvage_.maps) {
      keyframes += map.keyframes.listed;
      points += map.points.listed;
    }
    compare("maps", salvage_.maps_listed);
    compare("keyframes", keyframes);
    compare("points", points);
  }

  template <class List, class Load>
  void ReadList(std::int64_t map, const std::string& table, std::size_t grain, List& list, SalvagedList& read,
                const Load& load) {
    const std::optional<std::vector<std::int64_t>> rows = RowsOf(map, table);
    if (rows) {
      for (std::size_t first = 0; first < rows->size(); first += grain)
        ReadRows(std::span(*rows).subspan(first, std::min(grain, rows->size() - first)), list, load);
      read.listed = rows->size();
    } else {
      ReadUnknownRows(map, grain, list, load);
      read.listed = list.size() + 1;  // at least the last one is lost
    }
    read.read = list.size();
  }

  // Rows whose number is not known are read until a run of them gives nothing.
  template <class List, class Load>
  void ReadUnknownRows(std::int64_t map, std::size_t grain, List& list, const Load& load) {
    std::vector<std::int64_t> rows(grain);
    std::iota(rows.begin(), rows.end(), FirstRowOfMap(map));
    for (std::size_t before = 0;; before = list.size()) {
      ReadRows(std::span<const std::int64_t>(rows), list, load);
      if (list.size() == before) return;
      for (std::int64_t& row : rows) row += static_cast<std::int64_t>(grain);
    }
  }

  // Reads rows at once; where that fails, their halves.
  template <class List, class Load>
  void ReadRows(std::span<const std::int64_t> rows, List& list, const Load& load) {
    std::vector<typename List::value_type> entities(rows.size());
    std::vector<EditedRow>* edits = database_.edits();
    const std::size_t noted = edits == nullptr ? 0 : edits->size();
    try {
      load(rows, std::span(entities));
      std::ranges::move(entities, std::back_inserter(list));
    } catch (const Error& error) {
      if (edits != nullptr) edits->resize(noted);
      if (rows.size() == 1) return Note(error);
      ReadRows(rows.first(rows.size() / 2), list, load);
      ReadRows(rows.subspan(rows.size() / 2), list, load);
    }
  }

  Database& database_;
  std::int64_t atlas_;
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

}  // namespace

Salvage SalvageRows(Database& database, std::int64_t atlas) { return StoreSalvager(database, atlas).Run(); }

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

}  // namespace slamdb::sqlite

namespace slamdb::detail {

Salvage SalvageStore(const std::string& path, const std::string& name, const ReadOptions& options) {
  sqlite::Database database(path, sqlite::Access::kSalvage, options.of<StoreReadOptions>().lock_timeout);
  const sqlite::Image image(path, sqlite::Missing::kIsZeros);
  sqlite::CheckIsStore(database, sqlite::NewestVersion(), sqlite::Older::kAccept, sqlite::Boxes::kNotNeeded);
  const std::string chosen = name.empty() ? sqlite::OnlyName(database) : name;
  EnterInput(path, chosen);
  sqlite::Statement statement(database, "SELECT row FROM atlas NOT INDEXED WHERE name = ?1", "table atlas");
  if (!statement.BindText(1, chosen).Step())
    throw Error(ErrorKind::kNotFound, path, "", "no atlas named '" + chosen + "' could be read");
  std::vector<sqlite::EditedRow> edits;
  if (options.of<StoreReadOptions>().accept_edits) database.AcceptEdits(&edits);
  Salvage salvage = sqlite::SalvageRows(database, statement.Integer(0));
  for (const sqlite::EditedRow& edit : edits) salvage.accepted.push_back(ToString(edit));
  if (image.changed()) throw Error(ErrorKind::kLocked, path, "", "is being changed while it is read: try again");
  if (image.lacks_pages())
    salvage.damage.insert(salvage.damage.begin(),
                          Concat("the file ends after ", image.file_bytes(), " of ", image.promised_bytes(), " bytes"));
  if (image.lacks_journal())
    salvage.damage.insert(salvage.damage.begin(),
                          "beside it lies the journal of a transaction that did not end (" +
                              sqlite::JournalPathOf(path) +
                              "), which is damaged itself: what that transaction had changed is not taken back");
  return salvage;
}

}  // namespace slamdb::detail
