// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/checks/finding.h"

#include <array>
#include <charconv>

namespace slamdb {

std::string_view ToString(Severity severity) {
  switch (severity) {
    case Severity::kNote:
      return "note";
    case Severity::kWarning:
      return "warning";
    case Severity::kError:
      break;
  }
  return "error";
}

std::string ToString(const Place& place) {
  std::string text;
  const auto append = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  if (place.map) append(ToString(place.map));
  if (place.keyframe) append(ToString(place.keyframe));
  if (place.feature >= 0) append("feature " + std::to_string(place.feature));
  if (place.point) append(ToString(place.point));
  if (place.camera) append(ToString(place.camera));
  if (place.landmark) append(ToString(place.landmark));
  return text.empty() ? "atlas" : text;
}

// Six significant digits, independent of the locale.
void Findings::Append(std::string& message, double value) {
  std::array<char, 32> digits;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::general, 6);
  message.append(digits.data(), end.ptr);
}

}  // namespace slamdb
