// SPDX-License-Identifier: BSD-3-Clause
#include "cli/report/paint.h"

#include <array>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"

namespace slamdb::cli {
namespace {

using detail::Concat;

// Each line as `paint` has it.
template <class Paint>
std::string PaintLines(std::string_view text, const Paint& paint) {
  std::string out;
  while (!text.empty()) out += paint(detail::TakeLine(text)) + "\n";
  return out;
}

std::string BoldUpTo(std::string_view line, std::size_t end) {
  end = std::min(end, line.size());
  return Painted(line.substr(0, end), Colour::kBold).append(line.substr(end));
}

// `  error map-listed-once (2)`.
std::string PaintRule(std::string_view line) {
  static constexpr std::array<std::pair<std::string_view, Colour>, 3> kSeverities = {
      {{"  error ", Colour::kRed}, {"  warning ", Colour::kYellow}, {"  note ", Colour::kBold}}};
  for (const auto& [beginning, colour] : kSeverities)
    if (line.starts_with(beginning)) return "  " + Painted(line.substr(2), colour);
  return std::string(line);
}

// `lab.osa: 1 error, 876 notes: not sound (114 rules checked)`, at the margin.
std::string PaintVerdict(std::string_view line) {
  for (const std::string_view bad : {"not sound", "not readable"})
    if (const std::size_t at = line.rfind(bad); at != std::string_view::npos)
      return Concat(line.substr(0, at), Painted(bad, Colour::kRed), line.substr(at + bad.size()));
  constexpr std::string_view kSound = ": sound";
  const std::size_t at = line.rfind(kSound);
  if (at == std::string_view::npos) return std::string(line);
  return Concat(line.substr(0, at + 2), Painted("sound", Colour::kGreen), line.substr(at + kSound.size()));
}

}  // namespace

std::string Painted(std::string_view text, Colour colour) {
  static constexpr std::array kCodes = {"1", "2", "1;31", "1;33", "1;32"};  // in the order of Colour
  if (text.empty()) return {};
  return Concat("\033[", kCodes[static_cast<std::size_t>(colour)], "m", text, "\033[0m");
}

std::string PaintHeadings(std::string_view text) {
  return PaintLines(text, [](std::string_view line) {
    return line.empty() || line.front() == ' ' ? std::string(line) : BoldUpTo(line, line.find("  "));
  });
}

std::string PaintFindings(std::string_view text) {
  return PaintLines(
      text, [](std::string_view line) { return line.starts_with("  ") ? PaintRule(line) : PaintVerdict(line); });
}

}  // namespace slamdb::cli
