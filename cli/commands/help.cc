// SPDX-License-Identifier: BSD-3-Clause
#include "cli/help/help.h"

#include <unistd.h>

#include <array>
#include <memory>

#include "cli/commands/commands.h"
#include "cli/console.h"
#include "cli/help/usage.h"
#include "cli/options.h"
#include "cli/terminal.h"

namespace slamdb::cli {
namespace {

struct HelpOptions {
  std::vector<std::string> verbs;
};

// The verb of these names, from the program on. Ends with exit code 2 where there is none.
const CLI::App& FindVerb(const CLI::App& program, const std::vector<std::string>& names) {
  const CLI::App* found = &program;
  for (const std::string& name : names) {
    std::vector<std::string> known;
    const CLI::App* next = nullptr;
    for (const CLI::App* verb : VerbsOf(*found, /*hidden=*/true)) {
      known.push_back(verb->get_name());
      if (verb->get_name() == name) next = verb;
    }
    if (next == nullptr && found == &program)
      throw WrongUsage(ProblemOfVerb(program, std::array{name, std::string("--help")}));
    if (next == nullptr)
      throw WrongUsage({"unknown verb '" + name + "'" + MeantInstead(name, known), FullName(*found) + " --help"});
    found = next;
  }
  return *found;
}

Run AddHelp(CLI::App& verb) {
  const auto options = std::make_shared<HelpOptions>();
  verb.add_option("VERB", options->verbs, "The verb, and the verb of a verb; without it what verbs there are")
      ->type_name("VERB");
  const CLI::App* program = verb.get_parent();
  return [options, program](Console& console) {
    const bool colour = UsesColour(STDOUT_FILENO, console.colour_choice());
    console.PrintData(HelpText(FindVerb(*program, options->verbs), {true, PageWidth(STDOUT_FILENO), colour}));
    return ExitCode::kDone;
  };
}

constexpr Example kExamples[] = {
    {"slamdb help", "Every verb, in groups, with what it does."},
    {"slamdb help check", "All about one, as 'slamdb check --help'; -h is a screen of it."},
    {"slamdb help vocabulary set", "The same of a verb of a verb."},
};

}  // namespace

const Command kHelp = {
    .name = "help",
    .summary = "tell what verbs there are, and all about one",
    .description =
        "Tells what verbs there are, or all about one of them: options, exit codes and examples. 'slamdb "
        "VERB -h' is the same on one screen, and 'man slamdb-VERB' a manual page.",
    .failed = "Standard output could not be written.",
    .examples = kExamples,
    .add = AddHelp,
};

}  // namespace slamdb::cli
