// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "cli/command.h"
#include "cli/report/layout.h"

namespace slamdb::cli {

struct HelpStyle {
  bool whole = true;  // what --help prints; otherwise -h: usage, a line for each option, two examples
  std::size_t width = kPageWidth;
  bool colour = false;
};

// What -h and --help print for the program, a verb or a verb of a verb: usage, description, options, those that every
// verb has last, exit codes, examples.
std::string HelpText(const CLI::App& app, const HelpStyle& style = {});

// The command whose verb this is, or is part of. Null for the program itself.
const Command* CommandOf(const CLI::App& app);

// The exit codes of a verb with their meaning.
std::vector<std::pair<ExitCode, std::string_view>> ExitCodesOf(const Command& command);

}  // namespace slamdb::cli
