// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <exception>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>

#include "cli/batch.h"
#include "cli/check_options.h"
#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/exports.h"
#include "cli/many.h"
#include "cli/options.h"
#include "cli/output_name.h"
#include "cli/words.h"
#include "slamdb/base/atomic_file.h"
#include "slamdb/base/atomic_folder.h"
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
bool IsOneAtlas(const std::vector<std::string>& named, const AtlasInputs& found) {
  return named.size() == 1 && !IsFolder(named.front()) && found.atlases.size() == 1 &&
         found.atlases.front().location.ToString() == named.front();
}

// `lab.html` of lab.osa, and the folder `report` of several.
std::string OutputOf(const ReportVerbOptions& options, bool one_atlas) {
  if (!options.output.empty()) return options.output;
  const std::string& first = options.many.inputs.paths.front();
  if (first == "-") RefuseUsage("nothing names the page: -o/--output does");
  std::string output = one_atlas ? NameOf(Location(first)) + ".html" : "report";
  GuardDefaultName(output);
  return output;
}

void RequireFolderName(const std::string& output) {
  if (!NamesFolder(output))
    RefuseUsage(detail::Concat("several pages need a folder, and ", output, " names a file; name a folder, as ",
                               fs::path(output).replace_extension().string(), "/"));
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

// The folder in which a folder is.
std::string ParentOf(const std::string& folder) {
  const fs::path path(folder);
  return (path.has_filename() ? path : path.parent_path()).parent_path().string();
}

// Before the work, so that what would fail at the end fails at once.
void RefuseToReplace(const std::string& path, bool overwrite) {
  RefuseAtlas(path);
  std::error_code missing;
  if (!overwrite && fs::exists(path, missing) && !IsSpecialFile(path))
    throw Error(ErrorKind::kAlreadyExists, path, "", "is there already; -O/--overwrite replaces it");
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
        one_(IsOneAtlas(options.many.inputs.paths, inputs_)),
        output_(OutputOf(options, one_)),
        sizes_(SizesOf(inputs_.atlases)) {
    if (one_ && !NamesFolder(output_)) {
      RequirePageName(output_);
      RefuseToReplace(output_, options.overwrite);
      return;
    }
    one_ = false;
    RequireFolderName(output_);
    std::set<std::string> taken;
    for (const AtlasInput& atlas : inputs_.atlases) pages_[atlas.location.ToString()] = PageOf(atlas.location, taken);
    if (const std::string parent = ParentOf(output_); !parent.empty()) MakeFolder(parent);
    for (const auto& [atlas, page] : pages_) RefuseAtlas((fs::path(output_) / page).string());
    RefuseAtlas(IndexPath());
    folder_.emplace(output_, AtomicFileOptions{.overwrite = options.overwrite});
  }

  // Pages are written as soon as they are there, and only what the index needs is kept. They appear together.
  ExitCode Run() {
    const auto outcomes = ForEachInput<AtlasReport>(inputs_.atlases, options_.many.inputs.from, console_,
                                                    [&](const std::string& path, const ReadOptions& read,
                                                        Notices& notices) { return Report(path, read, notices); });
    if (unwritten_) std::rethrow_exception(unwritten_);
    ExitCode code = ReportOutcomes(outcomes, console_);
    std::vector<AtlasReport> reports;
    for (const auto& outcome : outcomes) reports.push_back(outcome.ok() ? outcome.result : Failed(outcome));
    for (const AtlasReport& report : reports)
      if (!report.checked.failure.empty() || !report.checked.report.ok()) code = ExitCode::kFailed;
    if (folder_) {
      WritePage(kIndex, ReportIndex(reports, Title()));
      folder_->Commit();
    }
    Tell(reports);
    return code;
  }

 private:
  static constexpr const char* kIndex = "index.html";

  std::string IndexPath() const { return (fs::path(output_) / kIndex).string(); }

  // In the folder of the pages under that name, or the one page.
  void WritePage(const std::string& name, const std::string& page) {
    std::unique_ptr<AtomicFile> file;
    if (folder_) {
      const std::lock_guard lock(mutex_);
      file = folder_->Make(name);
    } else {
      file = std::make_unique<AtomicFile>(output_, AtomicFileOptions{.overwrite = options_.overwrite});
    }
    file->Write(page);
    file->Commit();
  }

  AtlasReport Report(const std::string& path, const ReadOptions& read, Notices& notices) {
    ReadOptions whole = read;
    whole.needs = Content::kObservations | Content::kLandmarks;
    const Atlas atlas = ReadAtlas(path, whole, &notices);
    CheckOptions check = options_.check;
    check.gates = GatesOf(options_.limits);
    check.threads = read.threads;
    AtlasReport report = ReportOn(atlas, path, check);
    if (const auto size = sizes_.find(path); size != sizes_.end()) report.bytes = size->second;
    report.page = one_ ? std::string() : pages_.at(path);
    const std::string page = ReportPage(atlas, report, {.threads = read.threads, .wording = InCommandWords});
    try {
      WritePage(report.page, page);
    } catch (const Error&) {  // not one of the atlas
      const std::lock_guard lock(mutex_);
      unwritten_ = std::current_exception();
    }
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
      console_.PrintData(InCommandWords(ToJson(reports, output_)));
      return;
    }
    for (const AtlasReport& report : reports)
      console_.Print(detail::Visible(report.checked.name + ": " + Verdict(report.checked)) + "\n");
    const bool written = !one_ || reports.front().checked.failure.empty();
    if (written && output_ != "-") console_.PrintWritten(one_ ? output_ : IndexPath(), {});
  }

  const ReportVerbOptions& options_;
  Console& console_;
  AtlasInputs inputs_;
  bool one_;  // a page, without a folder
  std::string output_;
  std::map<std::string, std::uint64_t> sizes_;
  std::map<std::string, std::string> pages_;
  std::optional<AtomicFolder> folder_;  // of the pages; none of one page alone
  std::mutex mutex_;
  std::exception_ptr unwritten_;  // why a page was not
};

ExitCode RunReport(const ReportVerbOptions& options, Console& console) {
  if (options.output == "-") RefuseUsage("a report goes to a file or a folder; name it with -o/--output");
  return Reporting(options, console).Run();
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
