// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/las/detail/las.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/formats/export/detail/maps.h"
#include "slamdb/formats/export/detail/point_colors.h"
#include "slamdb/formats/export/detail/raw.h"
#include "slamdb/formats/export/detail/rows.h"
#include "slamdb/formats/geographic/detail/places.h"
#include "slamdb/formats/las/detail/utm.h"

namespace slamdb::detail {
namespace {

constexpr std::size_t kRowsPerBlock = 8192;
constexpr std::uint16_t kHeaderBytes = 227, kRecordBytes = 26;
constexpr double kStep = 0.0001;         // metres, of the whole numbers that coordinates are
constexpr double kFarthest = 200'000;    // metres from the origin, for which 32 bits suffice
constexpr std::uint8_t kOnlyReturn = 9;  // the first of one

using Whole3 = Eigen::Matrix<std::int32_t, 3, 1>;
struct LasPoint {
  std::size_t row;  // of the points
  Whole3 place;
};

void AppendText(std::string& out, std::string_view text, std::size_t width) {
  out += text;
  out.append(width - text.size(), '\0');
}

// Points as whole steps from an offset, in the order of their rows.
class Grid {
 public:
  Grid(const PointRows& points, const Geodetic& origin, const Target& target, int threads) : frame_(origin) {
    const auto zone = UtmZoneOf(origin);
    if (!zone)
      throw Error(ErrorKind::kNotPossible, target.path, "",
                  "UTM has no zone above 84 degrees north and below 80 south, where the origin is");
    zone_ = *zone;
    const Eigen::Vector3d at = UtmFromGeodetic(zone_, origin);
    for (int axis = 0; axis < 3; ++axis) offset_[axis] = std::round(at[axis]);
    Place(points, threads);
  }

  const UtmZone& zone() const { return zone_; }
  const Eigen::Vector3d& offset() const { return offset_; }
  const std::vector<LasPoint>& points() const { return points_; }
  std::size_t too_far() const { return too_far_; }
  double Coordinate(std::int32_t steps, int axis) const { return steps * kStep + offset_[axis]; }

 private:
  void Place(const PointRows& points, int threads) {
    std::vector<LasPoint> all(points.size());
    std::vector<std::uint8_t> near(points.size());
    ParallelFor(points.size(), kRowsPerBlock, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = begin; row < end; ++row) {
        const Eigen::Vector3d position = points[row].point->position.cast<double>();
        near[row] = position.norm() <= kFarthest;
        if (near[row] != 0) all[row] = {row, StepsOf(position)};
      }
    });
    for (std::size_t row = 0; row < all.size(); ++row)
      if (near[row] != 0) points_.push_back(all[row]);
    too_far_ = all.size() - points_.size();
  }
  Whole3 StepsOf(const Eigen::Vector3d& position) const {
    const Eigen::Vector3d steps = (UtmFromGeodetic(zone_, frame_.ToGeodetic(position)) - offset_) / kStep;
    return {static_cast<std::int32_t>(std::llround(steps.x())), static_cast<std::int32_t>(std::llround(steps.y())),
            static_cast<std::int32_t>(std::llround(steps.z()))};
  }

  LocalFrame frame_;
  UtmZone zone_;
  Eigen::Vector3d offset_;
  std::vector<LasPoint> points_;
  std::size_t too_far_ = 0;
};

// The coordinate system: keys of GeoTIFF, ascending, each a number of its own.
std::string GeoKeys(const UtmZone& zone) {
  constexpr std::uint16_t kProjected = 1, kMetres = 9001;
  const std::array<std::array<std::uint16_t, 2>, 4> keys{{{1024, kProjected},   // GTModelType
                                                          {3072, zone.epsg()},  // ProjectedCSType
                                                          {3076, kMetres},      // ProjLinearUnits
                                                          {4099, kMetres}}};    // VerticalUnits
  std::string out;
  constexpr std::array<std::uint16_t, 4> kDirectory{1, 1, 0, 4};  // version 1.1.0, four keys
  for (const std::uint16_t value : kDirectory) AppendRaw(out, value);
  for (const auto& [key, value] : keys)
    for (const std::uint16_t number : {key, std::uint16_t{0}, std::uint16_t{1}, value}) AppendRaw(out, number);
  return out;
}

std::string VariableRecord(const std::string& data) {
  std::string out;
  AppendRaw(out, std::uint16_t{0});
  AppendText(out, "LASF_Projection", 16);
  AppendRaw(out, std::uint16_t{34735});
  AppendRaw(out, static_cast<std::uint16_t>(data.size()));
  AppendText(out, "WGS 84 / UTM", 32);
  return out + data;
}

void AppendBounds(std::string& out, const Grid& grid) {
  for (int axis = 0; axis < 3; ++axis) {
    std::int32_t low = std::numeric_limits<std::int32_t>::max(), high = std::numeric_limits<std::int32_t>::min();
    for (const LasPoint& point : grid.points()) {
      low = std::min(low, point.place[axis]);
      high = std::max(high, point.place[axis]);
    }
    const bool empty = grid.points().empty();
    AppendRaw(out, empty ? 0.0 : grid.Coordinate(high, axis));
    AppendRaw(out, empty ? 0.0 : grid.Coordinate(low, axis));
  }
}

std::string Header(const Grid& grid) {
  const std::string record = VariableRecord(GeoKeys(grid.zone()));
  const auto count = static_cast<std::uint32_t>(grid.points().size());
  std::string out = "LASF";
  AppendRaw(out, std::uint32_t{0});  // file source, encoding
  out.append(16, '\0');              // project
  out += {1, 2};                     // version
  AppendText(out, "OTHER", 32);
  AppendText(out, "slamdb", 32);
  AppendRaw(out, std::uint32_t{0});  // date: equal atlases are equal files
  AppendRaw(out, kHeaderBytes);
  AppendRaw(out, static_cast<std::uint32_t>(kHeaderBytes + record.size()));
  AppendRaw(out, std::uint32_t{1});
  out += '\2';  // points with colours
  AppendRaw(out, kRecordBytes);
  AppendRaw(out, count);
  for (const std::uint32_t of_return : {count, 0U, 0U, 0U, 0U}) AppendRaw(out, of_return);
  for (int axis = 0; axis < 3; ++axis) AppendRaw(out, kStep);
  for (const double value : grid.offset()) AppendRaw(out, value);
  AppendBounds(out, grid);
  return out + record;
}

constexpr std::size_t kMostObservations = 255;  // in the user's byte

// Of 16 bits; 0, which is none, for maps of ids above.
std::uint16_t SourceOf(MapId map) {
  const std::uint64_t id = map.value();
  return id <= std::numeric_limits<std::uint16_t>::max() ? static_cast<std::uint16_t>(id) : std::uint16_t{0};
}

void AppendPoint(std::string& out, const PointRows& points, const PointColors& colors, const LasPoint& las) {
  const PointRows::Row& row = points[las.row];
  for (const std::int32_t value : las.place) AppendRaw(out, value);
  AppendRaw(out, std::uint16_t{0});  // intensity
  AppendRaw(out, kOnlyReturn);
  AppendRaw(out, std::uint8_t{0});  // never classified
  AppendRaw(out, std::uint8_t{0});  // scan angle
  AppendRaw(out, static_cast<std::uint8_t>(std::min(row.point->observations.size(), kMostObservations)));
  AppendRaw(out, SourceOf(points.map_id(row)));
  for (const std::uint8_t part : colors[las.row]) AppendRaw(out, static_cast<std::uint16_t>(257 * part));
}

void WarnOfNarrowFields(const PointRows& points, const Grid& grid, Notices& notices) {
  std::size_t unnamed = 0, seen_more = 0;
  for (const LasPoint& las : grid.points()) {
    const PointRows::Row& row = points[las.row];
    const MapId map = points.map_id(row);
    unnamed += SourceOf(map) != map.value() ? 1 : 0;
    seen_more += row.point->observations.size() > kMostObservations ? 1 : 0;
  }
  if (unnamed > 0)
    notices.Warn("the point source is 0 for maps of ids beyond 65,535, for which it has no place: " +
                 Counted(unnamed, "point"));
  if (seen_more > 0)
    notices.Warn(Concat("numbers of observations above ", kMostObservations,
                        " are written as that: ", Counted(seen_more, "point")));
}

void WriteLas(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  AtomicFile file(target, FileOptions(options));
  const Geodetic& origin = OriginOf(target, options);
  const PointRows points(atlas, target, options, Positions::kFinite);
  if (points.size() > std::numeric_limits<std::uint32_t>::max())
    throw Error(ErrorKind::kNotPossible, target.path, "", "LAS 1.2 holds up to 4,294,967,295 points");
  const PointColors colors(points, options);
  WarnOfSeveralFrames(points.maps(), "the point source and the colour tell them apart", notices);
  const Grid grid(points, origin, target, options.threads);
  file.Write(Header(grid));
  WriteRows(file, grid.points().size(), kRowsPerBlock, options,
            [&](std::size_t begin, std::size_t end, std::string& out) {
              for (std::size_t i = begin; i < end; ++i) AppendPoint(out, points, colors, grid.points()[i]);
            });
  file.Commit();
  points.WarnOfNotFinite(notices);
  WarnOfNarrowFields(points, grid, notices);
  if (grid.too_far() > 0)
    notices.Warn("left out, since they are more than 200 km from the origin: " + Counted(grid.too_far(), "point"));
  colors.Tell(notices);
  notices.Tell(
      grid.too_far() == 0 ? points.Summary() : Counted(grid.points().size(), "point") + " of " + points.Summary(),
      WrittenCounts{.points = grid.points().size()});
}

bool SniffLas(const Probe& probe) { return probe.head.starts_with("LASF"); }

constexpr std::array<std::string_view, 1> kSuffixes = {".las"};

}  // namespace

const Format kLasFormat = {.id = "las",
                           .title = "LAS point cloud",
                           .suffixes = kSuffixes,
                           .kind = FileKind::kBinary,
                           .chooses_maps = true,
                           .has_colors = true,
                           .is_on_globe = true,
                           .is_export = true,
                           .writes = Content::kPoints,
                           .sniff = SniffLas,
                           .write = WriteLas};

}  // namespace slamdb::detail
