// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>

// What the terminal of whoever reads can do, told by the stream (STDOUT_FILENO, STDERR_FILENO) and the environment.
namespace slamdb::cli {

enum class ColourChoice { kAuto, kAlways, kNever };

// Of itself on terminals only, unless NO_COLOR is set or TERM is `dumb`.
bool UsesColour(int stream, ColourChoice choice = ColourChoice::kAuto);

// COLUMNS, or what the terminal has; nothing where neither tells.
std::optional<std::size_t> TerminalColumns(int stream);

// Columns of text: those, but at most 100; kPageWidth where there are none.
std::size_t PageWidth(int stream);

// Whether the locale is one of UTF-8, and TERM one that shows it.
bool ShowsUnicode();

}  // namespace slamdb::cli
