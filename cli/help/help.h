// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "cli/command.h"

namespace slamdb::cli {

// What --help prints for the program, a verb or a verb of a verb: usage, description, options, exit codes, examples.
std::string HelpText(const CLI::App& app);

// The command whose verb this is, or is part of. Null for the program itself.
const Command* CommandOf(const CLI::App& app);

// The exit codes of a verb with their meaning.
std::vector<std::pair<ExitCode, std::string_view>> ExitCodesOf(const Command& command);

// The word of `known` that `word` is most likely a typing mistake of, or empty.
std::string DidYouMean(std::string_view word, const std::vector<std::string>& known);

}  // namespace slamdb::cli
