// SPDX-License-Identifier: BSD-3-Clause
// Tables as the formats csv and csv-keyframes write them, changed, and applied; and taken back.
#include "slamdb/edit/tables/tables.h"

#include <gmock/gmock.h>

#include <cmath>

#include "slamdb/edit/ids/renumber.h"
#include "slamdb/formats/formats.h"
#include "slamdb/model/digest.h"
#include "tests/edit/soundness.h"
#include "tests/edit/worlds.h"
#include "tests/support/equals_atlas.h"
#include "tests/support/kind_of.h"

namespace slamdb {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using Rows = std::vector<std::vector<std::string>>;

// A table, its first row the names of the columns.
class Csv {
 public:
  Csv(const Atlas& atlas, std::string_view format) {
    const std::string text = EncodeAtlas(atlas, {.format = std::string(format)});
    std::string cell;
    rows_.emplace_back();
    for (const char letter : text) {
      if (letter != ',' && letter != '\n') {
        cell += letter;
        continue;
      }
      rows_.back().push_back(std::exchange(cell, ""));
      if (letter == '\n') rows_.emplace_back();
    }
    rows_.pop_back();
  }
  std::size_t size() const { return rows_.size() - 1; }
  std::string& operator()(std::size_t row, std::string_view column) {
    const auto found = std::ranges::find(rows_[0], column);
    if (found == rows_[0].end()) throw Error(ErrorKind::kInternal, "the test names no column");
    return rows_[row + 1][static_cast<std::size_t>(found - rows_[0].begin())];
  }
  std::size_t RowOf(std::string_view id) {
    for (std::size_t row = 0; row < size(); ++row)
      if ((*this)(row, "id") == id) return row;
    throw Error(ErrorKind::kInternal, "the test names no row");
  }
  void Delete(std::size_t row) { rows_.erase(rows_.begin() + static_cast<std::ptrdiff_t>(row) + 1); }
  void Rename(std::string_view from, std::string_view to) {
    std::ranges::replace(rows_[0], std::string(from), std::string(to));
  }
  void DropColumn(std::string_view name) {
    const auto place = std::ranges::find(rows_[0], name) - rows_[0].begin();
    for (std::vector<std::string>& row : rows_) row.erase(row.begin() + place);
  }
  void KeepRows(std::size_t count) { rows_.resize(count + 1); }
  std::string text(std::string_view separator = ",") const {
    std::string text;
    for (const std::vector<std::string>& row : rows_) {
      for (std::size_t i = 0; i < row.size(); ++i) text.append(i > 0 ? separator : "").append(row[i]);
      text += '\n';
    }
    return text;
  }

 private:
  Rows rows_;
};

Source SourceOf(const std::string& text, const char* name) { return {std::as_bytes(std::span(text)), name}; }

// Both tables, as files.
struct Given {
  std::optional<std::string> points, keyframes;
  bool delete_missing = false;
};
TableEditReport Edit(Atlas& atlas, const Given& given) {
  TableEditOptions options{.delete_missing = given.delete_missing, .threads = 1};
  if (given.points) options.points = SourceOf(*given.points, "points.csv");
  if (given.keyframes) options.keyframes = SourceOf(*given.keyframes, "poses.csv");
  return EditByTables(atlas, options);
}

Atlas Small(int maps = 1) {
  return SynthesizeAtlas({.sensor = Sensor::kRgbd, .maps = maps, .keyframes = 8, .points = 150, .features = 150});
}

class EditEveryWorld : public ::testing::TestWithParam<World> {};

TEST_P(EditEveryWorld, TablesAsTheyWereWrittenChangeNotABit) {
  Atlas atlas = MakeWorld(GetParam(), 2);
  atlas.maps[0].points[3].bad = true;
  atlas.maps[1].keyframes[2].camera_from_world.rotation.coeffs() *= 1.0001F;  // as no rotation that is written back
  const Atlas before = atlas;
  const TableEditReport report = Edit(atlas, {.points = EncodeAtlas(atlas, {.format = "csv"}),
                                              .keyframes = EncodeAtlas(atlas, {.format = "csv-keyframes"}),
                                              .delete_missing = true});
  EXPECT_THAT(atlas, EqualsAtlas(before));
  EXPECT_EQ(report.points.rows, atlas.maps[0].points.size() + atlas.maps[1].points.size() - 1);
  EXPECT_EQ(report.points.moved + report.points.changed + report.points.deleted, 0U);
  EXPECT_EQ(report.keyframes.moved + report.keyframes.changed + report.keyframes.deleted, 0U);
  EXPECT_THAT(report.journal.edits, IsEmpty());
  EXPECT_THAT(report.points.ignored, IsEmpty());
  EXPECT_THAT(report.keyframes.ignored, IsEmpty());
}

// Whatever was edited: check finds nothing new, stock Boost reads it, and the journal takes every bit back.
TEST_P(EditEveryWorld, LeavesASoundAtlasThatTheJournalTakesBack) {
  const Atlas before = MakeWorld(GetParam(), 2);
  Csv points(before, "csv"), poses(before, "csv-keyframes");
  for (std::size_t row = 0; row < points.size(); row += 7)
    points(row, "x") = std::to_string(std::stof(points(row, "x")) + 0.01F);
  for (std::size_t row = 1; row < poses.size(); row += 5)
    poses(row, "z") = std::to_string(std::stof(poses(row, "z")) + 0.02F);
  points.Delete(20), points.Delete(3);
  poses.Delete(poses.size() - 1), poses.Delete(6), poses.Delete(2);
  Atlas atlas = before;
  const TableEditReport report =
      Edit(atlas, {.points = points.text(), .keyframes = poses.text(), .delete_missing = true});
  EXPECT_EQ(report.points.deleted, 2U);
  EXPECT_EQ(report.keyframes.deleted, 3U);
  EXPECT_GT(report.points.moved, 0U);
  EXPECT_GT(report.keyframes.moved, 0U);
  EXPECT_THAT(testing::NewTroubles(testing::Troubles(before), atlas), IsEmpty());
  const TemporaryFolder folder;
  std::size_t keyframes = 0;
  for (const Map& map : atlas.maps) keyframes += map.keyframes.size();
  EXPECT_EQ(testing::KeyFramesThatBoostReads(atlas, folder.Path("a.osa")), keyframes);
  UndoRepair(atlas, report.journal);
  EXPECT_THAT(atlas, EqualsAtlas(before));
}

INSTANTIATE_TEST_SUITE_P(Worlds, EditEveryWorld, ::testing::ValuesIn(kWorlds), NameOfWorld);

TEST(Edit, MovesAPointAndWhatFollowsFromThat) {
  Atlas atlas = Small();
  const Atlas before = atlas;
  Csv points(atlas, "csv");
  points(4, "x") = "1.25", points(4, "y") = "-0.5", points(4, "z") = "2";
  const TableEditReport report = Edit(atlas, {.points = points.text()});
  const MapPoint& point = atlas.maps[0].points[4];
  EXPECT_EQ(point.position, Eigen::Vector3f(1.25F, -0.5F, 2));
  EXPECT_EQ(report.points.moved, 1U);
  EXPECT_EQ(report.points.changed, 0U);
  EXPECT_EQ(report.refreshed, 1U);
  EXPECT_NE(point.normal, before.maps[0].points[4].normal);
  EXPECT_NE(point.max_distance, before.maps[0].points[4].max_distance);
  EXPECT_EQ(report.journal.edits.size(), 1U);
  Atlas same = atlas;
  same.maps[0].points[4] = before.maps[0].points[4];
  EXPECT_THAT(same, EqualsAtlas(before)) << "nothing else changed";
}

TEST(Edit, ARowsOwnNormalAndRangeCountMoreThanWhatFollows) {
  Atlas atlas = Small();
  Csv points(atlas, "csv");
  points(4, "x") = "1.25";
  points(4, "nx") = "0", points(4, "ny") = "0", points(4, "nz") = "1";
  points(4, "max_distance") = "77";
  const TableEditReport report = Edit(atlas, {.points = points.text()});
  EXPECT_EQ(atlas.maps[0].points[4].normal, Eigen::Vector3f(0, 0, 1));
  EXPECT_EQ(atlas.maps[0].points[4].max_distance, 77);
  EXPECT_EQ(report.points.changed, 1U);
}

TEST(Edit, MovesAKeyFrameAndItsBody) {
  Atlas atlas = MakeWorld(kWorlds[3], 1);  // stereo and inertial
  const KeyFrame before = atlas.maps[0].keyframes[5];
  Csv poses(atlas, "csv-keyframes");
  poses(5, "x") = "3", poses(5, "y") = "2", poses(5, "z") = "1";
  const TableEditReport report = Edit(atlas, {.keyframes = poses.text()});
  const KeyFrame& keyframe = atlas.maps[0].keyframes[5];
  EXPECT_LT((keyframe.camera_from_world.Inverse().translation - Eigen::Vector3f(3, 2, 1)).norm(), 1e-5F);
  EXPECT_LT(keyframe.camera_from_world.rotation.angularDistance(before.camera_from_world.rotation), 1e-3F);
  EXPECT_NE(keyframe.body_position, before.body_position);
  EXPECT_EQ(report.keyframes.moved, 1U);
  EXPECT_GT(report.refreshed, 0U) << "points that it sees";
}

TEST(Edit, ChangesOtherColumns) {
  Atlas atlas = Small();
  Edit(atlas, {.keyframes = "id,timestamp,frame_id,vx,vy,vz,not_erase\n" +
                            std::to_string(atlas.maps[0].keyframes[1].id.value()) + ",12.5,77,1,2,3,1\n"});
  const KeyFrame& keyframe = atlas.maps[0].keyframes[1];
  EXPECT_EQ(keyframe.timestamp, 12.5);
  EXPECT_EQ(keyframe.frame_id, 77U);
  EXPECT_TRUE(keyframe.has_velocity);
  EXPECT_EQ(keyframe.velocity, Eigen::Vector3f(1, 2, 3));
  EXPECT_TRUE(keyframe.not_erase);
}

// Each of the columns by itself, which a group of them once had to go with.
TEST(Edit, SingleComponentsMoveByThemselves) {
  const Atlas before = Small();
  const MapPoint& point = before.maps[0].points[4];
  const KeyFrame& keyframe = before.maps[0].keyframes[3];
  const auto row = [](const auto& entity, const std::string& names, const std::string& cells) {
    return "id," + names + "\n" + std::to_string(entity.id.value()) + "," + cells + "\n";
  };
  Atlas atlas = before;
  const auto moved = [&]() -> const MapPoint& { return atlas.maps[0].points[4]; };
  EXPECT_EQ(Edit(atlas, {.points = row(point, "z", "9")}).points.moved, 1U);
  EXPECT_EQ(moved().position, Eigen::Vector3f(point.position.x(), point.position.y(), 9));
  Edit(atlas, {.points = row(point, "x,y,z", "8,,")});
  EXPECT_EQ(moved().position, Eigen::Vector3f(8, point.position.y(), 9));
  Edit(atlas, {.points = row(point, "nx", "0.25")});
  EXPECT_EQ(moved().normal.x(), 0.25F);
  const auto posed = [&]() -> const KeyFrame& { return atlas.maps[0].keyframes[3]; };
  const auto centre = [](const KeyFrame& k) { return k.camera_from_world.Inverse().translation; };
  EXPECT_EQ(Edit(atlas, {.keyframes = row(keyframe, "x,y,z", "1,2,3")}).keyframes.moved, 1U);
  EXPECT_LT((centre(posed()) - Eigen::Vector3f(1, 2, 3)).norm(), 1e-5F);
  EXPECT_LT(posed().camera_from_world.rotation.angularDistance(keyframe.camera_from_world.rotation), 1e-3F);
  Edit(atlas, {.keyframes = row(keyframe, "y", "7")});
  EXPECT_LT((centre(posed()) - Eigen::Vector3f(1, 7, 3)).norm(), 1e-5F);
  EXPECT_EQ(Edit(atlas, {.keyframes = row(keyframe, "qx,qy,qz,qw", "0,1,0,0")}).keyframes.moved, 1U);
  EXPECT_LT((centre(posed()) - Eigen::Vector3f(1, 7, 3)).norm(), 1e-5F);
  EXPECT_LT(posed().camera_from_world.rotation.angularDistance(Eigen::Quaternionf(0, 0, 1, 0)), 1e-3F);
  Edit(atlas, {.keyframes = row(keyframe, "vy", "0.5")});
  EXPECT_TRUE(posed().has_velocity);
  EXPECT_EQ(posed().velocity.y(), 0.5F);
}

// What refers to something bad makes ORB-SLAM3 crash.
TEST(Edit, WhatTurnsBadIsDeletedWithWhatRefersToIt) {
  const Atlas before = Small();
  Atlas atlas = before;
  const TableEditReport report =
      Edit(atlas, {.points = "id,bad\n" + std::to_string(before.maps[0].points[2].id.value()) + ",1\n",
                   .keyframes = "id,bad\n" + std::to_string(before.maps[0].keyframes[1].id.value()) + ",true\n" +
                                std::to_string(before.maps[0].keyframes[2].id.value()) + ",0\n"});
  EXPECT_EQ(report.points.deleted, 1U);
  EXPECT_EQ(report.keyframes.deleted, 1U);
  EXPECT_EQ(report.removed.keyframes, 1U);
  EXPECT_EQ(atlas.maps[0].keyframes.size(), before.maps[0].keyframes.size() - 1);
  EXPECT_THAT(testing::NewTroubles(testing::Troubles(before), atlas), IsEmpty());
  UndoRepair(atlas, report.journal);
  EXPECT_THAT(atlas, EqualsAtlas(before));
}

TEST(Edit, EmptyCellsAndMissingColumnsChangeNothing) {
  Atlas atlas = Small();
  const Atlas before = atlas;
  const std::string id = std::to_string(atlas.maps[0].points[0].id.value());
  const TableEditReport report = Edit(atlas, {.points = "id,x,y,z,max_distance\n" + id + ",,,,\n"});
  EXPECT_THAT(atlas, EqualsAtlas(before));
  EXPECT_EQ(report.points.rows, 1U);
}

TEST(Edit, TakesTheDialectsOfSpreadsheets) {
  Atlas atlas = Small();
  const std::string id = std::to_string(atlas.maps[0].points[0].id.value());
  Edit(atlas, {.points = "\xef\xbb\xbfsep=;\r\nZ;Y;X;ID\r\n3,5;-2,5e-05;1,5E+2;" + id + "\r\n"});
  EXPECT_EQ(atlas.maps[0].points[0].position, Eigen::Vector3f(150, -2.5e-5F, 3.5F));
}

TEST(Edit, LeavesAsideColumnsOfOtherNames) {
  Atlas atlas = Small();
  Csv points(atlas, "csv");
  points.Rename("nz", "my note");
  points.DropColumn("reprojection_error");
  const TableEditReport report = Edit(atlas, {.points = points.text()});
  EXPECT_THAT(report.points.ignored, ElementsAre("my note"));
}

// ---- deleting

TEST(Edit, DeletesWhatHasNoRowOnlyWhenAsked) {
  const Atlas before = Small();
  Csv points(before, "csv");
  points.KeepRows(100);
  Atlas atlas = before;
  EXPECT_EQ(Edit(atlas, {.points = points.text()}).points.deleted, 0U);
  EXPECT_THAT(atlas, EqualsAtlas(before));
  const TableEditReport report = Edit(atlas, {.points = points.text(), .delete_missing = true});
  EXPECT_EQ(report.points.deleted, before.maps[0].points.size() - 100);
  EXPECT_EQ(atlas.maps[0].points.size(), 100U);
  for (const KeyFrame& keyframe : atlas.maps[0].keyframes)
    for (const MapPointId id : keyframe.features.map_points)
      EXPECT_TRUE(!id || std::ranges::any_of(atlas.maps[0].points, [&](const MapPoint& p) { return p.id == id; }));
}

TEST(Edit, AnEmptyTableAndOneOfAnotherMapDeleteNothing) {
  const Atlas before = Small(2);
  Csv points(before, "csv");
  Atlas atlas = before;
  Csv none = points;
  none.KeepRows(0);
  EXPECT_EQ(Edit(atlas, {.points = none.text(), .delete_missing = true}).points.rows, 0U);
  EXPECT_THAT(atlas, EqualsAtlas(before));
  points.KeepRows(before.maps[0].points.size() - 1);  // all but one of the first map, none of the second
  const TableEditReport report = Edit(atlas, {.points = points.text(), .delete_missing = true});
  EXPECT_EQ(report.points.deleted, 1U);
  EXPECT_EQ(atlas.maps[1].points.size(), before.maps[1].points.size());
}

// Every keyframe by itself, the first and the last among them: those that stay hang together in one tree.
TEST(Edit, DeletingAnyKeyFrameKeepsTheSpanningTreeWhole) {
  const Atlas before = Small();
  for (std::size_t row = 0; row < before.maps[0].keyframes.size(); ++row) {
    Csv poses(before, "csv-keyframes");
    poses.Delete(row);
    Atlas atlas = before;
    const TableEditReport report = Edit(atlas, {.keyframes = poses.text(), .delete_missing = true});
    ASSERT_EQ(report.keyframes.deleted, 1U);
    std::map<KeyFrameId, KeyFrameId> parents;
    std::size_t roots = 0;
    for (const KeyFrame& keyframe : atlas.maps[0].keyframes) {
      parents[keyframe.id] = keyframe.parent;
      roots += !keyframe.parent;
    }
    EXPECT_EQ(roots, 1U) << row;
    for (const auto& [id, parent] : parents) {
      KeyFrameId at = id;
      for (std::size_t steps = 0; at && steps <= parents.size(); ++steps) at = parents.at(at);
      EXPECT_FALSE(at) << "of " << row << " kf " << id.value() << " hangs in a circle";
    }
    EXPECT_THAT(testing::NewTroubles(testing::Troubles(before), atlas), IsEmpty()) << row;
  }
}

TEST(Edit, BothTablesAtOnceDeleteTogether) {
  const Atlas before = Small();
  Csv points(before, "csv"), poses(before, "csv-keyframes");
  points.KeepRows(90), poses.KeepRows(5);
  points(0, "z") = "9";
  Atlas atlas = before;
  const TableEditReport report =
      Edit(atlas, {.points = points.text(), .keyframes = poses.text(), .delete_missing = true});
  EXPECT_EQ(report.keyframes.deleted, 3U);
  EXPECT_EQ(report.removed.keyframes, 3U);
  EXPECT_GE(report.removed.points, report.points.deleted) << "and those that too few keyframes see";
  EXPECT_EQ(atlas.maps[0].keyframes.size(), 5U);
  UndoRepair(atlas, report.journal);
  EXPECT_THAT(atlas, EqualsAtlas(before));
}

// ---- errors: nothing changes

struct Refused {
  const char *name, *points, *keyframes, *problem;
  friend void PrintTo(const Refused& refused, std::ostream* out) { *out << refused.name; }
};
class EditErrors : public ::testing::TestWithParam<Refused> {};

// Of an atlas with maps 0 and 1, each of points and keyframes of the same ids.
TEST_P(EditErrors, SayFileAndLine) {
  const Refused& refused = GetParam();
  Atlas atlas = Small();
  atlas.maps.push_back(atlas.maps[0]);
  atlas.maps[1].id = MapId(1);
  const Atlas before = atlas;
  const auto filled = [&](const char* text) -> std::optional<std::string> {
    if (text == nullptr) return std::nullopt;
    std::string table = text;  // P, K, and U, which does not see P, are ids that there are
    const MapPoint& point = atlas.maps[0].points[2];
    const auto unseeing = std::ranges::find_if(atlas.maps[0].keyframes, [&](const KeyFrame& keyframe) {
      return std::ranges::find(point.observations, keyframe.id, &Observation::keyframe) == point.observations.end();
    });
    for (const auto& [letter, id] : {std::pair('P', point.id.value()), std::pair('U', unseeing->id.value()),
                                     std::pair('K', atlas.maps[0].keyframes[2].id.value())})
      for (std::size_t at = table.find(letter); at != table.npos; at = table.find(letter))
        table.replace(at, 1, std::to_string(id));
    return table;
  };
  const Given given{.points = filled(refused.points), .keyframes = filled(refused.keyframes)};
  const std::string error = ErrorOf([&] { Edit(atlas, given); });
  EXPECT_THAT(error, HasSubstr(refused.problem));
  EXPECT_THAT(error, HasSubstr(refused.points != nullptr ? "points.csv: line " : "poses.csv: line "));
  EXPECT_THAT(atlas, EqualsAtlas(before));
}

constexpr Refused kRefused[] = {
    {"NoId", "map,x,y,z\n0,1,2,3\n", nullptr,
     "line 1: expected a table of points whose first line names its columns, `id` among them"},
    {"NoNames", "1,2,3,4\n", nullptr, "line 1: expected a table of points whose first line names its columns"},
    {"New", "map,id,x,y,z\n0,P,1,2,3\n0,999999,1,2,3\n", nullptr,
     "line 3: map 0 has no point 999999; tables add nothing, ndjson does"},
    {"NewKeyFrame", nullptr, "map,id,timestamp\n1,999999,2\n", "line 2: map 1 has no keyframe 999999; tables add"},
    {"NoMap", "map,id,x,y,z\n7,P,1,2,3\n", nullptr, "line 2: the atlas has no map 7"},
    {"Ambiguous", "id,x,y,z\nP,1,2,3\n", nullptr, "line 2: ids of points are not unique in the atlas; a column `map`"},
    {"AmbiguousKeyFrame", nullptr, "id,timestamp\nK,1\n", "line 2: ids of keyframes are not unique"},
    {"Twice", "map,id,x,y,z\n0,P,1,2,3\n1,P,1,2,3\n0,P,1,2,4\n", nullptr, "line 4: has the id of a row above"},
    {"NoNumber", "map,id,x,y,z\n0,P,1,two,3\n", nullptr, "line 2: expected a number, found 'two' in column y"},
    {"NoNumberAlone", "map,id,x\n0,P,abc\n", nullptr, "line 2: expected a number, found 'abc' in column x"},
    {"NotFiniteAlone", "map,id,z\n0,P,inf\n", nullptr, "line 2: expected a finite number, found 'inf' in column z"},
    {"NoRotationAlone", nullptr, "map,id,qx,qy,qz,qw\n0,K,0,0,0,0\n", "line 2: no rotation in columns qx"},
    {"NotFinitePoseAlone", nullptr, "map,id,x\n0,K,nan\n", "line 2: expected a finite number, found 'nan' in column x"},
    {"HalfAnExponent", "map;id;x\n0;P;4,9e-\n", nullptr, "line 2: expected a number, found '4,9e-' in column x"},
    {"NotFinite", "map,id,x,y,z\n0,P,1,nan,3\n", nullptr, "line 2: expected a finite number, found 'nan' in column y"},
    {"Infinite", "map,id,x,y,z\n0,P,1,inf,3\n", nullptr, "line 2: expected a finite number, found 'inf' in column y"},
    {"NegativeId", "map,id,x,y,z\n0,-1,1,2,3\n", nullptr, "line 2: expected an id, found '-1' in column id"},
    {"HugeId", "map,id,x,y,z\n0,18446744073709551616,1,2,3\n", nullptr, "line 2: expected an id"},
    {"NoneId", "map,id,x,y,z\n0,18446744073709551615,1,2,3\n", nullptr, "line 2: map 0 has no point"},
    {"Flag", "map,id,bad\n0,P,maybe\n", nullptr, "line 2: expected 0 or 1, false or true, found 'maybe' in column bad"},
    {"Reference", "map,id,reference_keyframe\n0,P,999999\n", nullptr,
     "line 2: column reference_keyframe: keyframe 999999 is not in the map"},
    {"ReferenceThatDoesNotSeeIt", "map,id,reference_keyframe\n0,P,U\n", nullptr, "does not observe the point"},
    {"NormalWithoutLength", "map,id,nx,ny,nz\n0,P,0,0,0\n", nullptr, "line 2: no viewing direction in columns nx"},
    {"LongNormal", "map,id,nx,ny,nz\n0,P,3,0,0\n", nullptr, "it has length 3, expected above 0 and at most 1"},
    {"NotFiniteNormal", "map,id,nx,ny,nz\n0,P,nan,0,0\n", nullptr, "found 'nan' in column nx"},
    {"NegativeDistance", "map,id,min_distance\n0,P,-1\n", nullptr,
     "line 2: expected a finite distance above 0, found '-1' in column min_distance"},
    {"NotFiniteDistance", "map,id,max_distance\n0,P,nan\n", nullptr, "found 'nan' in column max_distance"},
    {"NoRange", "map,id,min_distance,max_distance\n0,P,4,2\n", nullptr,
     "line 2: no range of distances in columns min_distance, max_distance: from 4 to 2"},
    {"NotANumberTime", nullptr, "map,id,timestamp\n0,K,nan\n", "found 'nan' in column timestamp"},
    {"NotFiniteVelocity", nullptr, "map,id,vx,vy,vz\n0,K,0,inf,0\n", "found 'inf' in column vy"},
    {"TooFewCells", "map,id,x,y,z\n0,P,1,2\n", nullptr, "line 2: expected 5 cells, found 4"},
    {"TooManyCells", "map,id,x,y,z\n0,P,1,2,3,4\n", nullptr, "line 2: expected 5 cells, found 6"},
    {"ColumnTwice", "map,id,x,x,y,z\n0,P,1,2,3,4\n", nullptr, "columns 3 and 4 are both named x"},
    {"Rotation", nullptr, "map,id,x,y,z,qx,qy,qz,qw\n0,K,1,2,3,0,0,0,0\n", "line 2: no rotation in columns"},
    {"LongRotation", nullptr, "map,id,x,y,z,qx,qy,qz,qw\n0,K,1,2,3,0,0,0,90\n",
     "line 2: no rotation in columns qx, qy, qz, qw: it has length 90"},
    {"NotFiniteRotation", nullptr, "map,id,x,y,z,qx,qy,qz,qw\n0,K,1,2,3,nan,0,0,1\n",
     "line 2: expected a finite number, found 'nan' in column qx"},
    {"Time", nullptr, "map,id,timestamp\n0,K,inf\n",
     "line 2: expected a time in seconds, found 'inf' in column timestamp"},
    {"OfKeyFrames", "map,id,x,y,z,qx,qy,qz,qw\n0,P,1,2,3,0,0,0,1\n", nullptr,
     "line 1: a table of keyframes, as its column qw says, in place of one of points"},
    {"OfPoints", nullptr, "map,id,x,y,z,min_distance\n0,K,1,2,3,4\n", "line 1: a table of points, as its column"},
    {"Nanoseconds", nullptr, "map,id,timestamp\n0,K,1403636579763555584\n", "line 2: expected a time in seconds"},
};

INSTANTIATE_TEST_SUITE_P(Tables, EditErrors, ::testing::ValuesIn(kRefused),
                         [](const auto& instance) { return std::string(instance.param.name); });

TEST(Edit, RefusesOtherUnits) {
  Atlas atlas = Small();
  const auto error = [&](const Given& given) { return ErrorOf([&] { Edit(atlas, given); }); };
  EXPECT_THAT(error({.points = "id,x [mm],y [mm],z [mm]\n"}),
              HasSubstr("points.csv: column x [mm]: expected metres, or the unit of the map, and no unit in the name"));
  EXPECT_THAT(error({.points = "id,max_distance_ft\n"}), HasSubstr("column max_distance_ft: expected metres"));
  EXPECT_THAT(error({.keyframes = "id,timestamp_ns\n"}), HasSubstr("column timestamp_ns: expected seconds"));
  EXPECT_EQ(error({.points = "id,x [m],y [m],z [m]\n", .keyframes = "id,timestamp [s]\n"}), "no error");
}

TEST(Edit, NeedsATable) {
  Atlas atlas = Small();
  EXPECT_EQ(KindOf([&] { EditByTables(atlas, {}); }), ErrorKind::kUsage);
  EXPECT_EQ(KindOf([&] { EditByTables(atlas, {.points = Source("no/such/file.csv")}); }), ErrorKind::kNotFound);
}

TEST(Edit, TablesThatAreSomethingElseAreRefusedAsThat) {
  Atlas atlas = Small();
  EXPECT_THAT(ErrorOf([&] { Edit(atlas, {.points = EncodeAtlas(atlas, {.format = "orbslam3"})}); }),
              HasSubstr("points.csv: "));
}

}  // namespace
}  // namespace slamdb
