// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/frame/georeference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "slamdb/base/detail/csv_cells.h"
#include "slamdb/base/error.h"

namespace slamdb {
namespace {

// WGS84 (NIMA TR8350.2): semi-major axis in metres, flattening.
constexpr double kSemiMajor = 6378137.0, kFlattening = 1 / 298.257223563;
constexpr double kEccentricity2 = kFlattening * (2 - kFlattening);
constexpr double kDegree = std::numbers::pi / 180;

// From the axis of the earth to the ellipsoid along the normal.
double NormalRadius(double sine) { return kSemiMajor / std::sqrt(1 - kEccentricity2 * sine * sine); }

bool IsPlace(const Geodetic& place) {
  return std::abs(place.latitude) <= 90 && std::abs(place.longitude) <= 360 && std::isfinite(place.altitude);
}

std::string_view Trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \r\"";
  const std::size_t begin = text.find_first_not_of(kBlank);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlank) - begin + 1);
}

std::vector<std::string_view> Cells(std::string_view line) {
  std::vector<std::string_view> cells;
  while (true) {
    const std::size_t end = line.find_first_of(",;\t");
    cells.push_back(Trimmed(line.substr(0, end)));
    if (end == std::string_view::npos) return cells;
    line.remove_prefix(end + 1);
  }
}

// Where time, latitude, longitude and altitude stand in a line.
using Columns = std::array<std::size_t, 4>;

// `Latitude [deg]` -> `latitude`
std::string ColumnName(std::string_view cell) {
  std::string name;
  for (const char letter : cell.substr(0, cell.find_first_of(" ([_"))) name += static_cast<char>(std::tolower(letter));
  return name;
}

std::optional<Columns> ColumnsByName(std::string_view line) {
  static const std::array<std::vector<std::string_view>, 4> kNames = {
      {{"time", "timestamp", "t", "seconds"},
       {"lat", "latitude"},
       {"lon", "lng", "long", "longitude"},
       {"alt", "altitude", "ele", "elevation", "height"}}};
  const std::vector<std::string_view> cells = Cells(line);
  Columns columns{};
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const auto named = std::ranges::find_if(cells, [&](std::string_view cell) {
      return std::ranges::find(kNames[i], ColumnName(cell)) != kNames[i].end();
    });
    if (named == cells.end()) return std::nullopt;
    columns[i] = static_cast<std::size_t>(named - cells.begin());
  }
  return columns;
}

std::optional<GpsFix> ParseFix(std::string_view line, const Columns& columns) {
  const std::vector<std::string_view> cells = Cells(line);
  std::array<double, 4> values{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto number = columns[i] < cells.size() ? ParseCell<double>(cells[columns[i]]) : std::nullopt;
    if (!number || !std::isfinite(*number)) return std::nullopt;
    values[i] = *number;
  }
  const GpsFix fix{values[0], {values[1], values[2], values[3]}};
  return IsPlace(fix.place) ? std::optional(fix) : std::nullopt;
}

}  // namespace

Eigen::Vector3d EcefFromGeodetic(const Geodetic& place) {
  const double sine = std::sin(place.latitude * kDegree), cosine = std::cos(place.latitude * kDegree);
  const double radius = NormalRadius(sine);
  return {(radius + place.altitude) * cosine * std::cos(place.longitude * kDegree),
          (radius + place.altitude) * cosine * std::sin(place.longitude * kDegree),
          (radius * (1 - kEccentricity2) + place.altitude) * sine};
}

Geodetic GeodeticFromEcef(const Eigen::Vector3d& ecef) {
  const double off_axis = std::hypot(ecef.x(), ecef.y());
  // Bowring's start, then a fixed point that gains three digits a step.
  double latitude = std::atan2(ecef.z(), off_axis * (1 - kEccentricity2));
  for (int step = 0; step < 8; ++step) {
    const double sine = std::sin(latitude);
    latitude = std::atan2(ecef.z() + kEccentricity2 * NormalRadius(sine) * sine, off_axis);
  }
  const double sine = std::sin(latitude), cosine = std::cos(latitude);
  // The distance along the normal, stable at the poles as well as at the equator.
  const double altitude =
      off_axis * cosine + ecef.z() * sine - kSemiMajor * std::sqrt(1 - kEccentricity2 * sine * sine);
  return {latitude / kDegree, std::atan2(ecef.y(), ecef.x()) / kDegree, altitude};
}

LocalFrame::LocalFrame(const Geodetic& origin) : origin_(origin), ecef_(EcefFromGeodetic(origin)) {
  if (!IsPlace(origin)) throw Error("the origin is no place on earth: latitudes reach from -90 to 90 degrees");
  const double latitude = origin.latitude * kDegree, longitude = origin.longitude * kDegree;
  const double sp = std::sin(latitude), cp = std::cos(latitude), sl = std::sin(longitude), cl = std::cos(longitude);
  enu_from_ecef_ << -sl, cl, 0,  //
      -sp * cl, -sp * sl, cp,    //
      cp * cl, cp * sl, sp;
}

Eigen::Vector3d LocalFrame::FromGeodetic(const Geodetic& place) const {
  return enu_from_ecef_ * (EcefFromGeodetic(place) - ecef_);
}

Geodetic LocalFrame::ToGeodetic(const Eigen::Vector3d& enu) const {
  return GeodeticFromEcef(ecef_ + enu_from_ecef_.transpose() * enu);
}

std::vector<GpsFix> ParseFixes(std::string_view csv) {
  std::vector<GpsFix> fixes;
  Columns columns{0, 1, 2, 3};
  bool first = true;
  for (std::size_t number = 1; !csv.empty(); ++number) {
    const std::string_view line = Trimmed(TakeLine(csv));
    const bool comment = line.starts_with('#');
    if (line.empty()) continue;
    if (first) {
      const auto named = ColumnsByName(Trimmed(line.substr(comment ? 1 : 0)));
      if (named) columns = *named;
      first = comment && !named;
      if (named) continue;
    }
    if (comment) continue;
    const auto fix = ParseFix(line, columns);
    if (!fix)
      throw LineError(number,
                      "expected time, latitude, longitude and altitude in seconds, degrees and metres, found `" +
                          std::string(line.substr(0, 80)) + "`");
    fixes.push_back(*fix);
  }
  return fixes;
}

Geodetic ParseGeodetic(std::string_view text) {
  const std::vector<std::string_view> cells = Cells(text);
  std::array<double, 3> values{};
  bool good = cells.size() == 2 || cells.size() == 3;
  for (std::size_t i = 0; good && i < cells.size(); ++i) {
    const auto number = ParseCell<double>(cells[i]);
    good = number.has_value();
    if (good) values[i] = *number;
  }
  const Geodetic place{values[0], values[1], values[2]};
  if (!good || !IsPlace(place))
    throw Error("a place is LATITUDE,LONGITUDE[,ALTITUDE] in degrees and metres, not '" + std::string(text) + "'");
  return place;
}

std::vector<TimedPosition> PositionsIn(const LocalFrame& frame, const std::vector<GpsFix>& fixes) {
  std::vector<TimedPosition> positions;
  positions.reserve(fixes.size());
  for (const GpsFix& fix : fixes) positions.push_back({fix.timestamp, frame.FromGeodetic(fix.place)});
  return positions;
}

}  // namespace slamdb
