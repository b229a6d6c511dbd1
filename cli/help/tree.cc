// SPDX-License-Identifier: BSD-3-Clause
#include "cli/help/tree.h"

#include <algorithm>

namespace slamdb::cli {
namespace {

// CLI11 tells a set of values as `NAME:{a,b}` or `{a,b}`. Other checks have no description, so a colon may be the
// name's.
void ReadTypeName(const std::string& type, OptionEntry& entry) {
  entry.value = type.substr(0, type.find(":{"));
  const std::size_t open = type.find('{'), close = type.rfind('}');
  if (open == std::string::npos || close == std::string::npos) return;
  if (open == 0) entry.value.clear();
  std::string list = type.substr(open + 1, close - open - 1) + ",";
  for (std::size_t comma = 0; (comma = list.find(',')) != std::string::npos; list.erase(0, comma + 1))
    entry.choices.push_back(list.substr(0, comma));
}

OptionEntry EntryOf(const CLI::Option& option) {
  OptionEntry entry;
  for (const std::string& name : option.get_snames()) entry.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) entry.names.push_back("--" + name);
  const bool takes_value = option.get_items_expected_max() > 0;
  if (takes_value) ReadTypeName(option.get_type_name(), entry);
  if (entry.positional()) entry.value = option.get_name(true);
  entry.description = option.get_description();
  entry.default_text = takes_value ? option.get_default_str() : std::string();
  entry.group = option.get_group();
  entry.required = option.get_required();
  entry.repeated = option.get_items_expected_max() > 1;
  return entry;
}

}  // namespace

std::string OptionEntry::Heading() const {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  if (!value.empty()) text += (text.empty() ? "" : " ") + value;
  if (positional() && repeated) text += "...";
  return text;
}

std::vector<OptionEntry> OptionsOf(const CLI::App& app) {
  std::vector<OptionEntry> entries;
  for (const CLI::Option* option : app.get_options())
    if (!option->get_group().empty()) entries.push_back(EntryOf(*option));
  std::vector<std::string> groups;
  for (const OptionEntry& entry : entries)
    if (std::find(groups.begin(), groups.end(), entry.group) == groups.end()) groups.push_back(entry.group);
  // Help comes first in CLI11's list, but what every verb has belongs to the end.
  const auto place = [&](const OptionEntry& entry) {
    if (entry.positional()) return std::ptrdiff_t{-1};
    if (entry.group == kCommonGroup) return std::ptrdiff_t{1000};
    return std::find(groups.begin(), groups.end(), entry.group) - groups.begin();
  };
  std::stable_sort(entries.begin(), entries.end(),
                   [&](const OptionEntry& a, const OptionEntry& b) { return place(a) < place(b); });
  return entries;
}

std::vector<const CLI::App*> VerbsOf(const CLI::App& app, bool hidden) {
  std::vector<const CLI::App*> verbs;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; }))
    if (hidden || !verb->get_group().empty()) verbs.push_back(verb);
  return verbs;
}

std::string FullName(const CLI::App& app) {
  return app.get_parent() == nullptr ? app.get_name() : FullName(*app.get_parent()) + " " + app.get_name();
}

std::string Synopsis(const CLI::App& app) {
  std::string text = FullName(app);
  if (!VerbsOf(app).empty()) return text + " VERB [OPTION...]";
  text += " [OPTION...]";
  for (const OptionEntry& entry : OptionsOf(app)) {
    if (!entry.positional() && entry.required) text += " " + entry.names.back() + " " + entry.value;
    if (entry.positional()) text += entry.required ? " " + entry.Heading() : " [" + entry.Heading() + "]";
  }
  return text;
}

}  // namespace slamdb::cli
