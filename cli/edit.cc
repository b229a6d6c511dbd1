// SPDX-License-Identifier: BSD-3-Clause
#include "cli/edit.h"

#include <filesystem>
#include <iostream>

#include "cli/report/layout.h"
#include "cli/words.h"
#include "slamdb/base/error.h"
#include "slamdb/checks/check.h"
#include "slamdb/edit/words/mend.h"
#include "slamdb/formats/formats.h"

namespace slamdb::cli {

void RequireOutput(const EditOptions& options) {
  if (options.output.empty() && !options.dry_run)
    RefuseUsage("name an output, or say --dry-run to see only what would be done");
}

std::string FormatToWrite(const Atlas& atlas, const Location& output, const std::string& to) {
  const bool stays_text = to.empty() && atlas.encoding.text && FormatOfOutput(output).id == "orbslam3";
  return stays_text ? "orbslam3-text" : to;
}

void RefuseBadOutput(const EditOptions& options) {
  RequireOutput(options);
  if (options.dry_run) return;
  const Location output = Location::Parse(options.output);
  RefuseSameFile(Location::Parse(options.input), output);
  RefuseBinaryOnTerminal(output, FormatOfOutput(output, options.target.to));
  if (!options.target.overwrite && output.path != "-" && output.name.empty() && std::filesystem::exists(output.path) &&
      !FormatOfOutput(output, options.target.to).named)
    throw Error(ErrorKind::kAlreadyExists, output.path, "", "is there already; -O/--overwrite replaces it");
}

void AddEdit(CLI::App& verb, EditOptions& options) {
  verb.add_option("INPUT", options.input, "The atlas: a file, STORE.db#NAME, or - for standard input")
      ->type_name("FILE")
      ->required();
  verb.add_option("OUTPUT", options.output, "Where to: a file, STORE.db#NAME, or - for standard output")
      ->type_name("FILE");
  AddFrom(verb, options.from);
  AddEditTarget(verb, options);
}

void AddEditTarget(CLI::App& verb, EditOptions& options) {
  AddTarget(verb, options.target);
  AddWait(verb, options.wait);
  AddJson(verb, options.json);
  verb.add_flag("--dry-run", options.dry_run, "Say what would be done, and write nothing");
}

ReportFiles FilesOf(const EditOptions& options) {
  return {.input = options.input, .output = options.dry_run ? std::string() : options.output};
}

SideFile::SideFile(const std::string& path, const EditOptions& options, const std::vector<std::string>& others) {
  RefuseSideFile(path, others);
  if (path.empty() || options.dry_run) return;
  if (!options.target.overwrite && std::filesystem::exists(path))
    throw Error(ErrorKind::kAlreadyExists, path, "", "is there already; -O/--overwrite replaces it");
  file_.emplace(path, AtomicFileOptions{.overwrite = options.target.overwrite, .sync = !options.target.no_sync});
}

void SideFile::Write(std::string_view text) {
  if (file_) file_->Write(text);
}

void SideFile::Commit() {
  if (file_) file_->Commit();
}

namespace {

void TellErrors(const std::string& input, const Atlas& atlas, const Console& console, Notices& notices) {
  const CheckReport check = CheckAtlas(atlas, {.max_findings = 1, .threads = console.threads()});
  for (const RuleResult& result : check.results) {
    if (result.severity != Severity::kError) continue;
    notices.Warn(input + " has " + Counted(check.Count(Severity::kError), "error") + ", the first of " + result.id +
                 "; `slamdb repair` it first, or the result has them too");
    return;
  }
}

}  // namespace

Atlas ReadInput(const EditOptions& options, Console& console, Notices& notices, InputErrors errors) {
  RefuseBadOutput(options);
  Atlas atlas = ReadAtlas(options.input, MakeReadOptions(console, options.from, options.wait), &notices);
  if (errors == InputErrors::kTell) TellErrors(options.input, atlas, console, notices);
  return atlas;
}

void AddVocabulary(CLI::App& verb, std::string& path) {
  verb.add_option("--vocabulary", path,
                  "The vocabulary file that the atlas was made with: words that cannot be of it are computed anew")
      ->type_name("FILE");
}

std::optional<LoadedVocabulary> LoadGivenVocabulary(const std::string& path, const Console& console) {
  if (path.empty()) return std::nullopt;
  return LoadVocabulary(path, console.threads());
}

void HoldWords(const std::string& input, const std::optional<LoadedVocabulary>& vocabulary, const Console& console,
               Atlas& atlas, Notices& notices) {
  if (!vocabulary) return;
  const MendWordsReport report = NamingFile(input, [&] {
    return MendWords(atlas,
                     {.tree = &vocabulary->tree, .identity = vocabulary->identity, .threads = console.threads()});
  });
  for (const std::string& sentence : SentencesOf(report)) notices.Warn(input + ": " + InCommandWords(sentence));
}

void WriteResult(const Atlas& atlas, const EditOptions& options, const std::string& provenance, Console& console,
                 Notices& notices) {
  if (options.dry_run) return;
  WriteOptions write = MakeWriteOptions(console, options.target, provenance, options.wait);
  write.format = FormatToWrite(atlas, options.output, options.target.to);
  WriteAtlas(atlas, options.output, write, &notices);
}

ExitCode FinishEdit(std::string_view text, std::string_view json, const EditOptions& options, Console& console,
                    const Notices& notices) {
  console.Report(notices);
  const bool piped = !options.dry_run && options.output == "-";
  std::string report = options.json ? InCommandWords(json) : std::string(text);
  if (!options.json && !options.dry_run && !piped) report += "wrote " + options.output + "\n";
  if (piped)
    std::cerr << report;
  else if (options.json || !console.quiet())
    console.Print(report);
  return notices.lossy() ? ExitCode::kLossy : ExitCode::kDone;
}

}  // namespace slamdb::cli
