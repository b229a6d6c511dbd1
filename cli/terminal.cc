// SPDX-License-Identifier: BSD-3-Clause
#include "cli/terminal.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>

#include "cli/report/layout.h"
#include "slamdb/base/detail/text.h"

namespace slamdb::cli {
namespace {

constexpr std::size_t kNarrowest = 40, kWidest = 100;

// Empty when it is not set.
std::string_view Variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? std::string_view() : value;
}

}  // namespace

bool UsesColour(int stream, ColourChoice choice) {
  if (choice != ColourChoice::kAuto) return choice == ColourChoice::kAlways;
  return ::isatty(stream) != 0 && Variable("NO_COLOR").empty() && Variable("TERM") != "dumb";
}

std::optional<std::size_t> TerminalColumns(int stream) {
  if (const auto columns = detail::ParseNumber<std::size_t>(Variable("COLUMNS")); columns && *columns > 0)
    return columns;
  winsize size{};
  if (::ioctl(stream, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return std::nullopt;
  return size.ws_col;
}

std::size_t PageWidth(int stream) {
  const auto columns = TerminalColumns(stream);
  return columns ? std::clamp(*columns, kNarrowest, kWidest) : kPageWidth;
}

bool ShowsUnicode() {
  if (Variable("TERM") == "dumb") return false;
  std::string locale;
  for (const char* name : {"LC_ALL", "LC_CTYPE", "LANG"})
    if (locale.empty()) locale = Variable(name);
  std::ranges::transform(locale, locale.begin(), [](unsigned char letter) { return std::tolower(letter); });
  return locale.find("utf-8") != std::string::npos || locale.find("utf8") != std::string::npos;
}

}  // namespace slamdb::cli
