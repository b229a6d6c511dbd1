// SPDX-License-Identifier: BSD-3-Clause
#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <unordered_set>

#include "cli/choices.h"
#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/exports.h"
#include "cli/guard.h"
#include "cli/options.h"
#include "cli/page_server.h"
#include "cli/report/layout.h"
#include "cli/selection.h"
#include "cli/words.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/formats/formats.h"
#include "slamdb/many/names.h"
#include "slamdb/view/page.h"

namespace slamdb::cli {
namespace {

struct ViewVerbOptions {
  InputOptions inputs;
  SelectionOptions selection;
  ViewOptions page;
  std::string output, findings;
  bool overwrite = false, open = false, serve = false, side_by_side = false, no_check = false, json = false;
  std::uint16_t port = 0;
  double wait = kUsualWait;
};

// Where the page goes; empty: nowhere, it is served.
std::string OutputOf(const ViewVerbOptions& options) {
  if (!options.output.empty()) RequirePageName(options.output);
  if (!options.output.empty() || options.serve) return options.output;
  const std::string& first = options.inputs.paths.front();
  const std::string stem = NameOf(Location(first));
  if (first == "-" || stem.empty()) RefuseUsage("nothing names the page: -o/--output does");
  std::string page = stem + ".html";
  GuardDefaultName(page);
  return page;
}

struct ReadInputs {
  std::vector<Atlas> atlases;
  std::vector<ViewInput> inputs;
};

ReadInputs ReadAll(const ViewVerbOptions& options, Console& console, Notices& notices) {
  ReadOptions read = MakeReadOptions(console, options.inputs.from, options.wait);
  read.needs = Content::kPoses | Content::kPoints;
  if (!options.page.check && !options.page.diff) read.features = FeatureColumns::kGeometry;
  ReadInputs result;
  result.atlases.reserve(options.inputs.paths.size());  // inputs refer to them
  for (const std::string& path : options.inputs.paths) {
    read.selection = {};
    read.custom_format = nullptr;
    const HeldSource held = HoldInput(path, read);
    const Format* format = read.format.empty() ? FindFormatOfInput(held) : &FormatById(read.format);
    if (read.format.empty()) read.custom_format = format;  // told once
    read.selection = ParseSelection(options.selection, held, read);
    result.atlases.push_back(ReadPartToShow(path, held, read, notices));  // throws where nothing tells the format
    result.inputs.push_back(ViewInputOf(result.atlases.back(), path, format, InCommandWords));
  }
  return result;
}

std::unordered_set<LandmarkId> LandmarksOf(const Atlas& atlas) {
  std::unordered_set<LandmarkId> ids;
  for (const Map& map : atlas.maps)
    for (const Landmark& landmark : map.landmarks) ids.insert(landmark.id);
  return ids;
}

// What a report found is shown; of another atlas it is told to be.
void TakeFindings(const ViewVerbOptions& options, ViewInput& input, Notices& notices) {
  input.findings = ReadFindings(options.findings, options.inputs.paths.front());
  const AtlasIndex index(*input.atlas);
  const std::unordered_set<LandmarkId> landmarks = LandmarksOf(*input.atlas);
  const auto is_known = [&](const Place& place) {
    return (!place.map || index.MapRow(place.map) != kNoRow) &&
           (!place.keyframe || index.LocateKeyFrame(place.keyframe)) &&
           (!place.point || index.LocatePoint(place.point)) &&
           (!place.camera || index.CameraRow(place.camera) != kNoRow) &&
           (!place.landmark || landmarks.contains(place.landmark));
  };
  std::uint64_t strange = 0, all = 0;
  for (const RuleResult& result : input.findings)
    for (const Finding& finding : result.findings) {
      strange += is_known(finding.place) ? 0 : 1;
      ++all;
    }
  if (strange > 0 && options.selection.everything())
    notices.Warn(Grouped(strange) + " of " + Counted(all, "finding") + " of " + options.findings + " " +
                 (strange == 1 ? "is" : "are") + " of what " + input.name +
                 " does not have: is the report of another atlas?");
}

// Starts a program with one argument, without a shell.
std::optional<pid_t> Start(const std::string& program, const std::string& argument) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_RDWR, 0);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);
  std::string name = program, value = argument;
  char* const words[] = {name.data(), value.data(), nullptr};
  pid_t process = 0;
  const int failure = ::posix_spawnp(&process, name.c_str(), &actions, &attributes, words, environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  return failure == 0 ? std::optional(process) : std::nullopt;
}

// The status it ends with, when it does soon: launchers do, and browsers stay.
std::optional<int> StatusSoon(pid_t process) {
  constexpr int kTries = 50;
  constexpr useconds_t kPause = 20'000;
  for (int i = 0; i < kTries && !Console::interrupted(); ++i) {
    int status = 0;
    if (::waitpid(process, &status, WNOHANG) != 0) return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
    ::usleep(kPause);
  }
  return std::nullopt;
}

// In the browser that $BROWSER names, or else the desktop's.
void OpenInBrowser(const std::string& address, Console& console) {
  std::vector<std::string> programs;
  if (const char* named = std::getenv("BROWSER"); named != nullptr)
    for (const std::string_view name : detail::Split(named, ':'))
      if (!name.empty()) programs.emplace_back(name);
  const std::size_t named_programs = programs.size();
  programs.insert(programs.end(), {"xdg-open", "open"});
  for (std::size_t i = 0; i < programs.size(); ++i) {
    const std::optional<pid_t> process = Start(programs[i], address);
    if (!process) {
      if (i < named_programs) console.Warn(programs[i] + ", which BROWSER names, cannot be run");
      continue;
    }
    console.Note("opening " + address + " with " + programs[i]);
    const int status = StatusSoon(*process).value_or(0);
    if (status == 0) return;
    console.Warn(programs[i] + " ended with status " + std::to_string(status));
  }
  console.Warn("no browser was found that opens it: BROWSER names one; open " + address + " in it");
}

void WritePage(const std::string& output, const ViewPage& page, AtomicFile& file, const ViewVerbOptions& options,
               Console& console) {
  file.Write(page.html);
  file.Commit();
  const ViewReport& report = page.report;
  if (options.json)
    return PrintReport(ToJson(report, options.inputs.paths, output), /*json=*/true, IsStandardOutput(output), console);
  console.PrintWritten(output, {},
                       ": " + Counted(report.maps, "map") + ", " + Counted(report.keyframes, "keyframe") + ", " +
                           Counted(report.points, "point") + "; " + HumanBytes(report.bytes));
}

void Serve(ViewPage page, const ViewVerbOptions& options, Console& console) {
  PageServer server(std::move(page.html), options.port);
  console.Print("serving at " + server.url() + " until Ctrl-C\n");
  std::fflush(stdout);
  if (options.open) OpenInBrowser(server.url(), console);
  server.Run([] { return Console::interrupted(); });
}

ViewOptions PageOptions(const ViewVerbOptions& options, Console& console) {
  ViewOptions page = options.page;
  page.layout = options.side_by_side ? ViewLayout::kSideBySide : ViewLayout::kOverlay;
  page.notes = console.verbose();
  page.threads = console.threads();
  page.progress = console.MakeProgress();
  page.wording = InCommandWords;
  return page;
}

ExitCode RunView(ViewVerbOptions options, Console& console) {
  RequireViewPage();
  if (options.page.diff && options.inputs.paths.size() != 2) RefuseUsage("--diff is of two atlases");
  const bool part = !options.selection.everything();
  if (!options.findings.empty() && options.inputs.paths.size() != 1) RefuseUsage("--findings is of one atlas");
  // What a part leaves out would be found missing.
  options.page.check = !options.no_check && !part && options.findings.empty();
  const std::string output = OutputOf(options);
  std::optional<AtomicFile> file;  // before the work, so that what would fail at the end fails at once
  if (!output.empty()) file.emplace(output, AtomicFileOptions{.overwrite = options.overwrite});
  Notices notices;
  ReadInputs read = ReadAll(options, console, notices);
  if (!options.findings.empty()) TakeFindings(options, read.inputs.front(), notices);
  if (part && !options.no_check && options.findings.empty())
    notices.Note("findings are those of whole atlases, and not in the page of a part");
  ViewPage page = MakeViewPage(read.inputs, PageOptions(options, console));
  for (const std::string& sentence : page.report.left_out) notices.Note("not in the page: " + sentence);
  console.Report(notices);
  if (file) WritePage(output, page, *file, options, console);
  if (options.serve)
    Serve(std::move(page), options, console);
  else if (options.open)
    OpenInBrowser(std::filesystem::absolute(output).string(), console);
  return ExitCode::kDone;
}

void AddPageOptions(CLI::App& verb, ViewVerbOptions& options) {
  constexpr const char* kGroup = "The page";
  CLI::Option* diff =
      verb.add_flag("--diff", options.page.diff, "Of two atlases: what the second added, removed, moved and changed");
  verb.add_flag("--side-by-side", options.side_by_side, "Several atlases beside each other, not over each other")
      ->group(kGroup);
  verb.add_option("--title", options.page.title, "Title of the page; by default the names of the atlases")
      ->type_name("TEXT")
      ->group(kGroup);
  verb.add_option("--keypoints", options.page.keypoints,
                  "Keypoints to put into it; auto: all, or those that see a point, or none, as there is room for")
      ->type_name("WHICH")
      ->transform(OneOf(kViewKeypoints))
      ->default_str("auto")
      ->group(kGroup);
  verb.add_flag("--normals", options.page.normals, "With the normals of points")->group(kGroup);
  CLI::Option* no_check =
      verb.add_flag("--no-check", options.no_check, "Without what 'slamdb check' finds")->group(kGroup);
  verb.add_option("--findings", options.findings,
                  "Show what this report found instead of checking: that of 'slamdb check --json', or the conflicts of "
                  "'slamdb merge --base --json'")
      ->type_name("FILE")
      ->excludes(no_check)
      ->group(kGroup);
  diff->group(kGroup);
}

Run AddView(CLI::App& verb) {
  const auto options = std::make_shared<ViewVerbOptions>();
  AddInputs(verb, options->inputs, AtlasAt("An atlas"));
  Mark(verb.add_option("-o,--output", options->output,
                       "The page; by default the name of the first atlas with .html, in this folder"),
       Writes::kFile)
      ->type_name("FILE");
  verb.add_flag("-O,--overwrite", options->overwrite, "Replace the page if it is there");
  verb.add_flag("--open", options->open, "Open it in the browser, which BROWSER may name");
  CLI::Option* serve = verb.add_flag("--serve", options->serve,
                                     "Serve it to browsers on this machine, and write it only where -o names a file");
  verb.add_option("--port", options->port, "Port to serve it at; by default one that is free")
      ->type_name("N")
      ->check(CLI::Range(0, 65535).description({}))
      ->needs(serve);
  verb.add_flag("--json", options->json, "Print JSON, for programs")->excludes(serve);
  AddWait(verb, options->wait);
  AddPageOptions(verb, *options);
  AddSelection(verb, options->selection);
  return [options](Console& console) { return RunView(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb view lab.osa", "Writes lab.html, one file to look at and to send."},
    {"slamdb view lab.osa -o map.html --title 'The lab in May'", "With a name of your own. --open opens it."},
    {"slamdb view a.osa b.osa --side-by-side -o both.html", "Two maps beside each other."},
    {"slamdb view before.osa after.osa --diff -o diff.html", "What changed, in place."},
    {"slamdb view both.osa --findings merge.json -o both.html", "Conflicts of 'slamdb merge --base --json', in place."},
};

}  // namespace

const Command kView = {
    .name = "view",
    .summary = "write a page that shows atlases in a browser",
    .group = Group::kLook,
    .description =
        R"(Writes one HTML file that shows the maps of one or several atlases in three dimensions: points, keyframes, trajectories and
edges, what 'slamdb check' finds in place, and with --diff what changed. It holds all that it needs, loads nothing from
anywhere, and opens from disk without a network. It holds the map, too: who gets the file has the map.

--serve shows the page at an address of this machine, for a browser that opens no files, and ends with Ctrl-C. What is in
the page, what it leaves out and how large it becomes: docs/view.md.)",
    .failed = "An input could not be read, the page not be written, or slamdb was built without it.",
    .examples = kExamples,
    .add = AddView,
};

}  // namespace slamdb::cli
