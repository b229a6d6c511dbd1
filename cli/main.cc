// SPDX-License-Identifier: BSD-3-Clause
//
// The slamdb command: binds the verb of command.cc that was named, parses, runs it, and turns the outcome into an exit
// code. The only place that does.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <map>
#include <new>

#include "cli/command.h"
#include "cli/console.h"
#include "cli/guard.h"
#include "cli/help/help.h"
#include "cli/help/tree.h"
#include "cli/help/usage.h"
#include "cli/libraries.h"
#include "cli/options.h"
#include "cli/terminal.h"
#include "slamdb/base/detail/hidden_passwords.h"
#include "slamdb/base/detail/server.h"
#include "slamdb/base/detail/visible.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/location.h"
#include "slamdb/version.h"

namespace slamdb::cli {
namespace {

class HelpFormatter : public CLI::FormatterBase {
 public:
  std::string make_help(const CLI::App* app, std::string, CLI::AppFormatMode) const override { return HelpText(*app); }
};

// The program as CLI11 sees it, and what to run for each verb.
struct Program {
  CLI::App app{"persistent map database for visual SLAM", "slamdb"};
  std::map<const CLI::App*, Run> runs;
  ConsoleOptions console;
};

// What every verb has, and every verb of a verb.
void AddCommonOptions(CLI::App& verb, ConsoleOptions& console) {
  verb.get_help_ptr()->group(kCommonGroup);
  const auto inner = verb.get_subcommands([](CLI::App*) { return true; });
  if (inner.empty()) AddConsoleOptions(verb, console);
  for (CLI::App* sub : inner) AddCommonOptions(*sub, console);
}

// Every verb by its name alone: binding the options of all takes longer than most verbs do.
void AddVerbs(CLI::App& app) {
  app.formatter(std::make_shared<HelpFormatter>());
  app.set_help_flag("-h,--help", "Print help: -h a screen of it, --help all")->group(kCommonGroup);
  app.set_version_flag("-V,--version", "slamdb " + std::string(Version()), "Print the version")->group(kCommonGroup);
  app.require_subcommand(1);
  for (const Command* command : Commands()) {
    CLI::App* verb = app.add_subcommand(std::string(command->name), std::string(command->summary));
    if (command->hidden) verb->group("");
  }
}

// Binds the options of the verbs that are among the words, or of all where one of them tells of all.
void BindOptions(Program& program, const std::vector<std::string>& words) {
  const auto named = [&](const Command* command) { return std::ranges::count(words, command->name) > 0; };
  const auto commands = Commands();
  const bool all =
      std::ranges::any_of(commands, [&](const Command* each) { return each->tells_of_all && named(each); });
  for (const Command* command : commands) {
    CLI::App* verb = program.app.get_subcommand(std::string(command->name));
    if ((!all && !named(command)) || program.runs.contains(verb)) continue;
    program.runs[verb] = command->add(*verb);
    AddCommonOptions(*verb, program.console);
  }
}

// The innermost verb that was named on the command line.
CLI::App& NamedVerb(CLI::App& app) {
  const auto named = app.get_subcommands();
  return named.empty() ? app : NamedVerb(*named.front());
}

int ReportUsage(const UsageProblem& problem) {
  std::cerr << "slamdb: error: " << detail::VisibleText(problem.problem) << "\nTry: " << detail::Visible(problem.next)
            << "\n";
  return static_cast<int>(ExitCode::kUsage);
}

int ReportUsage(CLI::App& app, const CLI::ParseError& error, const std::vector<std::string>& words) {
  std::vector<std::string> rest = app.remaining(true);
  std::erase(rest, "--");
  return ReportUsage(ProblemOf(NamedVerb(app), error, words, rest));
}

// Of inputs that are not there, where a file beside them has nearly their name.
void TellFilesMeant(CLI::App& verb, Console& console) {
  for (CLI::Option* option : verb.get_options(NamesFiles)) {
    if (MarkOf(*option)) continue;
    for (const std::string& input : option->results())
      if (const std::string meant = FileMeant(input); !meant.empty())
        console.Note(input + " is not there; did you mean '" + meant + "'?");
  }
}

// Runs the named verb. Everything that is thrown ends here.
// Of `URI` and `--option=URI`.
bool NamesServer(const std::string& word) {
  return detail::IsServer(word) || (word.starts_with("--") && detail::IsServer(word.substr(word.find('=') + 1)));
}

int RunVerb(Program& program, const std::vector<std::string>& words) {
  Console console(program.console);
  const CLI::App* verb = program.app.get_subcommands().front();
  Console::CatchSignals();
  try {
    if (std::ranges::any_of(words, NamesServer)) GoOnWithLibraries();
    GuardFiles(NamedVerb(program.app));
    const ExitCode code = program.runs.at(verb)(console);
    if (code == ExitCode::kFailed) TellFilesMeant(NamedVerb(program.app), console);
    console.Finish();
    return static_cast<int>(code);
  } catch (const CLI::ParseError& error) {
    return ReportUsage(program.app, error, words);
  } catch (const WrongUsage& wrong) {
    return ReportUsage(wrong.problem);
  } catch (const std::bad_alloc&) {
    console.Fail("out of memory");
  } catch (const std::exception& error) {
    console.Fail(error.what());
    TellFilesMeant(NamedVerb(program.app), console);
  }
  Console::EndIfInterrupted();
  const Command* command = FindCommand(verb->get_name());
  const bool compares = command != nullptr && !command->trouble.empty();
  return static_cast<int>(compares ? ExitCode::kUsage : ExitCode::kFailed);
}

int PrintHelp(CLI::App& app, bool whole) {
  std::cout << HelpText(NamedVerb(app), {whole, PageWidth(STDOUT_FILENO), UsesColour(STDOUT_FILENO)}) << std::flush;
  return static_cast<int>(std::cout ? ExitCode::kDone : ExitCode::kFailed);
}

// What to do with a first word that is no verb: `slamdb lab.osa` shows what is in it.
enum class FirstWord { kVerb, kAtlas, kUnknown };
FirstWord Judge(const std::vector<std::string>& words) {
  if (words.empty() || words.front().starts_with("-") || FindCommand(words.front()) != nullptr) return FirstWord::kVerb;
  std::error_code ignored;
  const Location named = Location::Parse(words.front());
  const bool there = named.is_server() || std::filesystem::exists(named.path, ignored);
  return there ? FirstWord::kAtlas : FirstWord::kUnknown;
}

// Options that stand before the verb, or before an atlas alone, go behind it: `slamdb --quiet info lab.osa`.
void MoveVerbToFront(const CLI::App& app, std::vector<std::string>& words) {
  const auto is_of_program = [&](const std::string& word) {
    return word == "--" || app.get_option_no_throw(word) != nullptr;  // --help, --version
  };
  if (!words.front().starts_with("-") || is_of_program(words.front())) return;
  auto verb = std::ranges::find_if(words, [](const std::string& word) { return FindCommand(word) != nullptr; });
  if (verb == words.end())
    verb = std::ranges::find_if(words, [](const std::string& word) { return Judge({word}) == FirstWord::kAtlas; });
  if (verb == words.end() || std::any_of(words.begin(), verb, is_of_program)) return;
  auto last = verb + 1;
  if (FindCommand(*verb) != nullptr && last != words.end()) {
    const auto inner = VerbsOf(*app.get_subcommand(*verb));
    if (std::ranges::count(inner, *last, &CLI::App::get_name) > 0) ++last;
  }
  std::rotate(words.begin(), verb, last);
}

int Main(std::vector<std::string> words) {
  for (std::string& word : words) word = detail::HidePassword(std::move(word));  // before anything may tell it
  Program program;
  AddVerbs(program.app);
  BindOptions(program, words);
  if (words.empty()) {
    std::cerr << HelpText(program.app, {false, PageWidth(STDERR_FILENO), UsesColour(STDERR_FILENO)}) << "\n";
    return ReportUsage({"a verb is missing", "slamdb --help"});
  }
  MoveVerbToFront(program.app, words);
  const FirstWord first = Judge(words);
  if (first == FirstWord::kUnknown) return ReportUsage(ProblemOfVerb(program.app, words));
  if (first == FirstWord::kAtlas) BindOptions(program, {*words.insert(words.begin(), "info")});
  try {
    program.app.parse(std::vector<std::string>(words.rbegin(), words.rend()));
  } catch (const CLI::CallForHelp&) {
    return PrintHelp(program.app, std::ranges::find(words, "--help") != words.end());
  } catch (const CLI::CallForVersion& version) {
    std::cout << version.what() << std::endl;
    return static_cast<int>(std::cout ? ExitCode::kDone : ExitCode::kFailed);
  } catch (const CLI::ParseError& error) {
    return ReportUsage(program.app, error, words);
  }
  if (const auto problem = ProblemOfOutput(NamedVerb(program.app), words)) return ReportUsage(*problem);
  return RunVerb(program, words);
}

// Standard streams that were closed (`>&-`) get a descriptor of which reading and writing fails, so that no file that
// is opened later is taken for one of them.
void FillStandardStreams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(stream, F_GETFD) < 0) ::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

}  // namespace
}  // namespace slamdb::cli

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_DFL);  // `slamdb dump | head` ends quietly, whatever the parent process ignores
  slamdb::cli::FillStandardStreams();
  slamdb::cli::RememberWords(argv);
  return slamdb::cli::Main({argv + std::min(argc, 1), argv + argc});
}
