// SPDX-License-Identifier: BSD-3-Clause
// Positions as RTKLIB writes them (.pos): a table whose comments name the columns, day and time of day under one name.
#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/frame/detail/fixes.h"

namespace slamdb::detail {
namespace {

bool Has(std::string_view text, std::string_view part) { return text.find(part) != text.npos; }

// The line that names the columns, without its end; empty when there is none at the beginning.
std::string_view HeaderOf(std::string_view text) {
  while (text.starts_with('%')) {
    const std::string_view line = TakeLine(text);
    if ((Has(line, "GPST") || Has(line, "UTC")) && (Has(line, "latitude(") || Has(line, "x-ecef("))) return line;
  }
  return {};
}

// By how many seconds the clock of GPS is ahead of UTC, at seconds since 1970.
double LeapSecondsAt(double time) {
  constexpr double kSteps[] = {1136073600, 1230768000, 1341100800, 1435708800, 1483228800};  // 2006 to 2017
  double leap = 13;
  for (const double step : kSteps) leap += time >= step;
  return leap;
}

}  // namespace

bool IsRtklib(std::string_view text) { return !HeaderOf(WithoutMark(text)).empty(); }

std::vector<GpsFix> ParseRtklib(std::string_view text, const FixReadOptions& options, Notices& notices) {
  text = WithoutMark(text);
  const std::string_view header = HeaderOf(text);
  if (!Has(header, "latitude(deg)"))
    throw Error(
        ErrorKind::kUnsupported,
        "holds positions of RTKLIB that are no degrees; write them as latitude, longitude and height in degrees");
  const std::size_t at = static_cast<std::size_t>(header.data() - text.data());
  const bool gps_time = Has(header, "GPST");
  std::string names(header);
  const std::string_view clock = gps_time ? "GPST" : "UTC";
  names.replace(names.find(clock), clock.size(), "date time");
  if (const std::size_t satellites = names.find(" ns"); satellites != names.npos)
    names.replace(satellites, 3, " num_sats");
  std::string_view rows = text.substr(at + header.size());
  std::string_view first = Trimmed(rows);
  if (first.find_first_of("/-") > 8)
    throw Error(ErrorKind::kUnsupported,
                "holds positions of RTKLIB by week and second; write them with date and time (rnx2rtkp -t)");
  Notices told;  // not that times are taken as UTC
  auto fixes = ParseFixes(Concat(text.substr(0, at), names, rows), options, &told);
  for (const Notice& notice : told.items())
    if (notice.kind != Notice::Kind::kNote) notices.Warn(notice.text);
  if (!gps_time || fixes.empty()) return fixes;
  for (GpsFix& fix : fixes) fix.timestamp -= LeapSecondsAt(fix.timestamp);
  notices.Note(Concat("times are those of GPS, which is ahead of UTC: ", LeapSecondsAt(fixes.front().timestamp),
                      " s are taken away"));
  return fixes;
}

}  // namespace slamdb::detail
