// SPDX-License-Identifier: BSD-3-Clause
// Tables of GPS fixes, whoever wrote them.
#include "slamdb/edit/frame/detail/fixes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/lengths.h"
#include "slamdb/base/detail/parse_file.h"
#include "slamdb/base/detail/times.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/frame/detail/hemispheres.h"

namespace slamdb {
namespace {

using detail::Column;
using detail::Concat;
using detail::Coordinate;
using detail::LeftOutFixes;
using detail::Table;

// What the columns of fixes are, in the order that they have without names.
enum FixColumn : std::size_t {
  kTime,
  kLatitude,
  kLongitude,
  kAltitude,
  kDate,
  kNorthSouth,
  kEastWest,
  kStatus,
  kQuality,
  kFixType,
  kMode,
  kFix,
  kSatellites
};

const detail::TableKind& FixTable() {
  static const detail::TableKind kind = {
      .columns = {detail::TimeColumn(),
                  {{".latitude", ".lat"}},
                  {{".longitude", ".lon", "lng", "long"}},
                  {{"altitude_ellipsoid",
                    "altitude_ellipsoidal",
                    "alt_ellipsoid",
                    "alt_ellipsoidal",
                    "ellipsoidal_height",
                    "ellipsoid_height",
                    "ellipsoidal_altitude",
                    "height_ellipsoid",
                    "height_ellipsoidal",
                    "height_above_ellipsoid",
                    "altitude_above_ellipsoid",
                    "altitude_hae",
                    "alt_hae",
                    "height_hae",
                    "hae",
                    "altitude_wgs84",
                    "alt_wgs84",
                    ".altitude",
                    ".alt",
                    "ele",
                    "elevation",
                    "height",
                    "altitude_msl",
                    "altitude_amsl",
                    "alt_msl",
                    "alt_amsl",
                    "height_msl",
                    "msl",
                    "hmsl"},
                   0,
                   "altitude"},
                  {{"date", "day"}, Column::kOptional},
                  {{"n/s", "n.s", "ns", "lat_dir", "latitude_direction", "lat_hemisphere", "north_south"},
                   Column::kOptional},
                  {{"e/w", "e.w", "ew", "lon_dir", "longitude_direction", "lon_hemisphere", "east_west"},
                   Column::kOptional},
                  {{".status.status", "status"}, Column::kOptional},
                  {{"quality", "fix_quality", "gps_quality", "gps_qual", "q"}, Column::kOptional},
                  {{".fix_type", "gps_fix_type", "fixtype", "gnss_fix_type"}, Column::kOptional},
                  {{".mode", "fix_mode", "gps_mode"}, Column::kOptional},
                  {{"fix", "gps_fix", "gnss_fix", "has_fix", "valid", "is_valid", "fix_valid", "gps_valid", "fix_ok",
                    "gnss_fix_ok"},
                   Column::kOptional},
                  {{"num_sats", "num_sat", "num_sv", "numsv", "nsat", "nsats", "n_sats", "num_satellites", "satellites",
                    "satellites_used", "satellites_visible", "sats", "sats_used"},
                   Column::kOptional}},
      .expected = "time, latitude, longitude and altitude in seconds, degrees and metres",
      .more_cells = true,
      .name_beginnings = true};
  return kind;
}

constexpr Coordinate kLatitudes = {kLatitude, kNorthSouth, "NS", "latitude"};
constexpr Coordinate kLongitudes = {kLongitude, kEastWest, "EW", "longitude"};

constexpr double kDegree = std::numbers::pi / 180;

// How many degrees the angles of a column count. 0: it says nothing.
double DegreesIn(const Table& table, std::size_t column) {
  const detail::ColumnName* name = table.NameOf(column);
  if (name == nullptr || name->unit.empty()) return 0;
  const std::string_view unit = name->unit;
  if (unit == "deg" || unit == "degs" || unit == "degree" || unit == "degrees" || unit == "\xc2\xb0") return 1;
  if (unit == "rad" || unit == "rads" || unit == "radian" || unit == "radians") return 1 / kDegree;
  if (unit == "e6" || unit == "dege6") return 1e-6;
  if (unit == "e7" || unit == "dege7" || unit == "1e-7 deg" || unit == "1e7 deg") return 1e-7;
  throw Error(ErrorKind::kUnsupported, "", "column " + name->text,
              Concat("expected angles in deg, rad, e6 or e7 (1e-7 degrees), found the unit '", name->unit, "'"));
}

// The least status that is a fix. NavSatFix counts from -1, which is none, to 2; ArduPilot to 6, and 0 and 1 are none.
double LeastStatus(const Table& table, const std::vector<detail::ColumnContents>& contents) {
  if (!table.Has(kStatus)) return 0;
  const auto is_week = [](const detail::ColumnName& name) { return name.text == "gwk"; };
  const double greatest = contents[detail::PlaceOf(table, kStatus)].greatest;
  return greatest >= 3 || std::ranges::any_of(table.names(), is_week) ? 2 : 0;
}

// A number that a column about the receiver has at most where there is no fix.
struct NoFixNumber {
  FixColumn column;
  double most;
};
constexpr NoFixNumber kNoFixNumbers[] = {{kStatus, -1},  // of NavSatFix
                                         {kQuality, 0},  // of GGA
                                         {kFixType, 1},  // of u-blox and PX4: 1 is dead reckoning, or none
                                         {kMode, 1},     // of gpsd: 0 is unknown, 1 none
                                         {kFix, 0},     {kSatellites, 0}};

bool SaysNoFix(std::string_view cell) {
  static constexpr std::string_view kWords[] = {"v",      "void",   "false", "f",      "n",       "no",       "none",
                                                "no fix", "no_fix", "nofix", "no-fix", "invalid", "not valid"};
  return std::ranges::any_of(kWords, [cell](std::string_view word) {
    return std::ranges::equal(cell, word, {}, [](char letter) {
      return letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter - 'A' + 'a') : letter;
    });
  });
}

// Reads the rows of a table, of which all together tell what angles count.
class FixReader {
 public:
  FixReader(const Table& table, const std::vector<detail::ColumnContents>& contents, Notices& notices)
      : table_(table),
        north_south_(detail::FindHemisphere(table, FixTable(), contents, kLatitudes, notices)),
        east_west_(detail::FindHemisphere(table, FixTable(), contents, kLongitudes, notices)),
        least_status_(LeastStatus(table, contents)),
        latitude_unit_(DegreesIn(table, kLatitude)),
        longitude_unit_(DegreesIn(table, kLongitude)),
        altitude_unit_(detail::MetresIn(table, kAltitude)),
        in_e7_(latitude_unit_ == 1e-7) {}

  // False when the row has neither a fix nor a time that the receiver had none at.
  bool Add(LeftOutFixes& left_out) {
    std::string reason = NoFix();
    Geodetic place = GpsFix::kNowhere;
    if (reason.empty()) {
      place = {Angle(kLatitudes, north_south_, latitude_unit_), Angle(kLongitudes, east_west_, longitude_unit_),
               table_.Get<double>(kAltitude) * altitude_unit_};
      if (!std::isfinite(place.latitude) || !std::isfinite(place.longitude) || !std::isfinite(place.altitude))
        reason = "not a number";
      else if (place.latitude == 0 && place.longitude == 0)
        reason = "latitude 0 and longitude 0";
    }
    if (!reason.empty()) {
      left_out.Add(reason, table_.line());
      if (table_.Raw(kTime).empty() || table_.Raw(kTime).front() > '9') return false;
      place = GpsFix::kNowhere;
    }
    fixes_.push_back({0, place});
    lines_.push_back(table_.line());
    return true;
  }

  // Brings angles to degrees, and takes away what is no place. Returns how many fixes there are.
  std::size_t Finish(const std::vector<std::string>& seconds, LeftOutFixes& left_out, Notices& notices) {
    SettleAngles(notices);
    std::size_t places = 0;
    for (std::size_t i = 0; i < fixes_.size(); ++i) {
      GpsFix& fix = fixes_[i];
      fix.timestamp = detail::ParseNumber<double>(seconds[i]).value_or(0);
      if (!fix.has_place()) continue;
      if (IsPlace(fix.place)) {
        ++places;
        continue;
      }
      left_out.Add("outside", Outside(fix.place), lines_[i]);
      fix.place = GpsFix::kNowhere;
    }
    SettleAltitudes(notices);
    return places;
  }

  std::vector<GpsFix> Take() { return std::move(fixes_); }

 private:
  // Why the row has no fix; empty: it has one.
  std::string NoFix() const {
    const auto status = detail::ParseNumber<double>(table_.Raw(kStatus));
    if (status && *status < least_status_) return Concat("status ", *status);
    for (const auto& [column, most] : kNoFixNumbers) {
      const std::string_view cell = table_.Raw(column);
      const auto number = detail::ParseNumber<double>(cell);
      if (!(number ? *number <= most : SaysNoFix(cell))) continue;
      const detail::ColumnName* name = table_.NameOf(column);
      return Concat(name == nullptr ? FixTable().columns[column].title() : name->text, ' ', cell);
    }
    for (const std::size_t column : {kLatitude, kLongitude, kAltitude})
      if (table_.Raw(column).empty()) return Concat("no ", FixTable().columns[column].title());
    return {};
  }

  // As it stands, in the unit of its column, or degrees where a hemisphere or the name says so.
  double Angle(const Coordinate& coordinate, std::optional<std::size_t> beside, double unit) const {
    const std::size_t column = coordinate.column;
    std::string_view cell = table_.Raw(column);
    char hemisphere = beside ? HemisphereBeside(coordinate, *beside) : ' ';
    if (cell.size() > 1 && std::string_view("NSEW").find(cell.back()) != std::string_view::npos) {
      hemisphere = cell.back();
      cell = detail::Trimmed(cell.substr(0, cell.size() - 1));
    }
    if (hemisphere == ' ') return table_.Get<double>(column) * (unit == 0 ? 1 : unit);
    if (coordinate.letters.find(hemisphere) == std::string_view::npos)
      throw table_.CellError(column, column == kLatitude ? "N or S" : "E or W");
    const std::string digits = detail::IsDecimalComma(cell) ? detail::WithPoint(cell) : std::string(cell);
    if (const auto degrees = detail::DegreesOfMinutes(digits, hemisphere); degrees && unit == 0) return *degrees;
    const auto number = detail::ParseNumber<double>(digits);
    if (!number) throw table_.CellError(column, "degrees, or degrees and minutes as ddmm.mmmm");
    const double value = *number * (unit == 0 ? 1 : unit);
    return hemisphere == 'S' || hemisphere == 'W' ? -std::abs(value) : value;
  }

  // ' ' where the cell is empty.
  char HemisphereBeside(const Coordinate& coordinate, std::size_t place) const {
    const std::string_view cell = place < table_.cells().size() ? table_.cells()[place].text : std::string_view();
    const char letter = detail::HemisphereOf(cell, coordinate.letters);
    if (cell.empty() || letter != ' ') return letter;
    constexpr std::size_t kLongest = 40;
    throw table_.LineError(Concat("expected ", coordinate.letters[0], " or ", coordinate.letters[1], ", found '",
                                  cell.substr(0, kLongest), "' in column ", table_.names()[place].text));
  }

  // Angles whose names state no unit are degrees, where they can be nothing else.
  void SettleAngles(Notices& notices) {
    if (latitude_unit_ != 0 || longitude_unit_ != 0 || fixes_.empty()) return;
    double latitude = 0, longitude = 0;
    bool whole = true;
    for (const GpsFix& fix : fixes_) {
      if (!fix.has_place()) continue;
      latitude = std::max(latitude, std::abs(fix.place.latitude));
      longitude = std::max(longitude, std::abs(fix.place.longitude));
      whole &= std::round(fix.place.latitude) == fix.place.latitude;
    }
    if (whole && std::max(latitude, longitude) > 1e6 && latitude <= 9e8 && longitude <= 36e8) {
      if (latitude <= 9e7 && longitude <= 18e7)
        throw Error(ErrorKind::kNotPossible, "", Concat("line ", lines_.front()),
                    Concat("latitudes up to ", detail::Digits(latitude, 10), " and longitudes up to ",
                           detail::Digits(longitude, 10), " may be 1e-6 degrees (", latitude * 1e-6, ", ",
                           longitude * 1e-6, ") or 1e-7 degrees (", latitude * 1e-7, ", ", longitude * 1e-7,
                           "); name the columns latitude [e6] and longitude [e6], or [e7]"));
      notices.Note("latitudes and longitudes are taken as 1e-7 degrees: they are whole numbers of that size");
      for (GpsFix& fix : fixes_) fix.place.latitude *= 1e-7, fix.place.longitude *= 1e-7;
      in_e7_ = true;
      return;
    }
    const auto first = std::ranges::find_if(fixes_, &GpsFix::has_place);
    if (first != fixes_.end() && latitude <= std::numbers::pi / 2 && longitude <= std::numbers::pi)
      throw Error(ErrorKind::kNotPossible, "",
                  Concat("line ", lines_[static_cast<std::size_t>(first - fixes_.begin())]),
                  Concat("latitude ", first->place.latitude, " and longitude ", first->place.longitude,
                         " may be radians, or degrees at sea off Africa; name the columns latitude [rad] and longitude "
                         "[rad], or [deg]"));
  }

  // Altitudes whose name states no unit are metres, where they can be nothing else: receivers that count 1e-7 degrees
  // count millimetres.
  void SettleAltitudes(Notices& notices) {
    const detail::ColumnName* name = table_.NameOf(kAltitude);
    if (name != nullptr && !name->unit.empty()) return;
    double least = std::numeric_limits<double>::infinity(), most = 0;
    bool whole = true;
    std::size_t first = fixes_.size();
    for (std::size_t i = 0; i < fixes_.size(); ++i) {
      if (!fixes_[i].has_place()) continue;
      const double altitude = fixes_[i].place.altitude;
      first = std::min(first, i);
      least = std::min(least, std::abs(altitude));
      most = std::max(most, std::abs(altitude));
      whole &= std::round(altitude) == altitude;
    }
    if (first == fixes_.size()) return;
    constexpr double kHighest = 12e3, kLikelyMillimetres = 10e3;  // metres above airliners, and 10 m in millimetres
    if (in_e7_ && whole && least > kLikelyMillimetres) {
      notices.Note("altitudes are taken as millimetres: they are whole numbers above 10,000 beside 1e-7 degrees");
      for (GpsFix& fix : fixes_) fix.place.altitude *= 1e-3;
    } else if (least > kHighest || (in_e7_ && whole && most > 0)) {
      const double altitude = fixes_[first].place.altitude;
      throw Error(ErrorKind::kNotPossible, "", Concat("line ", lines_[first]),
                  Concat("the altitudes may be metres, the first ", detail::Digits(altitude, 10),
                         " m, or millimetres, the first ", detail::Digits(altitude * 1e-3, 10),
                         " m; name the column altitude [m], or [mm], or what it is"));
    }
  }

  static std::string Outside(const Geodetic& place) {
    if (std::abs(place.latitude) <= 90) return Concat("longitude ", place.longitude, " is outside -360 to 360");
    return Concat("latitude ", detail::Digits(place.latitude, 12), " is outside -90 to 90; ",
                  std::abs(place.latitude) <= 360
                      ? "are latitude and longitude swapped?"
                      : "is it degrees and minutes (ddmm.mmmm), which need N or S beside them, or metres?");
  }

  const Table& table_;
  const std::optional<std::size_t> north_south_, east_west_;  // places in a row
  const double least_status_;
  const double latitude_unit_, longitude_unit_, altitude_unit_;
  bool in_e7_;  // angles are whole numbers of 1e-7 degrees
  std::vector<GpsFix> fixes_;
  std::vector<std::size_t> lines_;
};

// Of heights above the ellipsoid and the sea, those above the ellipsoid are taken: places are those of WGS84.
void TellWhichHeights(const Table& table, Notices& notices) {
  const detail::ColumnName* taken = table.NameOf(kAltitude);
  if (taken == nullptr) return;
  if (taken->text.find("msl") != std::string::npos)
    notices.Note("altitudes above the sea are taken for altitudes above the ellipsoid");
  const auto is_height = [&](const detail::ColumnName& name) {
    const auto& names = FixTable().columns[kAltitude].names;
    return &name != taken && std::ranges::any_of(names, [&](std::string_view wanted) {
      if (wanted.starts_with('.')) wanted.remove_prefix(1);
      return detail::Comparable(name.name) == wanted;
    });
  };
  std::string others;
  for (const detail::ColumnName& name : table.names())
    if (is_height(name)) others += Concat(others.empty() ? "" : ", ", name.text);
  if (!others.empty()) notices.Note(Concat("altitudes are those of the column ", taken->text, ", not of ", others));
}

// Without names only the four columns of fixes are known: a fifth one may stand anywhere among them.
void RequireFourCells(const Table& table) {
  std::size_t filled = table.cells().size();
  while (filled > 0 && table.cells()[filled - 1].text.empty()) --filled;
  if (filled > 4)
    throw table.LineError(Concat("expected ", FixTable().expected, ", found ", filled,
                                 " columns without names; name them in a first line, as "
                                 "`timestamp,latitude,longitude,altitude`, with any name for the others"));
}

}  // namespace

namespace detail {

void LeftOutFixes::Add(std::string_view kind, const std::string& text, std::size_t line) {
  const auto same = std::ranges::find(reasons_, kind, &Reason::kind);
  if (same != reasons_.end())
    ++same->count;
  else
    reasons_.push_back({std::string(kind), text, 1, line});
}

void LeftOutFixes::Tell(std::size_t kept, Notices& notices) const {
  if (reasons_.empty()) return;
  if (kept == 0) {
    const Reason& first = reasons_.front();
    throw Error(ErrorKind::kDamaged, "", Concat("line ", first.first_line), "no row has a fix: " + first.text);
  }
  std::size_t count = 0;
  std::string list;
  for (const Reason& reason : reasons_) {
    count += reason.count;
    list += Concat(list.empty() ? "" : "; ", reason.text, " (", Counted(reason.count, "row"), ", first in line ",
                   reason.first_line, ")");
  }
  notices.Warn(
      Concat("left out because the receiver had no fix: ", Counted(count, "row"), " of ", count + kept, ": ", list));
}

std::optional<double> DegreesOfMinutes(std::string_view number, char hemisphere) {
  const bool latitude = hemisphere == 'N' || hemisphere == 'S';
  const std::size_t whole = std::min(number.find('.'), number.size());
  if (whole != (latitude ? 4U : 5U)) return std::nullopt;
  const auto degrees = ParseNumber<std::uint32_t>(number.substr(0, whole - 2));
  const auto minutes = ParseNumber<double>(number.substr(whole - 2));
  if (!degrees || !minutes || *minutes < 0 || *minutes >= 60) return std::nullopt;
  const double value = *degrees + *minutes / 60;
  return hemisphere == 'S' || hemisphere == 'W' ? -value : value;
}

}  // namespace detail

std::vector<GpsFix> ParseFixes(std::string_view text, const FixReadOptions& options, Notices* notices) {
  Notices unheard;
  Notices& heard = notices == nullptr ? unheard : *notices;
  if (detail::IsNmea(text)) return detail::ParseNmea(text, heard);
  if (detail::IsRtklib(text)) return detail::ParseRtklib(text, options, heard);
  Table table(text, FixTable());
  FixReader reader(table, detail::ContentsOfColumns(text, FixTable()), heard);
  detail::TimeReader times(table, {.asked = options.time_unit, .time = kTime, .date = kDate});
  LeftOutFixes left_out;
  while (table.Next()) {
    if (table.names().empty()) RequireFourCells(table);
    if (reader.Add(left_out)) times.Add();
  }
  if (table.names().empty())
    heard.Note("no line names the columns: they are taken as time, latitude, longitude and altitude");
  left_out.Tell(reader.Finish(times.Seconds(heard), left_out, heard), heard);
  if (table.has_decimal_commas()) heard.Note("commas in numbers are taken as decimal commas");
  TellWhichHeights(table, heard);
  return reader.Take();
}

std::vector<GpsFix> ReadFixes(const std::string& path, const FixReadOptions& options, Notices* notices) {
  Notices unheard;
  Notices& heard = notices == nullptr ? unheard : *notices;
  return detail::ParseLines(path, "a table of GPS fixes", heard, [&](std::string_view text) {
    auto fixes = ParseFixes(text, options, &heard);
    if (fixes.empty()) throw Error(ErrorKind::kDamaged, "holds no fix");
    return fixes;
  });
}

}  // namespace slamdb
