// SPDX-License-Identifier: BSD-3-Clause
// Reads tables of poses, whoever wrote them: columns by their names, or else by their places.
#include "slamdb/formats/trajectory/detail/pose_table.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/files_read.h"
#include "slamdb/base/detail/lengths.h"
#include "slamdb/base/detail/links.h"
#include "slamdb/base/detail/parse_file.h"
#include "slamdb/base/detail/pose_columns.h"
#include "slamdb/base/detail/times.h"
#include "slamdb/base/detail/unfinished.h"
#include "slamdb/formats/trajectory/detail/quaternion_order.h"
#include "slamdb/formats/trajectory/options.h"
#include "slamdb/model/detail/is_pose.h"

namespace slamdb::detail {
namespace {

constexpr std::string_view kMapComment = "# map ";

std::optional<MapId> MapOfComment(std::string_view line) {
  if (!line.starts_with(kMapComment)) return std::nullopt;
  const auto id = ParseNumber<std::uint64_t>(Trimmed(line.substr(kMapComment.size())));
  return id ? std::optional(MapId(*id)) : std::nullopt;
}

TableKind MakePoseTable(PoseLayout layout) {
  TableKind kind;
  kind.columns = {TimeColumn()};
  for (std::size_t i = 0; i < 3; ++i) kind.columns.push_back(PositionColumn(i));
  for (std::size_t i = 0; i < 4; ++i) kind.columns.push_back(QuaternionColumn(i));
  kind.columns.push_back({{"is_lost", "lost"}, Column::kOptional});
  kind.expected = "8 numbers: timestamp tx ty tz qx qy qz qw";
  if (layout == PoseLayout::kEuroc) {
    std::rotate(kind.columns.begin() + 4, kind.columns.begin() + 7, kind.columns.begin() + 8);
    kind.expected = "at least 8 cells: timestamp [ns], position x y z, quaternion w x y z";
    kind.more_cells = true;
  }
  return kind;
}

struct LeftOut {
  std::size_t lost = 0, without_pose = 0;
  std::size_t first_lost = 0, first_without = 0;  // lines

  static void Count(std::size_t& count, std::size_t& first, std::size_t line) {
    if (count++ == 0) first = line;
  }
  void Tell(Notices& notices) const {
    if (lost > 0)
      notices.Warn(Concat("left out because tracking was lost there: ", Counted(lost, "row"), ", the first in line ",
                          first_lost));
    if (without_pose > 0)
      notices.Warn(Concat("left out because their pose is not a number, or their quaternion zero: ",
                          Counted(without_pose, "row"), ", the first in line ", first_without));
  }
};

// The text of a unit quaternion as it stands, or normalised where it is not quite one.
std::array<std::string, 4> RotationText(const Eigen::Quaterniond& unit, double norm,
                                        const std::array<std::string, 4>& as_read) {
  constexpr double kAsGood = 1e-3;
  if (std::abs(norm - 1) <= kAsGood) return as_read;
  std::array<std::string, 4> text;
  for (int i = 0; i < 4; ++i) AppendNumber(text[static_cast<std::size_t>(i)], unit.coeffs()[i]);
  return text;
}

// Reads poses row by row.
class PoseReader {
 public:
  PoseReader(const Table& table, const PoseColumns& columns) : table_(table), columns_(columns) {
    for (std::size_t i = 0; i < 3; ++i) metres_[i] = MetresIn(table, columns.position + i);
  }

  bool IsLost() const {
    const std::string_view lost = table_.Raw(columns_.is_lost);
    return lost == "1" || lost == "true" || lost == "True" || lost == "TRUE";
  }

  // Nothing when the row has no pose.
  std::optional<PoseText> Pose() const {
    PoseText pose;
    for (std::size_t i = 0; i < 3; ++i)
      pose.translation[static_cast<int>(i)] = table_.Get<double>(columns_.position + i) * metres_[i];
    const std::array places = {columns_.qx, columns_.qy, columns_.qz, columns_.qw};
    std::array<std::string, 4> as_read;
    for (std::size_t i = 0; i < 4; ++i) {
      pose.quaternion.coeffs()[static_cast<int>(i)] = table_.Get<double>(places[i]);
      as_read[i] = table_.Digits(places[i]);
    }
    const double norm = pose.quaternion.norm();
    if (!pose.translation.allFinite() || !std::isfinite(norm) || norm == 0) return std::nullopt;
    RequireUnit(pose.quaternion, norm);
    pose.quaternion.coeffs() /= norm;
    for (std::size_t i = 0; i < 3; ++i) pose.position[i] = MetresText(table_, columns_.position + i, metres_[i]);
    pose.rotation = RotationText(pose.quaternion, norm, as_read);
    return pose;
  }

 private:
  void RequireUnit(const Eigen::Quaterniond& q, double norm) const {
    if (detail::IsNearUnit(q)) return;
    throw table_.LineError(Concat("expected a quaternion of length 1 in columns qx qy qz qw, found ", q.x(), ' ', q.y(),
                                  ' ', q.z(), ' ', q.w(), " of length ", norm, "; are these poses?"));
  }

  const Table& table_;
  const PoseColumns columns_;
  std::array<double, 3> metres_{};
};

TimeRules RulesFor(const Table& table, const PoseColumns& columns, PoseLayout layout, const ReadOptions& options) {
  TimeRules rules{.asked = options.of<TrajectoryReadOptions>().time_unit, .time = columns.time};
  const ColumnName* x = table.NameOf(columns.position);
  const bool euroc = layout == PoseLayout::kEuroc && (x == nullptr || x->name == "p_rs_r_x");
  if (euroc) rules.usual = TimeUnit::kNanoseconds;
  rules.firm = euroc || (x != nullptr && x->text == "tx");
  return rules;
}

// `layout` is that of the file's format; in `order` stand the columns that have no names.
TrajectoryText ParsePoses(std::string_view text, PoseLayout layout, PoseLayout order, const ReadOptions& options,
                          Notices& notices) {
  const PoseColumns columns = ColumnsOf(order);
  Table table(text, PoseTable(order));
  const PoseReader reader(table, columns);
  TimeReader times(table, RulesFor(table, columns, layout, options));
  TrajectoryText maps;
  LeftOut left_out;
  for (bool more = true; more;) {
    more = table.Next();
    for (const std::string_view comment : table.comments())
      if (const auto map = MapOfComment(comment)) maps.push_back({*map, {}});
    if (!more) break;
    if (reader.IsLost()) {
      LeftOut::Count(left_out.lost, left_out.first_lost, table.line());
      continue;
    }
    auto pose = reader.Pose();
    if (!pose) {
      LeftOut::Count(left_out.without_pose, left_out.first_without, table.line());
      continue;
    }
    times.Add();
    if (maps.empty()) maps.push_back({MapId(0), {}});
    maps.back().poses.push_back(*std::move(pose));
  }
  left_out.Tell(notices);
  if (table.has_decimal_commas()) notices.Note("commas in numbers are taken as decimal commas");
  auto seconds = times.Seconds(notices);
  auto next = seconds.begin();
  for (MapText& map : maps)
    for (PoseText& pose : map.poses) {
      pose.seconds = std::move(*next++);
      pose.timestamp = ParseNumber<double>(pose.seconds).value_or(0);
    }
  if (seconds.empty() && left_out.lost + left_out.without_pose > 0)
    throw Error(ErrorKind::kDamaged, "holds no pose: tracking is lost, or not a number, in every row");
  return maps;
}

// ---- KITTI

const TableKind& MatrixTable() {
  static const TableKind kind = {.columns = {{{"r11"}},
                                             {{"r12"}},
                                             {{"r13"}},
                                             {{"tx"}},
                                             {{"r21"}},
                                             {{"r22"}},
                                             {{"r23"}},
                                             {{"ty"}},
                                             {{"r31"}},
                                             {{"r32"}},
                                             {{"r33"}},
                                             {{"tz"}}},
                                 .expected = "12 numbers, the first three rows of a matrix [R t]"};
  return kind;
}

PoseText PoseOfMatrix(const Table& table) {
  Eigen::Matrix<double, 3, 4, Eigen::RowMajor> matrix;
  for (std::size_t i = 0; i < 12; ++i) matrix.data()[i] = table.Get<double>(i, "a finite number");
  const Eigen::Matrix3d rotation = matrix.leftCols<3>();
  constexpr double kTolerance = 0.02;  // of matrices that were written with few digits
  if (!matrix.allFinite() || !(rotation * rotation.transpose()).isIdentity(kTolerance) || rotation.determinant() < 0)
    throw table.LineError(Concat("expected a rotation in the left three columns of the matrix, found ",
                                 Excerpt(table.row()), "; are these poses?"));
  PoseText pose;
  pose.translation = matrix.col(3);
  pose.quaternion = Eigen::Quaterniond(rotation).normalized();
  for (std::size_t i = 0; i < 3; ++i) pose.position[i] = *ShiftedDecimal(table.Digits(4 * i + 3), 0);
  for (std::size_t i = 0; i < 4; ++i) AppendNumber(pose.rotation[i], pose.quaternion.coeffs()[static_cast<int>(i)]);
  return pose;
}

std::string TimesBeside(const std::string& path) {
  const std::filesystem::path file(path);
  std::error_code missing;
  for (const std::filesystem::path& times :
       {std::filesystem::path(LeadsTo(path) + ".times"), std::filesystem::path(path + ".times"),
        file.parent_path() / (file.stem().string() + "_times.txt"), file.parent_path() / "times.txt"})
    if (times != file && std::filesystem::exists(times, missing)) return times.string();
  return {};
}

std::vector<std::string> ReadTimes(const std::string& path, const ReadOptions& options, Notices& notices) {
  return ParseLines(path, "a table of times", notices, [&](std::string_view text) {
    constexpr std::size_t kDate = 1, kTimeOfDay = 2;
    Table table(text, {.columns = {TimeColumn(), {{"date"}, 1}, TimeColumn(1)},
                       .expected = "one time a line, or date and time of day"});
    TimeRules rules{.asked = options.of<TrajectoryReadOptions>().time_unit};
    if (table.Has(kDate)) rules.time = kTimeOfDay, rules.date = kDate;
    TimeReader times(table, rules);
    while (table.Next()) times.Add();
    return times.Seconds(notices);
  });
}

// Those that were named, or lie beside the poses; empty: there are none.
std::string TimesOf(const Source& source, const ReadOptions& options) {
  const std::string& given = options.of<TrajectoryReadOptions>().times;
  return given.empty() && source.is_file() ? TimesBeside(source.path) : given;
}

void SetTimes(std::vector<PoseText>& poses, const Source& source, const std::string& path, const ReadOptions& options,
              Notices& notices) {
  std::vector<std::string> seconds;
  if (path.empty()) {
    notices.Warn("has no times, and none were found beside it: frame numbers stand for seconds");
    for (std::size_t i = 0; i < poses.size(); ++i) seconds.push_back(std::to_string(i));
  } else {
    seconds = ReadTimes(path, options, notices);
    if (source.is_file()) RefuseUnfinished(UnfinishedBeside(LeadsTo(source.path) + ".times"), source.path);
    notices.Note("the times are those of " + path);
  }
  if (seconds.size() != poses.size())
    throw Error(ErrorKind::kDamaged, path, "",
                Concat("holds ", Counted(seconds.size(), "time"), " for the ", Counted(poses.size(), "pose"), " of ",
                       source.path));
  for (std::size_t i = 0; i < poses.size(); ++i) {
    poses[i].timestamp = ParseNumber<double>(seconds[i]).value_or(0);
    poses[i].seconds = std::move(seconds[i]);
  }
}

TrajectoryText ReadMatrices(const Source& source, const ReadOptions& options, Notices& notices) {
  TrajectoryText maps(1, {MapId(0), {}});
  const std::string times = TimesOf(source, options);
  FilesRead files;
  if (source.is_file()) files.Note(source.path);
  if (!times.empty()) files.Note(times);
  ParseLines(source, "a trajectory", notices, [&](std::string_view text) {
    Table table(text, MatrixTable());
    while (table.Next()) maps[0].poses.push_back(PoseOfMatrix(table));
    return 0;
  });
  SetTimes(maps[0].poses, source, times, options, notices);
  files.RequireSame();
  return maps;
}

TrajectoryText ReadRows(const Source& source, PoseLayout layout, const ReadOptions& options, Notices& notices) {
  if (!options.of<TrajectoryReadOptions>().times.empty())
    throw Error(ErrorKind::kUsage, source.path, "", "has times of its own; a file of times belongs to KITTI's poses");
  return ParseLines(source, "a trajectory", notices, [&](std::string_view text) {
    const bool told = !options.format.empty() || options.custom_format != nullptr;
    const PoseLayout order = told ? layout : LayoutOfRows(text, layout, source.path, notices);
    return ParsePoses(text, layout, order, options, notices);
  });
}

}  // namespace

PoseColumns ColumnsOf(PoseLayout layout) {
  return layout == PoseLayout::kEuroc ? PoseColumns{.qx = 5, .qy = 6, .qz = 7, .qw = 4} : PoseColumns{};
}

const TableKind& PoseTable(PoseLayout layout) {
  static const TableKind tum = MakePoseTable(PoseLayout::kTum), euroc = MakePoseTable(PoseLayout::kEuroc);
  return layout == PoseLayout::kEuroc ? euroc : tum;
}

TrajectoryText ReadTrajectoryText(const Source& source, PoseLayout layout, const ReadOptions& options,
                                  Notices& notices) {
  TrajectoryText maps = layout == PoseLayout::kKitti ? ReadMatrices(source, options, notices)
                                                     : ReadRows(source, layout, options, notices);
  if (std::ranges::all_of(maps, [](const MapText& map) { return map.poses.empty(); }))
    throw Error(ErrorKind::kDamaged, source.path, "", "holds no pose; was it cut off after its first lines?");
  return maps;
}

}  // namespace slamdb::detail
