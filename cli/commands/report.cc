// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <set>

#include "cli/batch.h"
#include "cli/check_options.h"
#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/exports.h"
#include "cli/many.h"
#include "cli/options.h"
#include "cli/words.h"
#include "slamdb/base/atomic_file.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/visible.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/sqlite/store.h"
#include "slamdb/many/names.h"
#include "slamdb/report/pages.h"

namespace slamdb::cli {
namespace {

namespace fs = std::filesystem;

struct ReportVerbOptions {
  ManyOptions many;
  std::string output;
  bool overwrite = false, json = false;
  CheckOptions check;
  std::vector<double> limits;
};

bool IsFolder(const std::string& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

// One atlas that was named itself has one page, and needs no folder.
bool IsOnePage(const std::vector<std::string>& named, const AtlasInputs& found) {
  return named.size() == 1 && !IsFolder(named.front()) && found.atlases.size() == 1 &&
         found.atlases.front().location.ToString() == named.front();
}

AtlasInputs AtlasesOf(const ManyOptions& many, Console& console) {
  AtlasInputs found = FindInputs(many, console);
  if (found.atlases.empty())
    throw Error(ErrorKind::kNotFound, many.inputs.paths.front(), "", "there is no atlas to report on");
  return found;
}

std::string Lower(std::string text) {
  for (char& letter : text) letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  return text;
}

// A name of a file out of any name; no two are the same, where capitals do not count either.
std::string PageOf(const Location& location, std::set<std::string>& taken) {
  std::string stem = NameOf(location);
  for (char& letter : stem)
    if (std::isalnum(static_cast<unsigned char>(letter)) == 0 && letter != '-' && letter != '_') letter = '_';
  constexpr std::size_t kMost = 100;
  stem = stem.substr(0, kMost);
  if (stem.empty() || Lower(stem) == "index") stem += "_";
  std::string page = stem + ".html";
  for (int again = 2; !taken.insert(Lower(page)).second; ++again) page = detail::Concat(stem, "-", again, ".html");
  return page;
}

void WritePage(const std::string& path, const std::string& page, bool overwrite) {
  RefuseAtlas(path);
  AtomicFile file(path, {.overwrite = overwrite});
  file.Write(page);
  file.Commit();
}

void MakeFolder(const std::string& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw Error(ErrorKind::kPermission, folder, "", "cannot be made: " + error.message());
}

// By the name of each input: of a file its size, of an atlas in a store about what it takes there.
std::map<std::string, std::uint64_t> SizesOf(const std::vector<AtlasInput>& inputs) {
  std::map<std::string, std::uint64_t> sizes;
  std::set<std::string> stores;
  for (const AtlasInput& input : inputs) {
    const Location& location = input.location;
    std::error_code error;
    const std::uint64_t bytes = fs::file_size(location.path, error);
    if (location.name.empty() && !error) sizes[location.ToString()] = bytes;
    if (location.name.empty() || !HoldsNamedAtlases(location.path) || !stores.insert(location.path).second) continue;
    try {
      for (const StoredAtlas& atlas : Store::Open(location.path).List())
        sizes[Location(location.path, atlas.name).ToString()] = atlas.bytes;
    } catch (const Error&) {  // which reading will tell
    }
  }
  return sizes;
}

class Reporting {
 public:
  Reporting(const ReportVerbOptions& options, Console& console)
      : options_(options),
        console_(console),
        inputs_(AtlasesOf(options.many, console)),
        one_(IsOnePage(options.many.inputs.paths, inputs_)),
        sizes_(SizesOf(inputs_.atlases)) {
    if (!one_) {
      std::set<std::string> taken;
      for (const AtlasInput& atlas : inputs_.atlases) pages_[atlas.location.ToString()] = PageOf(atlas.location, taken);
      MakeFolder(options.output);
    }
  }

  // Pages are written as soon as they are there, and only what the index needs is kept.
  ExitCode Run() {
    const auto outcomes = ForEachInput<AtlasReport>(inputs_.atlases, options_.many.inputs.from, console_,
                                                    [&](const std::string& path, const ReadOptions& read,
                                                        Notices& notices) { return Report(path, read, notices); });
    ExitCode code = ReportOutcomes(outcomes, console_);
    std::vector<AtlasReport> reports;
    for (const auto& outcome : outcomes) reports.push_back(outcome.ok() ? outcome.result : Failed(outcome));
    for (const AtlasReport& report : reports)
      if (!report.checked.failure.empty() || !report.checked.report.ok()) code = ExitCode::kFailed;
    if (!one_)
      WritePage((fs::path(options_.output) / "index.html").string(), ReportIndex(reports, Title()), options_.overwrite);
    Tell(reports);
    return code;
  }

 private:
  std::string PathOf(const std::string& atlas) const {
    return one_ ? options_.output : (fs::path(options_.output) / pages_.at(atlas)).string();
  }

  AtlasReport Report(const std::string& path, const ReadOptions& read, Notices& notices) const {
    ReadOptions whole = read;
    whole.needs = Content::kObservations | Content::kLandmarks;
    const Atlas atlas = ReadAtlas(path, whole, &notices);
    CheckOptions check = options_.check;
    check.gates = GatesOf(options_.limits);
    check.threads = read.threads;
    AtlasReport report = ReportOn(atlas, path, check);
    if (const auto size = sizes_.find(path); size != sizes_.end()) report.bytes = size->second;
    report.page = one_ ? std::string() : pages_.at(path);
    WritePage(PathOf(path), ReportPage(atlas, report, {.threads = read.threads, .wording = InCommandWords}),
              options_.overwrite);
    return report;
  }

  AtlasReport Failed(const Outcome<AtlasReport>& outcome) const {
    AtlasReport report;
    report.checked.name = outcome.path;
    report.checked.failure = outcome.error;
    return report;
  }

  std::string Title() const {
    const std::vector<std::string>& named = options_.many.inputs.paths;
    if (named.size() > 1) return detail::Counted(named.size(), "input");
    std::error_code ignored;  // `.` and `maps/` are called as their folder is
    const fs::path name = IsFolder(named.front()) ? fs::canonical(named.front(), ignored).filename() : fs::path();
    return name.empty() ? named.front() : name.string();
  }

  void Tell(const std::vector<AtlasReport>& reports) const {
    if (options_.json) {
      console_.PrintData(InCommandWords(ToJson(reports, options_.output)));
      return;
    }
    for (const AtlasReport& report : reports)
      console_.Print(detail::Visible(report.checked.name + ": " + Verdict(report.checked)) + "\n");
    const bool written = !one_ || reports.front().checked.failure.empty();
    if (written && options_.output != "-")
      console_.PrintWritten(one_ ? options_.output : (fs::path(options_.output) / "index.html").string(), {});
  }

  const ReportVerbOptions& options_;
  Console& console_;
  AtlasInputs inputs_;
  bool one_;
  std::map<std::string, std::uint64_t> sizes_;
  std::map<std::string, std::string> pages_;
};

ExitCode RunReport(const ReportVerbOptions& options, Console& console) {
  if (options.output == "-") RefuseUsage("a report goes to a file or a folder; name it with -o/--output");
  return Reporting(options, console).Run();
}

Run AddReport(CLI::App& verb) {
  const auto options = std::make_shared<ReportVerbOptions>();
  AddMany(verb, options->many);
  Mark(verb.add_option("-o,--output", options->output,
                       "Write to this file; of a folder, a store or several atlases a folder, which is made"),
       Writes::kPattern)
      ->type_name("FILE")
      ->required();
  verb.add_flag("-O,--overwrite", options->overwrite, "Replace pages that are there");
  AddJson(verb, options->json);
  AddRules(verb, options->check);
  AddGates(verb, options->limits);
  return [options](Console& console) { return RunReport(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb report lab.osa -o lab.html", "One page: numbers, plots, findings, gates."},
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
