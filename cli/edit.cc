// SPDX-License-Identifier: BSD-3-Clause
#include "cli/edit.h"

#include <algorithm>
#include <filesystem>
#include <iostream>

#include "cli/input_errors.h"
#include "cli/report/layout.h"
#include "cli/words.h"
#include "slamdb/base/detail/visible.h"
#include "slamdb/base/error.h"
#include "slamdb/checks/check.h"
#include "slamdb/edit/words/mend.h"
#include "slamdb/formats/convert_report.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/rows/options.h"
#include "slamdb/many/names.h"

namespace slamdb::cli {

void RequireOutput(const EditOptions& options) {
  if (options.output.empty() && !options.dry_run)
    RefuseUsage("the output is missing; -o/--output names it, and --dry-run does without");
}

std::string FormatToWrite(const Atlas& atlas, const Location& output, const std::string& to) {
  const bool stays_text = to.empty() && atlas.encoding.text && FormatOfOutput(output).id == "orbslam3";
  return stays_text ? "orbslam3-text" : to;
}

void RefuseBadOutput(const EditOptions& options) {
  RequireOutput(options);
  if (options.dry_run) return;
  const Location output = Location::Parse(options.output);
  const Format& format = FormatOfOutput(output, options.target.to);
  RefuseBadTarget(output, format, options.target);
  RefuseBinaryOnTerminal(output, format);
  if (!options.target.overwrite && output.path != "-" && output.name.empty() && !format.named &&
      std::filesystem::exists(output.path) && !IsSpecialFile(output.path))
    throw Error(ErrorKind::kAlreadyExists, output.path, "", "is there already; -O/--overwrite replaces it");
}

void AddEdit(CLI::App& verb, EditOptions& options, Writes output) {
  verb.add_option("INPUT", options.input, AtlasAt("The atlas"))->type_name("FILE")->required();
  AddOutputPlace(verb, options.output, output, OutputAt());
  AddFrom(verb, options.from);
  AddEditTarget(verb, options);
  if (output == Writes::kPattern) return;  // each part has a file of its own, or a name
  verb.parse_complete_callback(
      [&options] { options.output = NamedOutput(options.input, options.output, options.target.to); });
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

SideFile::SideFile(const std::string& path, const EditOptions& options) {
  if (IsStandardOutput(path))
    throw Error(ErrorKind::kUsage, "a file beside the atlas cannot go to standard output; name a file");
  if (path.empty() || options.dry_run) return;
  file_.emplace(path, AtomicFileOptions{.overwrite = options.target.overwrite, .sync = !options.target.no_sync});
}

void SideFile::Write(std::string_view text) {
  if (file_) file_->Write(text);
}

void SideFile::Commit() {
  if (file_) file_->Commit();
  file_.reset();
}

Atlas ReadInput(const EditOptions& options, Console& console, Notices& notices, InputErrors errors) {
  RefuseBadOutput(options);
  ReadOptions read = MakeReadOptions(console, options.from, options.wait);
  read.needs = options.needs;
  const HeldSource held = HoldInput(options.input, read);
  Atlas atlas = ReadAtlas(held, read, &notices);
  options.inputs->Add(atlas, FormatOfInput(held, options.from));
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
  for (const std::string& sentence : SentencesOf(report)) notices.Warn(input + ": " + sentence);
}

void WriteResult(const Atlas& atlas, const EditOptions& options, const std::string& provenance, Console& console,
                 Notices& notices, SideFile* beside) {
  const bool elsewhere = options.output.empty() || options.dry_run;  // perhaps nowhere, and for what holds an atlas
  const Format& format = elsewhere ? FormatById("orbslam3") : FormatOfOutput(options.output, options.target.to);
  RefuseEmptyResult(atlas, *options.inputs, options.output, format, options.dry_run, notices);
  if (options.dry_run) return;
  LoseUseToOrbslam3(atlas, *options.inputs, format, !options.target.layout.empty(), notices);
  WriteOptions write = MakeWriteOptions(console, options.target, provenance, options.wait);
  write.format = FormatToWrite(atlas, options.output, options.target.to);
  write.of<StoreWriteOptions>().from = options.merged;
  if (options.onto) write.of<StoreWriteOptions>().onto = options.onto->number;
  if (beside != nullptr) write.before_commit = [beside] { beside->Commit(); };
  WriteAtlas(atlas, options.output, write, &notices);
}

ExitCode FinishWriting(const Location& output, const std::string& details, Console& console, const Notices& notices) {
  console.Report(notices);
  console.PrintWritten(output.ToString(), notices, details);
  return notices.lossy() ? ExitCode::kLossy : ExitCode::kDone;
}

void PrintReport(std::string_view report, bool json, bool piped, Console& console) {
  if (!json && console.quiet()) return;
  const std::string words = json ? ReportInCommandWords(report) : InCommandWords(report);
  if (piped)
    std::cerr << (json ? words : detail::VisibleText(words));
  else if (json)
    console.PrintData(words);
  else
    console.Print(words);
}

ExitCode FinishEdit(std::string_view text, std::string_view json, const EditOptions& options, Console& console,
                    const Notices& notices) {
  console.Report(notices);
  PrintReport(options.json ? json : text, options.json, !options.dry_run && IsStandardOutput(options.output), console);
  if (!options.json && !options.dry_run) console.PrintWritten(options.output, notices);
  return notices.lossy() ? ExitCode::kLossy : ExitCode::kDone;
}

}  // namespace slamdb::cli
