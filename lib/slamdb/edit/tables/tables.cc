// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/tables/tables.h"

#include <algorithm>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/open_end.h"
#include "slamdb/base/detail/parse_file.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/tables/detail/cells.h"
#include "slamdb/edit/tables/detail/edited.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/digest.h"
#include "slamdb/model/index.h"

namespace slamdb {
namespace {

using detail::Concat;
using detail::Table;
using namespace tables;  // NOLINT(google-build-using-namespace): the folder's own

constexpr std::string_view kAddNothing = "; tables add nothing, ndjson does";

class Editor {
 public:
  explicit Editor(Atlas& atlas) : atlas_(atlas), index_(atlas) {
    for (const Map& map : atlas.maps) flags_.emplace_back(map);
  }

  void ReadPoints(std::string_view text, TableEditChanges& changes) {
    Table table(text, PointTable());
    changes.ignored = IgnoredColumnsOfPoints(table);
    while (NextWhole(table)) {
      const EntityRow place = Find(
          table, kPointId, kPointMap, index_.duplicate_points(), "point",
          [&](std::uint64_t id) { return index_.LocatePoint(MapPointId(id)); },
          [&](std::size_t map, std::uint64_t id) { return index_.PointRow(map, MapPointId(id)); });
      Take(table, flags_[place.map].points.seen, place.row);
      EditPoint(table, place, changes);
    }
  }

  void ReadKeyFrames(std::string_view text, TableEditChanges& changes) {
    Table table(text, KeyFrameTableKind());
    changes.ignored = IgnoredColumnsOfKeyFrames(table);
    while (NextWhole(table)) {
      const EntityRow place = Find(
          table, kKeyFrameId, kKeyFrameMap, index_.duplicate_keyframes(), "keyframe",
          [&](std::uint64_t id) { return index_.LocateKeyFrame(KeyFrameId(id)); },
          [&](std::size_t map, std::uint64_t id) { return index_.KeyFrameRow(map, KeyFrameId(id)); });
      Take(table, flags_[place.map].keyframes.seen, place.row);
      EditKeyFrame(table, place, changes);
    }
  }

  std::uint64_t Refresh() { return detail::RefreshMoved(index_, flags_, atlas_); }

  // What turned bad, and with `missing` what has no row, of the maps that have rows, and is not flagged bad.
  void Drop(bool missing, Subset& subset, TableEditReport& report) const {
    for (std::size_t m = 0; m < flags_.size(); ++m) {
      const Map& map = atlas_.maps[m];
      DropRows(map.points, flags_[m].points, missing, subset.maps[m].points, report.points);
      DropRows(map.keyframes, flags_[m].keyframes, missing, subset.maps[m].keyframes, report.keyframes);
    }
  }

 private:
  // A row that ends early, as where a file is cut, would leave its last columns as they are.
  static bool NextWhole(Table& table) {
    if (!table.Next()) return false;
    if (table.cells().size() >= table.names().size()) return true;
    throw table.LineError(Concat("expected ", table.names().size(), " cells, found ", table.cells().size()));
  }

  template <class Locate, class RowIn>
  EntityRow Find(const Table& table, std::size_t id_column, std::size_t map_column,
                 std::span<const DuplicateId> duplicates, std::string_view noun, const Locate& locate,
                 const RowIn& row_in) const {
    const auto id = table.Get<std::uint64_t>(id_column, "an id");
    EntityRow place;
    if (table.Has(map_column)) {
      const auto map_id = table.Get<std::uint64_t>(map_column, "the id of a map");
      place.map = index_.MapRow(MapId(map_id));
      if (place.map == kNoRow) throw table.LineError(Concat("the atlas has no map ", map_id));
      place.row = row_in(place.map, id);
      if (!place) throw table.LineError(Concat("map ", map_id, " has no ", noun, " ", id, kAddNothing));
      return place;
    }
    place = locate(id);
    if (!place) throw table.LineError(Concat("the atlas has no ", noun, " ", id, kAddNothing));
    if (!duplicates.empty() && atlas_.maps.size() > 1)
      throw table.LineError(
          Concat("ids of ", noun, "s are not unique in the atlas; a column `map` is to tell which is meant"));
    return place;
  }
  static void Take(const Table& table, std::vector<std::uint8_t>& seen, std::uint32_t row) {
    if (std::exchange(seen[row], std::uint8_t{1}) != 0) throw table.LineError("has the id of a row above");
  }

  void EditPoint(const Table& table, const EntityRow& place, TableEditChanges& changes) {
    MapPoint& point = atlas_.maps[place.map].points[place.row];
    detail::EditedRows& flags = flags_[place.map].points;
    flags.moved[place.row] = SetVector(table, kX, point.position);
    flags.own_normal[place.row] = SetNormal(table, point.normal);
    flags.own_range[place.row] = SetRange(table, point);
    const bool reference = SetReference(table, place.map, point);
    const bool restored = SetBad(table, kPointBad, point.bad, flags.dropped[place.row]);
    ++changes.rows;
    changes.moved += flags.moved[place.row];
    changes.changed += flags.own_normal[place.row] || flags.own_range[place.row] || reference || restored;
  }
  // From which the point is seen at its scale, and updated.
  bool SetReference(const Table& table, std::uint32_t map, MapPoint& point) const {
    if (!Set(table, kReference, point.reference)) return false;
    const auto fail = [&](std::string_view problem) {
      return table.LineError(Concat("column reference_keyframe: keyframe ", point.reference.value(), " ", problem));
    };
    if (index_.KeyFrameRow(map, point.reference) == kNoRow) throw fail("is not in the map of the point");
    if (std::ranges::find(point.observations, point.reference, &Observation::keyframe) == point.observations.end())
      throw fail("does not observe the point");
    return true;
  }

  void EditKeyFrame(const Table& table, const EntityRow& place, TableEditChanges& changes) {
    KeyFrame& keyframe = atlas_.maps[place.map].keyframes[place.row];
    const bool moved = SetPose(table, keyframe.camera_from_world);
    detail::EditedRows& flags = flags_[place.map].keyframes;
    flags.moved[place.row] = moved;
    if (moved && keyframe.imu_calibration.is_set) keyframe.body_position = WorldFromBody(keyframe).translation;
    bool changed = SetTime(table, keyframe.timestamp);
    changed |= Set(table, kFrameId, keyframe.frame_id);
    const bool has_velocity = SaysAny(table, kVelocity, 3);
    changed |= SetVector(table, kVelocity, keyframe.velocity) || (has_velocity && !keyframe.has_velocity);
    if (has_velocity && !keyframe.has_velocity) keyframe.has_velocity = true;
    changed |= Set(table, kNotErase, keyframe.not_erase);
    changed |= SetBad(table, kKeyFrameBad, keyframe.bad, flags.dropped[place.row]);
    ++changes.rows;
    changes.moved += moved;
    changes.changed += changed;
  }

  template <class List>
  static void DropRows(const List& list, const detail::EditedRows& flags, bool missing, std::vector<std::uint8_t>& kept,
                       TableEditChanges& changes) {
    missing &= std::ranges::find(flags.seen, 1) != flags.seen.end();
    for (std::size_t row = 0; row < list.size(); ++row) {
      if (flags.dropped[row] == 0 && (!missing || flags.seen[row] != 0 || list[row].bad)) continue;
      kept[row] = 0;
      ++changes.deleted;
    }
  }

  Atlas& atlas_;
  AtlasIndex index_;
  std::vector<detail::EditedMap> flags_;
};

void ApplyTables(Atlas& atlas, const TableEditOptions& options, TableEditReport& report) {
  Editor editor(atlas);
  if (options.points)
    detail::ParseFile(*options.points, "a table of points", [&](std::string_view text) {
      report.points.has_open_end = detail::HasOpenEnd(text);
      editor.ReadPoints(text, report.points);
    });
  if (options.keyframes)
    detail::ParseFile(*options.keyframes, "a table of keyframes", [&](std::string_view text) {
      report.keyframes.has_open_end = detail::HasOpenEnd(text);
      editor.ReadKeyFrames(text, report.keyframes);
    });
  report.refreshed = editor.Refresh();
  report.removed.before = report.removed.after = CountEntities(atlas);
  Subset subset = Subset::Everything(atlas);
  editor.Drop(options.delete_missing, subset, report);
  if (report.points.deleted + report.keyframes.deleted == 0) return;
  if (report.keyframes.deleted > 0) SettleBorder(AtlasIndex(atlas), Border::kStrict, subset, options.threads);
  report.removed = KeepSubset(atlas, subset, options.threads);
}

void WarnOf(const std::string& path, const TableEditChanges& changes, Notices& notices) {
  if (changes.has_open_end) notices.Warn(detail::OpenEndWarning(path));
  if (changes.ignored.empty()) return;
  std::string names;
  for (const std::string& name : changes.ignored) names += (names.empty() ? "" : ", ") + name;
  notices.Warn(path + ": columns of other names are left aside: " + names);
}

}  // namespace

TableEditReport EditByTables(Atlas& atlas, const TableEditOptions& options) {
  if (!options.points && !options.keyframes)
    throw Error(ErrorKind::kUsage, "no table to edit by; TableEditOptions::points or keyframes names one");
  TableEditReport report;
  Atlas edited = atlas;
  ApplyTables(edited, options, report);
  if (options.journal) {
    report.journal = {.original = HashWithoutEncoding(atlas, options.threads), .encoding = atlas.encoding};
    AppendChanges(atlas, edited, "edit", report.journal);
    report.journal.repaired = HashWithoutEncoding(edited, options.threads);
  }
  atlas = std::move(edited);
  return report;
}

void TellWarnings(const TableEditReport& report, const TableEditOptions& options, Notices& notices) {
  if (options.points) WarnOf(options.points->path, report.points, notices);
  if (options.keyframes) WarnOf(options.keyframes->path, report.keyframes, notices);
}

}  // namespace slamdb
