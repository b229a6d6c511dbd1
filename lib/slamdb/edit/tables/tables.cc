// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/tables/tables.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/lengths.h"
#include "slamdb/base/detail/parse_file.h"
#include "slamdb/base/detail/table.h"
#include "slamdb/base/error.h"
#include "slamdb/base/time_unit.h"
#include "slamdb/edit/tables/detail/edited.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/detail/camera_in_world.h"
#include "slamdb/model/detail/is_pose.h"
#include "slamdb/model/digest.h"
#include "slamdb/model/index.h"

namespace slamdb {
namespace {

using detail::Concat;
using detail::Table;
using detail::TableKind;

// ---- what tables have

enum PointColumn : std::size_t {
  kPointId,
  kPointMap,
  kX,
  kNormalX = kX + 3,
  kReference = kNormalX + 3,
  kNearest,
  kFarthest,
  kPointBad
};

const TableKind& PointTable() {
  constexpr int kOptional = detail::Column::kOptional;
  static const TableKind kind = {.columns = {{{"id"}, 0},
                                             {{"map"}, kOptional},
                                             {{"x"}, kOptional},
                                             {{"y"}, kOptional},
                                             {{"z"}, kOptional},
                                             {{"nx"}, kOptional},
                                             {{"ny"}, kOptional},
                                             {{"nz"}, kOptional},
                                             {{"reference_keyframe"}, kOptional},
                                             {{"min_distance"}, kOptional},
                                             {{"max_distance"}, kOptional},
                                             {{"bad"}, kOptional}},
                                 .expected = "a table of points whose first line names its columns, `id` among them",
                                 .by_position = false};
  return kind;
}
// What slamdb writes besides: it follows from the rest.
constexpr std::string_view kDerivedOfPoints[] = {"observations", "reprojection_error"};

enum KeyFrameColumn : std::size_t {
  kKeyFrameId,
  kKeyFrameMap,
  kTimestamp,
  kFrameId,
  kPose,
  kVelocity = kPose + 7,
  kNotErase = kVelocity + 3,
  kKeyFrameBad
};

const TableKind& KeyFrameTableKind() {
  constexpr int kOptional = detail::Column::kOptional;
  static const TableKind kind = {.columns = {{{"id"}, 0},
                                             {{"map"}, kOptional},
                                             {{"timestamp"}, kOptional},
                                             {{"frame_id"}, kOptional},
                                             {{"x"}, kOptional},
                                             {{"y"}, kOptional},
                                             {{"z"}, kOptional},
                                             {{"qx"}, kOptional},
                                             {{"qy"}, kOptional},
                                             {{"qz"}, kOptional},
                                             {{"qw"}, kOptional},
                                             {{"vx"}, kOptional},
                                             {{"vy"}, kOptional},
                                             {{"vz"}, kOptional},
                                             {{"not_erase"}, kOptional},
                                             {{"bad"}, kOptional}},
                                 .expected = "a table of keyframes whose first line names its columns, `id` among them",
                                 .by_position = false};
  return kind;
}
constexpr std::string_view kDerivedOfKeyFrames[] = {"camera",     "parent",      "children",  "connections",
                                                    "loop_edges", "merge_edges", "keypoints", "map_points"};

std::vector<std::string> IgnoredColumns(const Table& table, const TableKind& kind,
                                        std::span<const std::string_view> derived) {
  std::vector<std::string> ignored;
  for (const detail::ColumnName& column : table.names()) {
    const bool known = std::ranges::any_of(kind.columns, [&](const detail::Column& wanted) {
      return std::ranges::find(wanted.names, column.name) != wanted.names.end();
    });
    if (!known && std::ranges::find(derived, column.name) == derived.end()) ignored.push_back(column.text);
  }
  return ignored;
}

// The other table has ids and positions, too, and would move what it is not about.
void RefuseOther(const Table& table, std::string_view only_other_has, std::string_view wanted, std::string_view found) {
  if (std::ranges::find(table.names(), only_other_has, &detail::ColumnName::name) == table.names().end()) return;
  throw Error(
      ErrorKind::kDamaged, "", "line 1",
      Concat("a table of ", found, "s, as its column ", only_other_has, " says, in place of one of ", wanted, "s"));
}
void RequireUsualUnits(const Table& table, std::initializer_list<std::size_t> lengths) {
  for (const std::size_t column : lengths) detail::RequireMetres(table, column);
}
void RequireSeconds(const Table& table, std::size_t column) {
  const detail::ColumnName* name = table.NameOf(column);
  if (name == nullptr || name->unit.empty() || TimeUnitByName(name->unit) == TimeUnit::kSeconds) return;
  throw Error(ErrorKind::kUnsupported, "", "column " + name->text,
              Concat("expected seconds, and no unit in the name, found '", name->unit, "'"));
}

// ---- cells

// Seconds since 1970 of years that have five digits are something else, such as nanoseconds.
constexpr double kLatest = 2.5e11;

bool SameNumber(auto a, auto b) { return a == b || (a != a && b != b); }

// Whether the cell says something else than the field has, which it then has.
template <class Number>
bool Set(const Table& table, std::size_t column, Number& field) {
  if (table.Raw(column).empty()) return false;
  const auto value = table.Get<Number>(column);
  if (SameNumber(value, field)) return false;
  field = value;
  return true;
}

bool Set(const Table& table, std::size_t column, KeyFrameId& field) {
  std::uint64_t id = field.value();
  const bool changed = Set(table, column, id);
  field = KeyFrameId(id);
  return changed;
}

bool Set(const Table& table, std::size_t column, Flag& field) {
  const std::string_view text = table.Raw(column);
  if (text.empty()) return false;
  const bool value = text == "1" || text == "true";
  if (!value && text != "0" && text != "false") throw table.CellError(column, "0 or 1, false or true");
  if (value == static_cast<bool>(field)) return false;
  field = value;
  return true;
}

// What turns bad is dropped: ORB-SLAM3 saves nothing that is, and reading something that refers to it crashes.
// Whether something is no longer bad.
bool SetBad(const Table& table, std::size_t column, Flag& bad, std::uint8_t& dropped) {
  Flag wanted = bad;
  if (!Set(table, column, wanted)) return false;
  dropped = wanted ? 1 : 0;
  if (wanted) return false;
  bad = wanted;
  return true;
}

// Whether any of so many cells from the column on says something.
bool SaysAny(const Table& table, std::size_t first, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i)
    if (!table.Raw(first + i).empty()) return true;
  return false;
}

// The same of each number from the column on.
bool SetNumbers(const Table& table, std::size_t first, std::span<float> numbers) {
  bool changed = false;
  for (std::size_t i = 0; i < numbers.size(); ++i) changed |= Set(table, first + i, numbers[i]);
  return changed;
}

void RequireFinite(const Table& table, std::size_t first, std::span<const float> numbers) {
  for (std::size_t i = 0; i < numbers.size(); ++i)
    if (!std::isfinite(numbers[i])) throw table.CellError(first + i, "a finite number");
}

bool SetVector(const Table& table, std::size_t first, Eigen::Vector3f& field) {
  Eigen::Vector3f value = field;
  if (!SetNumbers(table, first, {value.data(), 3})) return false;
  RequireFinite(table, first, {value.data(), 3});
  field = value;
  return true;
}

// ORB-SLAM3's are means of the directions in which keyframes see a point.
bool SetNormal(const Table& table, Eigen::Vector3f& field) {
  if (!SetVector(table, kNormalX, field)) return false;
  constexpr float kLongest = 1.001F;
  if (const float length = field.norm(); !(length > 0 && length <= kLongest))
    throw table.LineError(Concat("no viewing direction in columns nx, ny, nz: it has length ", length,
                                 ", expected above 0 and at most 1"));
  return true;
}

// The range of distances from which a point is looked for.
bool SetRange(const Table& table, MapPoint& point) {
  const bool nearest = Set(table, kNearest, point.min_distance);
  const bool farthest = Set(table, kFarthest, point.max_distance);
  const auto require = [&](bool set, std::size_t column, float distance) {
    if (set && !(std::isfinite(distance) && distance > 0)) throw table.CellError(column, "a finite distance above 0");
  };
  require(nearest, kNearest, point.min_distance);
  require(farthest, kFarthest, point.max_distance);
  if ((nearest || farthest) && !(point.min_distance <= point.max_distance))
    throw table.LineError(Concat("no range of distances in columns min_distance, max_distance: from ",
                                 point.min_distance, " to ", point.max_distance));
  return nearest || farthest;
}

// The poses that tables hold are those of the camera in the world.
bool SetPose(const Table& table, Rigid3f& camera_from_world) {
  Rigid3f pose = detail::CameraInWorld(camera_from_world);
  const bool moved = SetNumbers(table, kPose, {pose.translation.data(), 3});
  const bool turned = SetNumbers(table, kPose + 3, {pose.rotation.coeffs().data(), 4});
  if (!moved && !turned) return false;
  RequireFinite(table, kPose, {pose.translation.data(), 3});
  RequireFinite(table, kPose + 3, {pose.rotation.coeffs().data(), 4});
  if (!detail::IsPose(pose))
    throw table.LineError(
        Concat("no rotation in columns qx, qy, qz, qw: it has length ", pose.rotation.norm(), ", expected 1"));
  camera_from_world = pose.Normalized().Inverse();
  return true;
}

// ---- rows

constexpr std::string_view kAddNothing = "; tables add nothing, ndjson does";

class Editor {
 public:
  explicit Editor(Atlas& atlas) : atlas_(atlas), index_(atlas) {
    for (const Map& map : atlas.maps) flags_.emplace_back(map);
  }

  void ReadPoints(std::string_view text, TableEditChanges& changes) {
    Table table(text, PointTable());
    RefuseOther(table, "qw", "point", "keyframe");
    RequireUsualUnits(table, {kX, kX + 1, kX + 2, kNearest, kFarthest});
    changes.ignored = IgnoredColumns(table, PointTable(), kDerivedOfPoints);
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
    RefuseOther(table, "min_distance", "keyframe", "point");
    RequireUsualUnits(table, {kPose, kPose + 1, kPose + 2});
    RequireSeconds(table, kTimestamp);
    changes.ignored = IgnoredColumns(table, KeyFrameTableKind(), kDerivedOfKeyFrames);
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
    bool changed = Set(table, kTimestamp, keyframe.timestamp);
    if (changed && !(std::abs(keyframe.timestamp) < kLatest)) throw table.CellError(kTimestamp, "a time in seconds");
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
    detail::ParseFile(*options.points, "a table of points",
                      [&](std::string_view text) { editor.ReadPoints(text, report.points); });
  if (options.keyframes)
    detail::ParseFile(*options.keyframes, "a table of keyframes",
                      [&](std::string_view text) { editor.ReadKeyFrames(text, report.keyframes); });
  report.refreshed = editor.Refresh();
  report.removed.before = report.removed.after = CountEntities(atlas);
  Subset subset = Subset::Everything(atlas);
  editor.Drop(options.delete_missing, subset, report);
  if (report.points.deleted + report.keyframes.deleted == 0) return;
  if (report.keyframes.deleted > 0) SettleBorder(AtlasIndex(atlas), Border::kStrict, subset, options.threads);
  report.removed = KeepSubset(atlas, subset, options.threads);
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

}  // namespace slamdb
