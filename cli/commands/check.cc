// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/check.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include "cli/batch.h"
#include "cli/check_options.h"
#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/many.h"
#include "cli/options.h"
#include "cli/report/layout.h"
#include "cli/report/paint.h"
#include "cli/words.h"
#include "slamdb/base/atomic_file.h"
#include "slamdb/base/detail/server.h"
#include "slamdb/base/detail/visible.h"
#include "slamdb/checks/report.h"
#include "slamdb/formats/dbow2/vocabulary.h"
#include "slamdb/formats/formats.h"
#include "slamdb/version.h"

namespace slamdb::cli {
namespace {

constexpr std::size_t kKeptFindings = 100;  // of each rule in reports for programs

struct CheckVerbOptions {
  ManyOptions many;
  OutputOptions output;
  std::string format = "text", vocabulary, journal;
  bool json = false, list = false;
  CheckOptions check;
  std::optional<std::size_t> max_findings;
  std::vector<double> limits;  // one for each gate; NaN: not asked for
  double wait = kUsualWait;
};

CheckOptions CheckOptionsOf(const CheckVerbOptions& options) {
  CheckOptions check = options.check;
  check.max_findings = options.max_findings.value_or(kKeptFindings);
  check.gates = GatesOf(options.limits);
  return check;
}

std::unique_ptr<CheckReporter> MakeReporter(CheckReporter::Sink sink, const CheckVerbOptions& options,
                                            const std::string& format, const Console& console) {
  if (format == "json") return MakeJsonReporter(std::move(sink));
  if (format == "junit") return MakeJUnitReporter(std::move(sink), console.verbose());
  if (format == "sarif") return MakeSarifReporter(std::move(sink), std::string(Version()), console.verbose());
  TextReportOptions text;
  text.shown_per_rule = options.max_findings.value_or(text.shown_per_rule);
  text.show_notes = console.verbose();
  text.only_broken = console.quiet();
  return MakeTextReporter([sink = std::move(sink)](std::string_view piece) { sink(detail::VisibleText(piece)); }, text);
}

// Where the report goes, piece by piece. A file is opened before the work, so that what would fail at the end fails at
// once, and is there when it is whole.
class Output {
 public:
  Output(const OutputOptions& options, Console& console, Painter painter) : console_(console), painter_(painter) {
    if (options.path != "-") file_.emplace(options.path, AtomicFileOptions{.overwrite = options.overwrite});
  }

  void Write(std::string_view text) {
    if (file_)
      file_->Write(text);
    else if (painter_ != nullptr)
      console_.Print(text, painter_);
    else
      console_.PrintData(text);
  }
  void Commit() {
    if (file_) file_->Commit();
  }

 private:
  Console& console_;
  const Painter painter_;
  std::optional<AtomicFile> file_;
};

// The file that a code host knows: without the name of an atlas in a store, links followed, and relative to the working
// folder where it lies below.
std::string FileOfInput(const std::string& input) {
  const std::string path = Location::Parse(input).path;
  if (path == "-") return "standard-input";
  if (detail::IsServer(path)) return path;
  std::error_code ignored;
  const std::filesystem::path whole = std::filesystem::weakly_canonical(path, ignored);
  const std::filesystem::path below = whole.lexically_relative(std::filesystem::current_path(ignored));
  return below.empty() || *below.begin() == ".." ? path : below.string();
}

std::string Catalogue(const std::string& format) {
  if (format == "json") return JsonCatalogue();
  if (format == "markdown") return MarkdownCatalogue();
  if (format == "text") return TextCatalogue();
  RefuseUsage("--list prints text, json or markdown");
}

ExitCode RunCheck(const CheckVerbOptions& options, Console& console) {
  const std::string format = options.json ? "json" : options.format;
  if (options.list) {
    WriteOutput(options.output, Catalogue(format), console);
    return ExitCode::kDone;
  }
  if (options.many.inputs.paths.empty()) throw CLI::RequiredError("FILE");
  if (format == "markdown") RefuseUsage("--format markdown is for --list");
  const std::optional<LoadedVocabulary> vocabulary = LoadGivenVocabulary(options.vocabulary, console);
  const AtlasInputs inputs = FindInputs(options.many, console, options.wait);
  const bool one = inputs.atlases.size() == 1, for_people = format == "text" && options.output.path == "-";
  Output output(options.output, console, format == "text" ? PaintFindings : nullptr);
  const auto reporter = MakeReporter([&](std::string_view text) { output.Write(text); }, options, format, console);
  std::uint64_t unreadable = 0, broken = 0;
  const auto take = [&](Outcome<CheckReport>&& outcome) {
    outcome.error = InCommandWords(outcome.error);
    console.Report(outcome.notices, one ? "" : outcome.path + ": ");
    if (!outcome.ok()) ++unreadable;
    if (!outcome.result.ok()) ++broken;
    if (!outcome.ok() && (!for_people || one)) console.Fail(outcome.error);
    if (!outcome.ok() && for_people && one) return;
    CheckedFile file = CheckedFileOf(outcome);
    file.file = FileOfInput(file.name);
    reporter->Add(file);
  };
  const std::uint64_t known = CheckAtlases(inputs,
                                           {.read = MakeReadOptions(console, options.many.inputs.from, options.wait),
                                            .check = CheckOptionsOf(options),
                                            .vocabulary = vocabulary ? &*vocabulary : nullptr,
                                            .journal = options.journal},
                                           take);
  reporter->End();
  output.Commit();
  if (known > 0)
    console.Note(Grouped(known) + " of " + Grouped(inputs.atlases.size()) +
                 " are as they were when they were checked, and were not read again: " + options.journal);
  if (for_people && !one) FailUnreadable(unreadable, inputs.atlases.size(), console);
  return unreadable + broken > 0 ? ExitCode::kFailed : ExitCode::kDone;
}

Run AddCheck(CLI::App& verb) {
  const auto options = std::make_shared<CheckVerbOptions>();
  AddMany(verb, options->many)->required(false);
  verb.add_flag("--revisions", options->many.revisions, "Of atlases in stores every revision, not only the newest");
  verb.add_option("--format", options->format, "How to report; markdown is the table of --list for pages")
      ->type_name("FORMAT")
      ->check(CLI::IsMember({"text", "json", "junit", "sarif", "markdown"}))
      ->capture_default_str();
  verb.add_flag("--json", options->json, "Print JSON, for programs: the same as --format json");
  AddOutput(verb, options->output);
  verb.add_option("--max-findings", options->max_findings,
                  "Findings to show of each rule; all are counted. By default 5 as text, 100 otherwise")
      ->type_name("N");
  verb.add_option("--vocabulary", options->vocabulary,
                  "The vocabulary file that the atlas was made with: its words are checked against it; an atlas of "
                  "another vocabulary is refused")
      ->type_name("FILE");
  Mark(verb.add_option("--journal", options->journal,
                       "Keep what is found in this file as it comes: the same command goes on there when it was "
                       "interrupted, and reads no atlas again that is as it was"),
       Writes::kFile)
      ->type_name("FILE");
  verb.add_flag("--list", options->list, "List the rules with their severity, and check nothing");
  AddWait(verb, options->wait);
  AddRules(verb, options->check);
  AddGates(verb, options->limits);
  return [options](Console& console) { return RunCheck(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb check maps", "Every atlas in a folder, or in a store, and one summary; -r for folders in it."},
    {"slamdb check lab.osa --format sarif -o lab.sarif",
     "For a code host that shows findings; junit is for CI servers."},
    {"slamdb check lab.osa -v", "With notes, which are only counted otherwise; in reports of all formats."},
    {"slamdb check lab.osa --strict --min-keyframes 100 --max-reprojection-px 1.5", "A gate for a pipeline."},
    {"slamdb check lab.osa --ignore map-not-empty --warn point-bad", "With severities of your own."},
};

}  // namespace

const Command kCheck = {
    .name = "check",
    .summary = "check the integrity of atlases",
    .group = Group::kCheck,
    .description =
        R"(Holds every rule of a sound atlas against the inputs and tells what breaks them, where, and what ORB-SLAM3 does then. Errors
crash a SLAM system or make it misbehave; warnings are unusual but usable; notes are normal in healthy files, and only
counted unless -v asks for them. An atlas without errors is sound. A file that cannot be read is a result like others, and
does not stop them. --list shows the rules.)",
    .done = "No errors were found.",
    .failed = "Errors were found, or an input could not be read.",
    .examples = kExamples,
    .add = AddCheck,
};

}  // namespace slamdb::cli
