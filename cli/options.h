// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cli/console.h"
#include "cli/guard.h"
#include "cli/help/tree.h"
#include "cli/selection.h"
#include "slamdb/formats/format.h"

// Options that more than one verb takes, spelled once. Each function binds and does nothing else.
namespace slamdb::cli {

constexpr double kUsualWait = 5;  // seconds, for another program that writes to a store

// -q/--quiet -v/--verbose --threads --progress/--no-progress: every verb has them. From here on options of type N and
// ID refuse what is no whole number, with a sign or without.
void AddConsoleOptions(CLI::App& verb, ConsoleOptions& options);

// --from FORMAT and --layout LAYOUT.
struct InputFormat {
  std::string format, layout;
  bool empty() const { return format.empty() && layout.empty(); }
};

// The positional FILE..., required unless the verb says otherwise, and those.
struct InputOptions {
  std::vector<std::string> paths;
  InputFormat from;
};
CLI::Option* AddInputs(CLI::App& verb, InputOptions& options, const std::string& description);

// --from and --layout alone, for verbs that name their inputs otherwise.
void AddFrom(CLI::App& verb, InputFormat& from);
// The format that it names, or what the content tells; null where nothing does.
const Format* FormatOfInput(const HeldSource& input, const InputFormat& from);
// --layout alone, for verbs that read trajectories too.
void AddLayout(CLI::App& verb, std::string& layout);
// -o/--output FILE and -O/--overwrite, for verbs whose result is a text that goes to standard output by default.
struct OutputOptions {
  std::string path = "-";
  bool overwrite = false;
};
void AddOutput(CLI::App& verb, OutputOptions& options);
void WriteOutput(const OutputOptions& options, std::string_view text, Console& console, Painter painter = nullptr);

// The positional OUTPUT and -o/--output, of which a command line has one. Which one there has to be says
// RequireOutput.
void AddOutputPlace(CLI::App& verb, std::string& output, Writes writes, const std::string& description);

// What help says of where an atlas may be, spelled once: `The atlas: a file, STORE.db#NAME, ..., or - for standard
// input`; of an output; and of a store.
std::string AtlasAt(const std::string& what);
std::string OutputAt();
std::string StoreAt(const std::string& what);

// Ends with exit code 2 when there is no output.
void RequireOutput(const std::string& output);

// --to FORMAT, -O/--overwrite, --no-sync, --to-layout and --boost-version, for verbs that write an atlas.
struct TargetOptions {
  std::string to, layout;
  std::optional<std::uint32_t> boost_version;
  bool overwrite = false;
  bool no_sync = false;
};
void AddTarget(CLI::App& verb, TargetOptions& options);
constexpr const char* kArchiveGroup = "ORB-SLAM3 files";
// Ends with exit code 2 when they would be without effect on an output of the format.
//
// Throws Error when what is written is no atlas, and would replace one.
void RefuseBadTarget(const Location& output, const Format& format, const TargetOptions& options);

// The positional STORE, and --wait SECONDS, for the store's own verbs.
struct StoreVerbOptions {
  std::string path;
  double wait = kUsualWait;
};
void AddStore(CLI::App& verb, StoreVerbOptions& options);
// --wait SECONDS alone.
void AddWait(CLI::App& verb, double& wait);

// --json.
void AddJson(CLI::App& verb, bool& json);

// Ends with exit code 2: the options do not make sense together, which CLI11 cannot tell.
[[noreturn]] void RefuseUsage(const std::string& problem);

// For ->transform(): one of the words, which help and completion list, becomes the number of its value.
template <class Value>
CLI::Validator OneOf(const std::map<std::string, Value>& words) {
  std::string list;
  for (const auto& [word, value] : words) list += (list.empty() ? "{" : ",") + word;
  list += "}";
  return {[words, list](std::string& text) {
            const auto found = words.find(text);
            if (found == words.end()) return text + " not in " + list;
            text = std::to_string(static_cast<int>(found->second));
            return std::string();
          },
          list};
}

// For ->check().

// Whether what is written there goes where verbs print: `-`, or `/dev/stdout` that is a pipe or a file. On a terminal
// the two do not mix up, and in /dev/null they do no harm.
bool IsStandardOutput(const std::string& path);

// Throws Error when bytes that are not text would go to a terminal.
void RefuseBinaryOnTerminal(const Location& output, const Format& format, bool ascii = false);

// Read and write options as the console and the groups above have them. Stores are waited for `wait` seconds, and
// enter `provenance` in their history.
ReadOptions MakeReadOptions(Console& console, const InputFormat& from = {}, double wait = kUsualWait);
WriteOptions MakeWriteOptions(Console& console, const TargetOptions& target, const std::string& provenance,
                              double wait = kUsualWait);

}  // namespace slamdb::cli
