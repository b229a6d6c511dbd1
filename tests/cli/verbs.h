// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/guard.h"

namespace slamdb::testing {

// An option or positional of a verb that names a file.
struct FileOption {
  std::string name;  // "INPUT", "--journal"
  bool positional = false, required = false;
  std::optional<cli::Writes> writes;  // nullopt: it is read
};

// A verb as the command itself binds it, also one of a verb, so that a new one is in every test that goes through all.
struct Verb {
  std::vector<std::string> words;  // {"vocabulary", "set"}
  std::vector<FileOption> files;   // positionals in their order, then options
  bool overwrites = false;         // has -O/--overwrite
  bool output_option = false;      // -o/--output stands for the positional OUTPUT, and is left out of `files`

  std::string name() const;
};

std::vector<Verb> AllVerbs();

// Of every option and positional of every verb: `check --ignore` and the name of its type, `RULE`.
std::vector<std::pair<std::string, std::string>> TypesOfOptions();

// A command line of the verb that works in a folder made by FillFolder: all positionals, required options, and the
// options that write; what else it needs stands in a table in verbs.cc, where a new verb may need a line.
std::vector<std::string> CommandLine(const Verb& verb);

// What the option is given in it.
std::string ValueOf(const Verb& verb, const FileOption& option);

// Writes the inputs that the command lines name: a.osa, b.osa, m.db with the atlases a and b, voc.txt, room.osa with
// room.jpg, and small ones.
void FillFolder(const std::string& folder);

}  // namespace slamdb::testing
