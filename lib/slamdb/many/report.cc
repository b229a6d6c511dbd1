// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/report.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>

#include "slamdb/base/atomic_file.h"
#include "slamdb/base/atomic_folder.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/file_size.h"
#include "slamdb/base/error.h"
#include "slamdb/base/output_name.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/results.h"
#include "slamdb/formats/store/store.h"
#include "slamdb/many/names.h"

namespace slamdb {
namespace {

namespace fs = std::filesystem;

constexpr const char* kIndex = "index.html";

bool IsFolder(const std::string& path) {
  std::error_code ignored;
  return !detail::IsServer(path) && fs::is_directory(path, ignored);
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
    throw Error(ErrorKind::kAlreadyExists, path, "", "is there already; WriteOptions::overwrite replaces it");
}

// By the name of each input: of a file its size, of an atlas in a store about what it takes there.
std::map<std::string, std::uint64_t> SizesOf(const std::vector<AtlasInput>& inputs) {
  std::map<std::string, std::uint64_t> sizes;
  std::set<std::string> stores;
  for (const AtlasInput& input : inputs) {
    const Location& location = input.location;
    const auto bytes = location.name.empty() ? detail::FileSize(location.path) : std::nullopt;
    if (bytes) sizes[location.ToString()] = *bytes;
    if (location.name.empty() || !HoldsNamedAtlases(location.path) || !stores.insert(location.path).second) continue;
    try {
      for (const StoredAtlas& atlas : Store::Open(location.path).List())
        sizes[Location(location.path, atlas.name).ToString()] = atlas.bytes;
    } catch (const Error&) {  // which reading will tell
    }
  }
  return sizes;
}

std::string TitleOf(std::span<const std::string> named) {
  if (named.size() != 1) return detail::Counted(named.size(), "input");
  std::error_code ignored;  // `.` and `maps/` are called as their folder is
  const fs::path name = IsFolder(named.front()) ? fs::canonical(named.front(), ignored).filename() : fs::path();
  return name.empty() ? detail::WithoutPasswords(named.front()) : name.string();
}

// Where pages go, as they are made: into a folder, or the only one.
class Pages {
 public:
  Pages(const AtlasInputs& found, bool one, const ReportOptions& options)
      : output_(options.output), overwrite_(options.overwrite) {
    if (output_.empty()) return;
    if (one && !NamesFolder(output_)) {
      RefuseToReplace(output_, overwrite_);
      return;
    }
    std::set<std::string> taken;
    for (const AtlasInput& atlas : found.atlases) names_.push_back(PageOf(atlas.location, taken));
    if (const std::string parent = ParentOf(output_); !parent.empty()) MakeFolder(parent);
    for (const std::string& name : names_) RefuseAtlas(PathOf(name));
    RefuseAtlas(PathOf(kIndex));
    folder_.emplace(output_, AtomicFileOptions{.overwrite = overwrite_});
  }

  bool has_index() const { return folder_.has_value(); }
  // Beside the index; empty: without one.
  std::string NameOf(std::size_t row) const { return folder_ ? names_[row] : std::string(); }
  // Of the page alone, or of the index.
  std::string path() const { return folder_ ? PathOf(kIndex) : output_; }

  // May be called from several threads.
  void Write(const std::string& name, const std::string& page) {
    if (output_.empty()) return;
    std::unique_ptr<AtomicFile> file;
    if (folder_) {
      const std::lock_guard lock(mutex_);
      file = folder_->Make(name);
    } else {
      file = std::make_unique<AtomicFile>(output_, AtomicFileOptions{.overwrite = overwrite_});
    }
    file->Write(page);
    file->Commit();
  }

  void FinishWith(const std::string& index) {
    Write(kIndex, index);
    folder_->Commit();
  }

 private:
  std::string PathOf(const std::string& name) const { return (fs::path(output_) / name).string(); }

  const std::string output_;
  const bool overwrite_;
  std::vector<std::string> names_;      // by row
  std::optional<AtomicFolder> folder_;  // none of one page alone
  std::mutex mutex_;
};

class Reporter {
 public:
  Reporter(const AtlasInputs& found, bool one, const ReportOptions& options)
      : inputs_(found.atlases), options_(options), pages_(found, one, options), sizes_(SizesOf(found.atlases)) {}

  Reports Run(const std::string& title) {
    Reports reports;
    reports.outcomes = ForEachInput<AtlasReport>(
        inputs_, options_.read, [&](const AtlasInput& input, const ReadOptions& read, Notices& notices) {
          return Report(input, *AtlasOf(input, read, notices), read);
        });
    if (unwritten_) std::rethrow_exception(unwritten_);
    for (Outcome<AtlasReport>& outcome : reports.outcomes)
      if (!outcome.ok()) outcome.result.checked = {.name = outcome.path, .report = {}, .failure = outcome.error};
    if (pages_.has_index()) {
      std::vector<AtlasReport> all;
      for (const Outcome<AtlasReport>& outcome : reports.outcomes) {
        all.push_back(outcome.result);
        all.back().checked.failure = Worded(outcome.error, options_.wording);
      }
      page_ = ReportIndex(all, title);
      pages_.FinishWith(page_);
    }
    reports.page = std::move(page_);
    if (!reports.page.empty()) reports.written = pages_.path();
    return reports;
  }

 private:
  // A page is written as soon as it is there, and only what the index needs is kept.
  AtlasReport Report(const AtlasInput& input, const Atlas& atlas, const ReadOptions& read) {
    const std::string name = input.location.ToString();
    CheckOptions check = options_.check;
    check.threads = read.threads;
    check.progress = read.progress;
    AtlasReport report = ReportOn(atlas, name, check);
    if (const auto size = sizes_.find(name); size != sizes_.end()) report.bytes = size->second;
    report.page = pages_.NameOf(static_cast<std::size_t>(&input - inputs_.data()));
    std::string page = ReportPage(atlas, report, {.threads = read.threads, .wording = options_.wording});
    try {
      pages_.Write(report.page, page);
    } catch (const Error&) {  // not one of the atlas
      const std::lock_guard lock(mutex_);
      unwritten_ = std::current_exception();
    }
    if (!pages_.has_index()) page_ = std::move(page);
    return report;
  }

  const std::vector<AtlasInput>& inputs_;
  const ReportOptions& options_;
  Pages pages_;
  const std::map<std::string, std::uint64_t> sizes_;
  std::string page_;  // of one atlas, or the index
  std::mutex mutex_;
  std::exception_ptr unwritten_;  // why a page was not
};

}  // namespace

bool Reports::ok() const {
  return std::ranges::all_of(outcomes,
                             [](const auto& outcome) { return outcome.ok() && outcome.result.checked.report.ok(); });
}

bool IsOneAtlas(std::span<const std::string> named, const AtlasInputs& found) {
  if (named.size() != 1 || found.atlases.size() != 1) return false;
  const AtlasInput& only = found.atlases.front();
  return only.atlas != nullptr || (!IsFolder(named.front()) && only.location == Location(named.front()));
}

std::string WhyNotReportTo(const std::string& output, bool one_atlas) {
  if (NamesFolder(output)) return {};
  if (one_atlas) return output.empty() ? std::string() : WhyNoPage(output);
  if (output.empty()) return "several pages need a folder, which nothing names";
  return detail::Concat("several pages need a folder, and ", output, " names a file; name a folder, as ",
                        fs::path(output).replace_extension().string(), "/");
}

Reports WriteReports(std::span<const std::string> named, const AtlasInputs& found, const ReportOptions& options) {
  if (found.atlases.empty())
    throw Error(ErrorKind::kNotFound, named.empty() ? std::string() : named.front(), "",
                "there is no atlas to report on");
  const bool one = IsOneAtlas(named, found);
  if (const std::string why = WhyNotReportTo(options.output, one); !why.empty()) throw Error(ErrorKind::kUsage, why);
  (void)CheckAtlas(Atlas(), options.check);  // throws for what no atlas can be held against
  return Reporter(found, one, options).Run(TitleOf(named));
}

std::string ToJson(const Reports& reports, const std::string& output) {
  std::vector<AtlasReport> all;
  for (const Outcome<AtlasReport>& outcome : reports.outcomes) all.push_back(outcome.result);
  return ToJson(std::span<const AtlasReport>(all), output);
}

}  // namespace slamdb
