// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <string>
#include <vector>

// What CLI11 knows of the options, as help, manual pages and completion scripts need it, so that none of them can drift
// from what is parsed.
namespace slamdb::cli {

inline constexpr const char* kCommonGroup = "Common options";  // what every verb has; listed last

struct OptionEntry {
  std::vector<std::string> names;    // {"-o", "--output"}; empty for a positional argument
  std::string value;                 // "FILE"; empty for a flag
  std::vector<std::string> choices;  // the values it takes, if only these
  std::string description;
  std::string default_text;  // empty: none worth telling
  std::string group;         // the heading it stands under
  bool required = false, repeated = false;

  bool positional() const { return names.empty(); }
  // "-o, --output FILE", "FILE...".
  std::string Heading() const;
};

// Positional arguments first, then options group by group in the order they were bound.
std::vector<OptionEntry> OptionsOf(const CLI::App& app);

// The verbs below, in the order they were added; hidden ones left out unless asked for.
std::vector<const CLI::App*> VerbsOf(const CLI::App& app, bool hidden = false);

// "slamdb vocabulary show".
std::string FullName(const CLI::App& app);

// "slamdb info [OPTION...] FILE...".
std::string Synopsis(const CLI::App& app);

}  // namespace slamdb::cli
