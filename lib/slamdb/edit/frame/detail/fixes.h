// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/edit/frame/georeference.h"

namespace slamdb::detail {

// Counts what is left out by the reason, and tells it.
class LeftOutFixes {
 public:
  // `text` of the first stands for all of that kind.
  void Add(std::string_view kind, const std::string& text, std::size_t line);
  void Add(const std::string& kind, std::size_t line) { Add(kind, kind, line); }
  // Throws Error with the first when `kept` is 0 and something was left out.
  void Tell(std::size_t kept, Notices& notices) const;

 private:
  struct Reason {
    std::string kind, text;
    std::size_t count, first_line;
  };
  std::vector<Reason> reasons_;
};

// Degrees of `4722.1234` and `N`, degrees and minutes as NMEA has them; nothing when they are none.
std::optional<double> DegreesOfMinutes(std::string_view number, char hemisphere);

// Whether a text is of sentences of NMEA 0183, one a line.
bool IsNmea(std::string_view text);

// Damaged sentences are left out, and told. Throws Error when most are, no sentence tells the day, or none has an
// altitude.
std::vector<GpsFix> ParseNmea(std::string_view text, Notices& notices);

// Whether a text is of positions that RTKLIB wrote, which are a table but for the name of their times.
bool IsRtklib(std::string_view text);
std::vector<GpsFix> ParseRtklib(std::string_view text, const FixReadOptions& options, Notices& notices);

}  // namespace slamdb::detail
