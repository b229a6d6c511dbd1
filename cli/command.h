// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <span>
#include <string_view>

namespace CLI {
class App;
}

namespace slamdb::cli {

class Console;

// How the process ends.
enum class ExitCode : int {
  kDone = 0,
  kFailed = 1,  // or findings of severity error
  kUsage = 2,   // and of verbs that compare any trouble
  kLossy = 3,   // done, but an output that claims to hold an atlas does not hold all of the input
};

// What a verb does once its options are bound and parsed. Throws slamdb::Error.
using Run = std::function<ExitCode(Console&)>;

// The headings that the help lists verbs under, in its order.
enum class Group {
  kLook,     // what is in an atlas, and how atlases differ
  kCheck,    // whether it is sound, and what mends it
  kChange,   // one atlas, or parts of it
  kCombine,  // several
  kConvert,  // other formats, and atlases made of nothing
  kStore,    // stores as a whole
  kOther,    // slamdb itself
};
std::string_view TitleOf(Group group);  // "check and repair"

struct Example {
  std::string_view command, meaning;
};

// One verb: everything its help, its manual page and the completion scripts say that is not an option.
struct Command {
  std::string_view name;
  std::string_view summary;  // one line
  Group group = Group::kOther;
  std::string_view description;     // paragraphs, separated by empty lines
  std::string_view done = "Done.";  // what exit code 0 means,
  std::string_view failed = "An input could not be read, or the output not be written.";  // 1,
  std::string_view lossy = {};                                                            // and 3; empty: never
  std::span<const Example> examples;
  Run (*add)(CLI::App& verb) = nullptr;  // binds options and returns what to run; does nothing else
  bool hidden = false;                   // not in the list of verbs
  bool tells_of_all = false;             // of the options of other verbs
  std::string_view trouble = {};         // of verbs whose failures end with 2, as cmp's do: what 2 means
};

// Every verb, in the order in which the help lists them.
std::span<const Command* const> Commands();

// The verb of that name, or null.
const Command* FindCommand(std::string_view name);

}  // namespace slamdb::cli
