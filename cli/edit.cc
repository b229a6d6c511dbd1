// SPDX-License-Identifier: BSD-3-Clause
#include "cli/edit.h"

#include <filesystem>
#include <iostream>

#include "cli/words.h"
#include "slamdb/base/detail/visible.h"
#include "slamdb/base/error.h"
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

Atlas ReadInput(const EditOptions& options, Console& console, Notices& notices) {
  RefuseBadOutput(options);
  ReadOptions read = MakeReadOptions(console, options.from, options.wait);
  read.needs = options.needs;
  return ReadAtlas(options.input, read, &notices);
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
  if (!options.json && !options.dry_run && !piped) report += "wrote " + detail::Visible(options.output) + "\n";
  if (piped)
    std::cerr << (options.json ? report : detail::VisibleText(report));
  else if (options.json)
    console.PrintData(report);
  else if (!console.quiet())
    console.Print(report);
  return notices.lossy() ? ExitCode::kLossy : ExitCode::kDone;
}

}  // namespace slamdb::cli
