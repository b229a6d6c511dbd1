// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "cli/help/tree.h"

// No output is an input. An option or positional of type FILE names what is read, unless it is marked here as one that
// is written; so an option that nobody thought of is guarded, and one that is written without a mark is refused as
// soon as it is tried.
namespace slamdb::cli {

enum class Writes {
  kFile,     // a report, a table, a journal, a copy of a store
  kAtlas,    // a file or STORE.db#NAME
  kPattern,  // the names of several atlases
};

// Marks it, and returns it.
CLI::Option* Mark(CLI::Option* option, Writes what);
std::optional<Writes> MarkOf(CLI::Option& option);

// Whether its values are names of files.
bool NamesFiles(const CLI::Option* option);

// Remembers every file that the options of a verb name as one that is read, for the rest of the run (run_files.h), and
// looks at what would be written. Ends with exit code 2 when a name is empty, as a variable of a shell that is not set.
//
// Throws Error when an output is an input, also standard output, or the same as another one.
void GuardFiles(CLI::App& verb);

}  // namespace slamdb::cli
