// SPDX-License-Identifier: BSD-3-Clause
// Sentences of NMEA 0183: GGA has place, altitude and time of day, RMC and ZDA have the day.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/detail/visible.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/frame/detail/fixes.h"

namespace slamdb::detail {
namespace {

constexpr double kDay = 86400;

struct Sentence {
  std::size_t line = 0;
  std::string_view text;                // without `$` and checksum
  std::vector<std::string_view> cells;  // the first is talker and kind: GPGGA

  bool Is(std::string_view kind) const { return cells[0].size() == 5 && cells[0].ends_with(kind); }
  std::string_view At(std::size_t cell) const { return cell < cells.size() ? cells[cell] : std::string_view(); }
  Error Wrong(std::size_t cell, std::string_view name, std::string_view expected) const {
    return Error(ErrorKind::kDamaged, "", Concat("line ", line),
                 Concat("expected ", expected, ", found '", At(cell), "' in the ", name, " of ", cells[0]));
  }
};

// Whether the text is as `recorded` behind its star.
bool HasChecksum(std::string_view text, std::string_view recorded) {
  unsigned sum = 0;
  for (const char letter : text) sum ^= static_cast<unsigned char>(letter);
  unsigned stated = 0;
  const auto [end, error] = std::from_chars(recorded.data(), recorded.data() + recorded.size(), stated, 16);
  return error == std::errc() && end == recorded.data() + recorded.size() && stated == sum;
}

// What is no sentence that can be read, and why the first is not.
struct DamagedLines {
  std::size_t count = 0;
  std::optional<Error> first;

  void Add(const Error& error) {
    if (count++ == 0) first = error;
  }
  void Tell(Notices& notices) const {
    if (count > 0)
      notices.Warn(Concat("left out because they are damaged or no sentences of NMEA: ", Counted(count, "line"),
                          ", the first in ", first->place(), ": ", first->problem()));
  }
};

// The sentences of a text, which may stand behind something else in a line. Where any has a checksum, all need one.
// Throws Error with the first damaged line when most are.
std::vector<Sentence> SentencesIn(std::string_view text, DamagedLines& damaged) {
  const bool checked = text.find('*') != text.npos;
  std::vector<Sentence> sentences;
  for (std::size_t number = 1; !text.empty(); ++number) {
    std::string_view line = Trimmed(TakeLine(text));
    if (line.empty() || IsCommentMark(line[0])) continue;
    const auto add_damaged = [&](const std::string& problem) {
      damaged.Add(Error(ErrorKind::kDamaged, "", Concat("line ", number), problem));
    };
    const std::size_t begin = line.rfind('$');
    if (begin == line.npos) {
      add_damaged("holds no sentence");
      continue;
    }
    line.remove_prefix(begin + 1);
    const std::size_t star = line.find('*');
    Sentence sentence{number, line.substr(0, star), Split(line.substr(0, star), ',')};
    if (star == line.npos && checked)
      add_damaged("is cut: it has no checksum");
    else if (star != line.npos && !HasChecksum(sentence.text, line.substr(star + 1)))
      add_damaged(Concat("does not match the checksum of its sentence ", Visible(sentence.cells[0].substr(0, 10))));
    else
      sentences.push_back(std::move(sentence));
  }
  if (damaged.count > sentences.size()) throw *damaged.first;
  return sentences;
}

// `221320.25`: seconds since midnight.
double TimeOfDay(const Sentence& sentence) {
  const std::string_view text = sentence.At(1);
  const auto whole = ParseNumber<int>(text.substr(0, std::min<std::size_t>(text.size(), 4)));
  const auto seconds = ParseNumber<double>(text.substr(std::min<std::size_t>(text.size(), 4)));
  if (text.size() < 6 || !whole || !seconds || *whole / 100 > 23 || *whole % 100 > 59 || !(*seconds < 61))
    throw sentence.Wrong(1, "time", "hhmmss.ss");
  return *whole / 100 * 3600 + *whole % 100 * 60 + *seconds;
}

double DaysOf(const Sentence& sentence, int year, int month, int day) {
  const std::chrono::year_month_day date(std::chrono::year(year), std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day)));
  if (!date.ok()) throw sentence.Wrong(9, "date", "a day");
  return static_cast<double>(std::chrono::sys_days(date).time_since_epoch().count());
}

// Seconds since 1970 of an RMC (ddmmyy) or ZDA; nothing of other sentences and of empty dates.
std::optional<double> TimeWithDay(const Sentence& sentence) {
  if (sentence.Is("RMC") && !sentence.At(9).empty() && !sentence.At(1).empty()) {
    const auto date = ParseNumber<int>(sentence.At(9));
    if (!date || sentence.At(9).size() != 6) throw sentence.Wrong(9, "date", "ddmmyy");
    const int year = *date % 100;
    return DaysOf(sentence, year + (year < 80 ? 2000 : 1900), *date / 100 % 100, *date / 10000) * kDay +
           TimeOfDay(sentence);
  }
  if (sentence.Is("ZDA") && !sentence.At(4).empty() && !sentence.At(1).empty()) {
    const auto day = ParseNumber<int>(sentence.At(2)), month = ParseNumber<int>(sentence.At(3)),
               year = ParseNumber<int>(sentence.At(4));
    if (!day || !month || !year) throw sentence.Wrong(4, "date", "day, month and year");
    return DaysOf(sentence, *year, *month, *day) * kDay + TimeOfDay(sentence);
  }
  return std::nullopt;
}

// The time of a sentence that tells none of its day, nearest to that of one that does.
double Nearest(double time_of_day, double known) {
  return time_of_day + kDay * std::round((known - time_of_day) / kDay);
}

double Coordinate(const Sentence& sentence, std::size_t cell, std::string_view name, std::string_view letters) {
  const std::string_view hemisphere = sentence.At(cell + 1);
  if (hemisphere.size() != 1 || letters.find(hemisphere[0]) == letters.npos)
    throw sentence.Wrong(cell + 1, "hemisphere", letters == "NS" ? "N or S" : "E or W");
  const auto degrees = DegreesOfMinutes(sentence.At(cell), hemisphere[0]);
  if (!degrees) throw sentence.Wrong(cell, name, "degrees and minutes");
  return *degrees;
}

// How far the geoid is above the ellipsoid.
std::optional<double> GeoidOf(const Sentence& sentence) { return ParseNumber<double>(sentence.At(11)); }

double AltitudeOf(const Sentence& sentence) {
  const auto above_sea = ParseNumber<double>(sentence.At(9));
  if (!above_sea) throw sentence.Wrong(9, "altitude", "metres");
  return *above_sea + GeoidOf(sentence).value_or(0);
}

// `$GPGGA,...`, talker and kind, at the beginning of a line or behind something else.
bool HasSentence(std::string_view line) {
  const std::size_t begin = line.rfind('$');
  if (begin == line.npos) return false;
  line.remove_prefix(begin + 1);
  return line.size() > 6 && line[5] == ',' &&
         std::ranges::all_of(line.substr(0, 5), [](char letter) { return letter >= 'A' && letter <= 'Z'; });
}

// Collects the fixes of sentences in their order.
class FixCollector {
 public:
  explicit FixCollector(double known) : known_(known) {}

  void Add(const Sentence& sentence) {
    if (const auto time = TimeWithDay(sentence)) known_ = *time;
    if (!sentence.Is("GGA")) return;
    if (sentence.At(6).empty() || sentence.At(6) == "0" || sentence.At(2).empty()) {
      left_out_.Add("quality 0", sentence.line);
      if (!sentence.At(1).empty()) fixes_.push_back({Nearest(TimeOfDay(sentence), known_), GpsFix::kNowhere});
      return;
    }
    without_geoid_ += !GeoidOf(sentence);
    fixes_.push_back({Nearest(TimeOfDay(sentence), known_),
                      {Coordinate(sentence, 2, "latitude", "NS"), Coordinate(sentence, 4, "longitude", "EW"),
                       AltitudeOf(sentence)}});
  }

  std::vector<GpsFix> Take(Notices& notices) {
    left_out_.Tell(static_cast<std::size_t>(std::ranges::count_if(fixes_, &GpsFix::has_place)), notices);
    if (without_geoid_ > 0)
      notices.Note(Concat("altitudes above the sea are taken for altitudes above the ellipsoid: ",
                          Counted(without_geoid_, "sentence"), " without the height of the geoid"));
    return std::move(fixes_);
  }

 private:
  double known_;
  std::vector<GpsFix> fixes_;
  LeftOutFixes left_out_;
  std::size_t without_geoid_ = 0;
};

}  // namespace

bool IsNmea(std::string_view text) {
  if (IsUtf16(text)) return false;
  text = WithoutMark(text);
  constexpr int kLines = 50;  // a log may begin in the middle of a sentence
  for (int i = 0; i < kLines && !text.empty(); ++i)
    if (HasSentence(TakeLine(text))) return true;
  return false;
}

std::vector<GpsFix> ParseNmea(std::string_view text, Notices& notices) {
  DamagedLines damaged;
  const std::vector<Sentence> sentences = SentencesIn(WithoutMark(text), damaged);
  const auto read = [&](const Sentence& sentence, const auto& use) {
    try {
      use(sentence);
    } catch (const Error& error) {
      damaged.Add(error);
    }
  };
  std::optional<double> known;
  for (const Sentence& sentence : sentences)
    if (!known) read(sentence, [&](const Sentence& dated) { known = TimeWithDay(dated); });
  if (!known && damaged.first) throw *damaged.first;
  if (!known)
    throw Error(
        ErrorKind::kNotPossible,
        "is of NMEA sentences that tell the time of a day, but not which: no RMC or ZDA with a date is among them");
  const std::size_t damaged_before = damaged.count;
  FixCollector collector(*known);
  for (const Sentence& sentence : sentences) read(sentence, [&](const Sentence& one) { collector.Add(one); });
  std::vector<GpsFix> fixes = collector.Take(notices);
  const bool mostly_damaged = fixes.size() < damaged.count - damaged_before;
  if (damaged.first && (fixes.empty() || mostly_damaged)) throw *damaged.first;
  if (fixes.empty())
    throw Error(ErrorKind::kNotPossible, "is of NMEA sentences without GGA, which alone tell the altitude");
  damaged.Tell(notices);
  return fixes;
}

}  // namespace slamdb::detail
