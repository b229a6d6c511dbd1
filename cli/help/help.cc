// SPDX-License-Identifier: BSD-3-Clause
#include "cli/help/help.h"

#include <algorithm>

#include "cli/help/tree.h"
#include "cli/report/paint.h"

namespace slamdb::cli {
namespace {

constexpr std::size_t kTextColumn = 26;  // where descriptions of options start
constexpr std::size_t kVerbColumn = 19;  // and those of verbs
constexpr std::size_t kFewChoices = 6;   // which the short help lists

std::string Heading(std::string title, const HelpStyle& style) {
  if (!title.empty()) title[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(title[0])));
  title += ":";
  return (style.whole ? "\n" : "") + (style.colour ? Painted(title, Colour::kBold) : title) + "\n";
}

// A heading with its description beside it, or below where it is too long.
std::string Described(const std::string& heading, std::string_view description, const HelpStyle& style,
                      std::size_t column = kTextColumn) {
  std::string text = Wrapped(description, column, style.width);
  if (heading.size() + 4 > column || text.empty()) return "  " + heading + "\n" + text;
  text.replace(0, heading.size() + 2, "  " + heading);
  return text;
}

// What a description says before it explains: up to `;`, `:` or the end of its first sentence.
std::string FirstClause(const std::string& text) {
  constexpr std::size_t kLeast = 12;  // `Where to:` says too little
  std::size_t end = text.size();
  for (const std::string_view mark : {"; ", ": ", ". "}) end = std::min(end, text.find(mark, kLeast));
  return text.substr(0, end);
}

std::string DescriptionOf(const OptionEntry& entry, const HelpStyle& style) {
  std::string text = style.whole ? entry.description : FirstClause(entry.description);
  if (!entry.choices.empty() && (style.whole || entry.choices.size() <= kFewChoices)) {
    text += ": ";
    for (const std::string& choice : entry.choices) text += (&choice == entry.choices.data() ? "" : ", ") + choice;
  }
  if (!entry.default_text.empty()) text += " [" + entry.default_text + "]";
  return text;
}

// `Every verb: -h -q -v --threads N`, which are the same everywhere.
std::string CommonText(const std::vector<OptionEntry>& entries, const HelpStyle& style) {
  std::string names;
  for (const OptionEntry& entry : entries)
    if (entry.group == kCommonGroup)
      names += (names.empty() ? "" : "  ") + entry.names.front() + (entry.value.empty() ? "" : " " + entry.value);
  return names.empty() ? std::string() : Heading(kCommonGroup, style) + Wrapped(names, 2, style.width);
}

std::string OptionsText(const CLI::App& app, const HelpStyle& style) {
  std::string text, heading;
  const std::vector<OptionEntry> entries = OptionsOf(app);
  for (const OptionEntry& entry : entries) {
    const std::string group = entry.positional() ? "Arguments" : entry.group;
    if (!style.whole && group == kCommonGroup) continue;
    if (group != heading) text += Heading(group, style);
    heading = group;
    text += Described(entry.Heading(), DescriptionOf(entry, style), style);
  }
  return style.whole ? text : text + CommonText(entries, style);
}

// The verbs of a verb, each with what it does.
std::string InnerVerbsText(const CLI::App& app, const HelpStyle& style) {
  std::string text;
  for (const CLI::App* verb : VerbsOf(app))
    text += (text.empty() ? Heading("verbs", style) : "") +
            Described(verb->get_name(), verb->get_description(), style, kVerbColumn);
  return text;
}

// The verbs of the program in their groups: each with what it does, or the names alone.
std::string GroupedVerbsText(const CLI::App& program, const HelpStyle& style) {
  std::string text;
  for (int i = 0; i <= static_cast<int>(Group::kOther); ++i) {
    const auto group = static_cast<Group>(i);
    std::string verbs, names;
    for (const CLI::App* verb : VerbsOf(program)) {
      const Command* command = FindCommand(verb->get_name());
      if (command == nullptr || command->group != group) continue;
      verbs += Described(verb->get_name(), verb->get_description(), style, kVerbColumn);
      names += (names.empty() ? "" : "  ") + verb->get_name();
    }
    const std::string title(TitleOf(group));
    if (names.empty()) continue;
    text += style.whole ? Heading(title, style) + verbs : Described(title, names, style, kVerbColumn);
  }
  return style.whole ? text : "\n" + text;
}

std::string ExitCodesText(const Command& command, const HelpStyle& style) {
  std::string text = Heading("exit codes", style);
  for (const auto& [code, meaning] : ExitCodesOf(command))
    text += Described(std::to_string(static_cast<int>(code)), meaning, style, 5);
  return text;
}

std::string ExamplesText(const Command& command, const HelpStyle& style) {
  constexpr std::size_t kFew = 2;
  const std::size_t shown = style.whole ? command.examples.size() : std::min(kFew, command.examples.size());
  std::string text = Heading("examples", style);
  for (const Example& example : command.examples.first(shown)) {
    text += "  $ " + std::string(example.command) + "\n";
    if (style.whole) text += Wrapped(example.meaning, 6, style.width);
  }
  return text;
}

std::string UsageText(const CLI::App& app, const HelpStyle& style) {
  const bool is_program = app.get_parent() == nullptr;
  const std::string usage = "Usage: ", indent(usage.size(), ' ');
  std::string text = Wrapped(Synopsis(app), usage.size(), style.width);
  text.replace(0, usage.size(), usage);
  return is_program ? text + indent + "slamdb ATLAS\n" : text;
}

std::string ProgramHelp(const CLI::App& program, const HelpStyle& style) {
  return GroupedVerbsText(program, style) + (style.whole ? OptionsText(program, style) : std::string()) + "\n" +
         Wrapped("'slamdb VERB -h' tells the options of a verb on a screen, 'slamdb help VERB' all about it" +
                     std::string(style.whole ? ".\n" : ", 'slamdb --help' what each verb does.\n"),
                 0, style.width);
}

}  // namespace

std::string HelpText(const CLI::App& app, const HelpStyle& style) {
  const Command* command = CommandOf(app);
  std::string text = FullName(app) + " - " + app.get_description() + "\n\n" + UsageText(app, style);
  if (command == nullptr) return text + ProgramHelp(app, style);
  if (style.whole) text += "\n" + Wrapped(command->description, 0, style.width);
  text += (style.whole ? "" : "\n") + InnerVerbsText(app, style) + OptionsText(app, style);
  if (style.whole) return text + ExitCodesText(*command, style) + ExamplesText(*command, style);
  return text + ExamplesText(*command, style) + "\n'" + FullName(app) + " --help' tells more.\n";
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

}  // namespace slamdb::cli
