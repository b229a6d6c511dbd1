// SPDX-License-Identifier: BSD-3-Clause
#include "cli/help/help.h"

#include <algorithm>
#include <numeric>

#include "cli/help/tree.h"
#include "cli/report/layout.h"

namespace slamdb::cli {
namespace {

constexpr std::size_t kTextColumn = 26;  // where descriptions of options start

// A heading with its description beside it, or below where it is too long.
std::string Described(const std::string& heading, std::string_view description, std::size_t column = kTextColumn) {
  std::string text = Wrapped(description, column);
  if (heading.size() + 4 > column || text.empty()) return "  " + heading + "\n" + text;
  text.replace(0, heading.size() + 2, "  " + heading);
  return text;
}

std::string DescriptionOf(const OptionEntry& entry) {
  std::string text = entry.description;
  if (!entry.choices.empty()) {
    text += ": ";
    for (const std::string& choice : entry.choices) text += (&choice == entry.choices.data() ? "" : ", ") + choice;
  }
  if (!entry.default_text.empty()) text += " [" + entry.default_text + "]";
  return text;
}

std::string OptionsText(const CLI::App& app) {
  std::string text, heading;
  for (const OptionEntry& entry : OptionsOf(app)) {
    const std::string group = entry.positional() ? "Arguments" : entry.group;
    if (group != heading) text += "\n" + group + ":\n";
    heading = group;
    text += Described(entry.Heading(), DescriptionOf(entry));
  }
  return text;
}

std::string VerbsText(const CLI::App& app) {
  std::string text;
  for (const CLI::App* verb : VerbsOf(app))
    text += (text.empty() ? "\nVerbs:\n" : "") + Described(verb->get_name(), verb->get_description());
  return text;
}

std::string ExitCodesText(const Command& command) {
  std::string text = "\nExit codes:\n";
  for (const auto& [code, meaning] : ExitCodesOf(command))
    text += Described(std::to_string(static_cast<int>(code)), meaning, 5);
  return text;
}

std::string ExamplesText(const Command& command) {
  std::string text = "\nExamples:\n";
  for (const Example& example : command.examples)
    text += "  $ " + std::string(example.command) + "\n" + Wrapped(example.meaning, 6);
  return text;
}

}  // namespace

std::string HelpText(const CLI::App& app) {
  const Command* command = CommandOf(app);
  std::string text = FullName(app) + " - " + app.get_description() + "\n\nUsage: " + Synopsis(app) + "\n";
  if (command != nullptr) text += "\n" + Wrapped(command->description);
  text += VerbsText(app) + OptionsText(app);
  if (command == nullptr) return text + "\n'slamdb VERB --help' tells more about a verb.\n";
  return text + ExitCodesText(*command) + ExamplesText(*command);
}

const Command* CommandOf(const CLI::App& app) {
  const CLI::App* parent = app.get_parent();
  if (parent == nullptr) return nullptr;
  return parent->get_parent() == nullptr ? FindCommand(app.get_name()) : CommandOf(*parent);
}

std::vector<std::pair<ExitCode, std::string_view>> ExitCodesOf(const Command& command) {
  std::vector<std::pair<ExitCode, std::string_view>> codes = {
      {ExitCode::kDone, command.done},
      {ExitCode::kFailed, command.failed},
      {ExitCode::kUsage, command.trouble.empty() ? "The command line was wrong." : command.trouble},
  };
  if (!command.lossy.empty()) codes.emplace_back(ExitCode::kLossy, command.lossy);
  return codes;
}

namespace {

// Edits that turn one word into the other: insert, delete, replace (Levenshtein).
std::size_t EditDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string DidYouMean(std::string_view word, const std::vector<std::string>& known) {
  std::string best;
  std::size_t least = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const std::string& candidate : known) {
    const std::size_t distance = candidate.size() > word.size() && word.size() >= 3 && candidate.starts_with(word)
                                     ? 1
                                     : EditDistance(word, candidate);
    if (distance < least) {
      least = distance;
      best = candidate;
    }
  }
  return best;
}

}  // namespace slamdb::cli
