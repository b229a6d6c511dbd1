// SPDX-License-Identifier: BSD-3-Clause
//
// Completion scripts, made by walking the tree of verbs and options that CLI11 parses with.
#include <algorithm>
#include <memory>

#include "cli/commands/commands.h"
#include "cli/console.h"
#include "cli/help/tree.h"
#include "slamdb/checks/check.h"
#include "slamdb/formats/orbslam3/boost_versions.h"
#include "slamdb/many/list.h"

namespace slamdb::cli {
namespace {

struct CompletionOptions {
  std::string shell;
};

std::string Joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

// 'text' as one word of every shell: in single quotes.
std::string Quoted(std::string_view text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

// "" for the program, "vocabulary show" for a verb of a verb.
std::string PathOf(const CLI::App& app) {
  const std::string name = FullName(app);
  const std::size_t space = name.find(' ');
  return space == std::string::npos ? std::string() : name.substr(space + 1);
}

// The values that an option or argument takes, if only these: also rules and verbs, whose names are data.
std::vector<std::string> ChoicesOf(const OptionEntry& entry, const CLI::App& app) {
  std::vector<std::string> choices = entry.choices;
  if (entry.value == "RULE")
    for (const Rule& rule : ReadRules()) choices.emplace_back(rule.id);
  if (entry.value.find("COLUMN") != std::string::npos)
    for (const ListKey key : ListKeys()) choices.emplace_back(NameOf(key));
  if (entry.value == "BOOST")
    for (const std::string& name : NamesOfSystems()) choices.push_back(name);
  const CLI::App* program = &app;
  while (program->get_parent() != nullptr) program = program->get_parent();
  if (entry.value == "VERB")
    for (const CLI::App* verb : VerbsOf(*program)) choices.push_back(verb->get_name());
  return choices;
}

// Whether files are offered for its value: for options that say so, and for arguments, which mostly are files.
bool OffersFiles(const OptionEntry& entry) {
  constexpr std::string_view kFiles[] = {"FILE", "FOLDER", "INPUT", "TRANSFORM"};
  return entry.positional() || std::ranges::any_of(kFiles, [&](std::string_view word) {
           return entry.value.find(word) != std::string::npos;
         });
}

// Whether arguments are names of entities in the atlas before them.
bool TakesEntities(const CLI::App& app) {
  const auto entries = OptionsOf(app);
  return std::ranges::any_of(entries, [](const OptionEntry& entry) { return entry.value == "ENTITY"; });
}

// Whether arguments are more than words of a list.
bool TakesFiles(const CLI::App& app) {
  const auto entries = OptionsOf(app);
  return std::ranges::any_of(entries, [&](const OptionEntry& entry) {
    return entry.positional() && entry.value != "ENTITY" && ChoicesOf(entry, app).empty();
  });
}

// The program, its verbs and theirs.
void Collect(const CLI::App& app, std::vector<const CLI::App*>& apps) {
  apps.push_back(&app);
  for (const CLI::App* verb : VerbsOf(app)) Collect(*verb, apps);
}

// ---- bash

std::string BashCase(const CLI::App& app) {
  std::vector<std::string> verbs, names;
  std::string values, arguments;
  for (const CLI::App* verb : VerbsOf(app)) verbs.push_back(verb->get_name());
  for (const OptionEntry& entry : OptionsOf(app)) {
    names.insert(names.end(), entry.names.begin(), entry.names.end());
    if (entry.positional()) {
      arguments += (arguments.empty() ? "" : " ") + Joined(ChoicesOf(entry, app));
    } else if (!entry.value.empty()) {
      std::string pattern;
      for (const std::string& name : entry.names) pattern += (pattern.empty() ? "" : "|") + name;
      const std::string choices = Joined(ChoicesOf(entry, app));
      const std::string offer = !choices.empty()     ? "words=" + Quoted(choices) + "; "
                                : OffersFiles(entry) ? "files=1; "
                                                     : "";
      values += "        " + pattern + ") " + offer + "return ;;\n";
    }
  }
  std::string text = "    " + Quoted(PathOf(app)) + ")\n";
  if (!values.empty()) text += "      case \"$previous\" in\n" + values + "      esac\n";
  text += "      options=" + Quoted(Joined(names)) + "\n";
  if (!verbs.empty()) return text + "      words=" + Quoted(Joined(verbs)) + "\n      ;;\n";
  if (!arguments.empty()) text += "      words=" + Quoted(arguments) + "\n";
  if (TakesEntities(app)) text += "      entities=1\n";
  return text + (TakesFiles(app) ? "      files=1\n" : "") + "      ;;\n";
}

std::string BashScript(const CLI::App& program) {
  std::vector<const CLI::App*> apps;
  Collect(program, apps);
  std::string cases, paths;
  for (const CLI::App* app : apps) {
    cases += BashCase(*app);
    if (app != &program) paths += (paths.empty() ? "" : "|") + Quoted(PathOf(*app));
  }
  return R"(# bash completion for slamdb; source it, or install it as completions/slamdb
_slamdb_choose() {
  case "$verb" in
)" + cases +
         R"(  esac
}

_slamdb() {
  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]}
  if [[ $previous == '=' ]]; then previous=${COMP_WORDS[COMP_CWORD-2]}; fi
  if [[ $current == '=' ]]; then current=''; fi
  local verb='' word index words='' options='' files='' entities='' atlas=''
  local -a names=()
  for ((index = 1; index < COMP_CWORD; index++)); do
    word=${COMP_WORDS[index]}
    case "${verb:+$verb }$word" in
      )" +
         paths + R"() verb=${verb:+$verb }$word ;;
      *) if [[ -n $verb && -z $atlas && $word != -* ]]; then atlas=$word; fi ;;
    esac
  done
  _slamdb_choose
  if [[ $current == -* ]]; then
    words=$options; files=''
  elif [[ -n $entities && -n $atlas ]]; then
    mapfile -t names < <("${COMP_WORDS[0]}" complete "$atlas" "$current" 2>/dev/null); files=''
    if [[ $current != */* ]]; then compopt -o nospace; fi
  elif [[ $current == *'#'* ]]; then
    mapfile -t names < <("${COMP_WORDS[0]}" complete "$current" 2>/dev/null); files=''
  fi
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
  for word in "${names[@]}"; do  # out of files: never expanded, and quoted
    if [[ $word != "$current"* ]]; then continue; fi
    printf -v word %q "$word"
    COMPREPLY+=("$word")
  done
  if [[ -n $files ]]; then
    compopt -o filenames
    mapfile -t -O "${#COMPREPLY[@]}" COMPREPLY < <(compgen -f -- "$current")
  fi
}

complete -F _slamdb slamdb
)";
}

// ---- zsh

// A description inside an _arguments or _describe specification.
std::string ZshEscaped(std::string_view text) {
  std::string out;
  for (const char c : text)
    out += c == ':' || c == '[' || c == ']' || c == '\\' ? std::string("\\") + c : std::string(1, c);
  return out;
}

std::string ZshAction(const OptionEntry& entry, const CLI::App& app) {
  const std::string choices = Joined(ChoicesOf(entry, app));
  return ":" + ZshEscaped(entry.value.empty() ? "value" : entry.value) + ":" +
         (!choices.empty()          ? "(" + choices + ")"
          : entry.value == "ENTITY" ? "_slamdb_entities"
          : OffersFiles(entry)      ? "_slamdb_atlases"
                                    : " ");
}

std::string ZshFunction(const CLI::App& app) {
  std::string name = "_" + FullName(app), text;
  std::replace(name.begin(), name.end(), ' ', '_');
  for (const OptionEntry& entry : OptionsOf(app)) {
    if (entry.positional()) {
      text += " \\\n    " + Quoted((entry.repeated ? "*" : "") + ZshAction(entry, app));
      continue;
    }
    for (const std::string& option : entry.names)
      text += " \\\n    " + Quoted(option + "[" + ZshEscaped(entry.description) + "]" +
                                   (entry.value.empty() ? std::string() : ZshAction(entry, app)));
  }
  const auto verbs = VerbsOf(app);
  if (verbs.empty()) return name + "() {\n  _arguments -s -S" + text + "\n}\n\n";
  std::string list, calls;
  for (const CLI::App* verb : verbs) {
    list += "\n    " + Quoted(verb->get_name() + ":" + ZshEscaped(verb->get_description()));
    calls += "\n        " + verb->get_name() + ") " + name + "_" + verb->get_name() + " ;;";
  }
  return name + "() {\n  local line state\n  local -a verbs\n  verbs=(" + list + "\n  )\n  _arguments -C" + text +
         " \\\n    '1: :->verb' '*::argument:->rest'\n  case $state in\n    verb) _describe verb verbs ;;\n    "
         "rest)\n" +
         "      case $line[1] in" + calls + "\n      esac ;;\n  esac\n}\n\n";
}

std::string ZshScript(const CLI::App& program) {
  std::vector<const CLI::App*> apps;
  Collect(program, apps);
  std::string text = R"zsh(#compdef slamdb

# Files, and the atlases of a store behind its #.
_slamdb_atlases() {
  if [[ $PREFIX == *'#'* ]]; then
    compadd -- ${(f)"$(slamdb complete "${(Q)PREFIX}" 2>/dev/null)"}
  else
    _files
  fi
}

# Of the atlas that was named first.
_slamdb_entities() {
  local -a operands
  operands=(${${words[2,-1]}:#-*})
  compadd -S '' -- ${(f)"$(slamdb complete "${(Q)operands[1]}" "${(Q)PREFIX}" 2>/dev/null)"}
}

)zsh";
  for (const CLI::App* app : apps) text += ZshFunction(*app);
  return text + "if [[ $funcstack[1] == _slamdb ]]; then _slamdb \"$@\"; else compdef _slamdb slamdb; fi\n";
}

// ---- fish

std::string FishCondition(const CLI::App& app) {
  if (app.get_parent() == nullptr) return "__fish_use_subcommand";
  std::string text = "__fish_seen_subcommand_from " + app.get_name();
  if (app.get_parent()->get_parent() != nullptr) return FishCondition(*app.get_parent()) + "; and " + text;
  return text;
}

std::string FishLines(const CLI::App& app) {
  const std::string start = "complete -c slamdb -n " + Quoted(FishCondition(app));
  std::string text;
  for (const CLI::App* verb : VerbsOf(app))
    text += start + " -f -a " + verb->get_name() + " -d " + Quoted(verb->get_description()) + "\n";
  for (const OptionEntry& entry : OptionsOf(app)) {
    if (entry.positional()) {
      const std::string choices = Joined(ChoicesOf(entry, app));
      if (!choices.empty()) text += start + " -f -a " + Quoted(choices) + "\n";
      if (entry.value == "ENTITY") text += start + " -a '(__slamdb_entities)'\n";
      if (entry.value == "FILE" || entry.value == "INPUT") text += start + " -a '(__slamdb_atlases)'\n";
      continue;
    }
    text += start;
    for (const std::string& name : entry.names)
      text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
    const std::string choices = Joined(ChoicesOf(entry, app));
    if (!entry.value.empty())
      text += !choices.empty() ? " -x -a " + Quoted(choices) : OffersFiles(entry) ? " -r" : " -x";
    text += " -d " + Quoted(entry.description) + "\n";
  }
  return text;
}

std::string FishScript(const CLI::App& program) {
  std::vector<const CLI::App*> apps;
  Collect(program, apps);
  std::string text = R"(# fish completion for slamdb
function __slamdb_atlases
    set -l word (commandline -ct)
    string match -q '*#*' -- $word; and slamdb complete $word 2>/dev/null
end
function __slamdb_entities
    set -l words (string match -v -- '-*' (commandline -opc))
    test (count $words) -gt 2; and slamdb complete $words[3] (commandline -ct) 2>/dev/null
end
)";
  for (const CLI::App* app : apps) text += FishLines(*app);
  return text;
}

ExitCode RunCompletion(const CLI::App& program, const CompletionOptions& options, Console& console) {
  if (options.shell == "bash") {
    console.PrintData(BashScript(program));
  } else {
    console.PrintData(options.shell == "zsh" ? ZshScript(program) : FishScript(program));
  }
  return ExitCode::kDone;
}

Run AddCompletion(CLI::App& verb) {
  const auto options = std::make_shared<CompletionOptions>();
  verb.add_option("SHELL", options->shell, "The shell")->required()->check(CLI::IsMember({"bash", "zsh", "fish"}));
  const CLI::App* program = verb.get_parent();
  return [options, program](Console& console) { return RunCompletion(*program, *options, console); };
}

constexpr Example kExamples[] = {
    {"source <(slamdb completion bash)", "Completes verbs, options and formats in this shell from now on."},
    {"slamdb completion zsh > ~/.zfunc/_slamdb", "For a folder that is in zsh's fpath."},
    {"slamdb completion fish > ~/.config/fish/completions/slamdb.fish", "For fish, in every shell."},
};

}  // namespace

const Command kCompletion = {
    .name = "completion",
    .summary = "print a completion script for a shell",
    .description =
        "Prints a script that makes a shell complete the verbs, options and values of slamdb. It is made from "
        "the options as they are parsed. Packages install it already.",
    .failed = "Standard output could not be written.",
    .examples = kExamples,
    .add = AddCompletion,
    .tells_of_all = true,
};

}  // namespace slamdb::cli
