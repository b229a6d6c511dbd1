// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/report.h"

#include <memory>

#include "cli/batch.h"
#include "cli/check_options.h"
#include "cli/commands/commands.h"
#include "cli/exports.h"
#include "cli/libraries.h"
#include "cli/many.h"
#include "cli/options.h"
#include "cli/words.h"
#include "slamdb/base/detail/visible.h"
#include "slamdb/many/names.h"

namespace slamdb::cli {
namespace {

struct ReportVerbOptions {
  ManyOptions many;
  std::string output;
  bool overwrite = false, json = false;
  CheckOptions check;
  std::vector<double> limits;
  double wait = kUsualWait;
};

// `lab.html` of lab.osa, and the folder `report` of several.
std::string OutputOf(const ReportVerbOptions& options, bool one_atlas) {
  if (!options.output.empty()) return options.output;
  const std::string& first = options.many.inputs.paths.front();
  if (first == "-") RefuseUsage("nothing names the page: -o/--output does");
  std::string output = one_atlas ? NameOf(Location(first)) + ".html" : "report";
  GuardDefaultName(output);
  return output;
}

void Tell(const Reports& reports, const std::string& output, bool json, Console& console) {
  if (json) return console.PrintData(ReportInCommandWords(ToJson(reports, output)));
  for (const auto& outcome : reports.outcomes)
    console.Print(detail::Visible(outcome.path + ": " + Verdict(outcome.result.checked)) + "\n");
  if (!reports.written.empty()) console.PrintWritten(reports.written, {});
}

ExitCode RunReport(const ReportVerbOptions& options, Console& console) {
  GoOnWithLibraries();
  if (options.output == "-") RefuseUsage("a report goes to a file or a folder; name it with -o/--output");
  const std::vector<std::string>& named = options.many.inputs.paths;
  const AtlasInputs found = FindInputs(options.many, console, options.wait);
  const bool one = IsOneAtlas(named, found);
  ReportOptions report{.read = MakeReadOptions(console, options.many.inputs.from, options.wait),
                       .check = options.check,
                       .wording = InCommandWords,
                       .output = OutputOf(options, one),
                       .overwrite = options.overwrite};
  report.check.gates = GatesOf(options.limits);
  if (const std::string why = WhyNotReportTo(report.output, one); !why.empty()) RefuseUsage(why);
  Reports reports = WriteReports(named, found, report);
  for (auto& outcome : reports.outcomes) outcome.error = InCommandWords(outcome.error);
  ReportOutcomes(reports.outcomes, console);
  Tell(reports, report.output, options.json, console);
  return reports.ok() ? ExitCode::kDone : ExitCode::kFailed;
}

Run AddReport(CLI::App& verb) {
  const auto options = std::make_shared<ReportVerbOptions>();
  AddMany(verb, options->many);
  Mark(verb.add_option("-o,--output", options->output,
                       "The page; of a folder, a store or several atlases the folder of the pages, which is made. By "
                       "default the name of the atlas with .html, or report/"),
       Writes::kPattern)
      ->type_name("FILE");
  verb.add_flag("-O,--overwrite", options->overwrite,
                "Replace pages that are there, and write into a folder that holds other files");
  AddWait(verb, options->wait);
  AddJson(verb, options->json);
  AddRules(verb, options->check);
  AddGates(verb, options->limits);
  return [options](Console& console) { return RunReport(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb report lab.osa", "One page, lab.html: numbers, plots, findings, gates."},
    {"slamdb report maps/ -o report/", "A page for each atlas of a folder, and report/index.html to find them."},
    {"slamdb report lab.db -o report/ -O --min-keyframes 100 --max-reprojection-px 1.5",
     "All of a store, held against gates: what a pipeline keeps."},
};

}  // namespace

const Command kReport = {
    .name = "report",
    .summary = "write pages about atlases: numbers, plots, findings",
    .group = Group::kLook,
    .description =
        R"(Writes a page of HTML for each atlas: its numbers, its plots, what a check finds with what comes of it and what to do, and
the verdict of the gates that are asked for. Of a folder or a store it writes index.html as well: a table with thumbnails
that can be sorted and filtered. Each page is one file that needs no network; names and texts out of maps are text in it.

An atlas that cannot be read is a row with its error, and does not stop the others.)",
    .done = "The report is written, and all atlases are sound.",
    .failed = "Errors were found, a gate was not passed, an input could not be read, or the output not be written.",
    .examples = kExamples,
    .add = AddReport,
};

}  // namespace slamdb::cli
