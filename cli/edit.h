// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/command.h"
#include "cli/guard.h"
#include "cli/options.h"
#include "slamdb/base/atomic_file.h"
#include "slamdb/base/error.h"
#include "slamdb/base/report_files.h"
#include "slamdb/edit/repair/repair.h"
#include "slamdb/formats/dbow2/vocabulary.h"
#include "slamdb/formats/results.h"
#include "slamdb/formats/rows/revisions.h"
#include "slamdb/model/content.h"

// The frame of the verbs that change an atlas: read the input, call one function of the library, write the output, say
// what was done. Inputs are never changed, and with --dry-run nothing is written.
namespace slamdb::cli {

// What exit code 3 means where only the format of the output can lose something.
inline constexpr std::string_view kOutputLossy =
    "Done, but the output, of a format for atlases, does not hold all of the atlas; standard error names what it "
    "lacks.";

struct EditOptions {
  std::string input, output;
  InputFormat from;
  TargetOptions target;
  Content needs = Content::kNothing;  // of the input: see ReadOptions::needs
  bool json = false, dry_run = false;
  double wait = kUsualWait;
  // Where the result is the next revision of an atlas in a store: what it was made of, and what besides.
  std::optional<RevisionName> onto, merged;
  std::shared_ptr<InputSubstance> inputs =
      std::make_shared<InputSubstance>();  // that ReadInput has read, for WriteResult; copies share
};

// The positionals INPUT and OUTPUT (OUTPUT may be left out with --dry-run), --from, and AddEditTarget.
void AddEdit(CLI::App& verb, EditOptions& options, Writes output = Writes::kAtlas);

// --to, -O, --no-sync, --wait, --json and --dry-run alone, for verbs that name their inputs and outputs otherwise.
void AddEditTarget(CLI::App& verb, EditOptions& options);

// Ends with exit code 2 when there is no output to write to.
void RequireOutput(const EditOptions& options);

// The format to write a changed atlas in: `to` where it is given; a text archive stays one; otherwise nothing, and the
// output's suffix decides.
std::string FormatToWrite(const Atlas& atlas, const Location& output, const std::string& to);

// Throws Error for what would fail at the end: no output, one that is there, whose format is unknown, or binary on a
// terminal.
void RefuseBadOutput(const EditOptions& options);

// What reports name as input and output; no output with --dry-run.
ReportFiles FilesOf(const EditOptions& options);

// A file beside the output: a journal, a table of ids. It is opened before the work, so that what would fail at the end
// fails at once, and is there, on disk, right before the output is. With an empty path or --dry-run it does nothing.
class SideFile {
 public:
  // Throws Error when the file is standard output, is there and may not be replaced, or cannot be made.
  SideFile(const std::string& path, const EditOptions& options);
  bool wanted() const { return file_.has_value(); }
  void Write(std::string_view text);
  void Commit();

 private:
  std::optional<AtomicFile> file_;
};

// What becomes of the errors that a check of the input finds.
enum class InputErrors { kTell, kAreRepaired };

// The input, whole. Says in one line when a check finds errors in it. Refuses at once, before anything is read, what
// RefuseBadOutput refuses.
Atlas ReadInput(const EditOptions& options, Console& console, Notices& notices,
                InputErrors errors = InputErrors::kTell);

// --vocabulary FILE, and the vocabulary, whole, when it is given.
void AddVocabulary(CLI::App& verb, std::string& path);
std::optional<LoadedVocabulary> LoadGivenVocabulary(const std::string& path, const Console& console);

// Holds the words of an input against the vocabulary, if there is one, and notes what was computed anew.
void HoldWords(const std::string& input, const std::optional<LoadedVocabulary>& vocabulary, const Console& console,
               Atlas& atlas, Notices& notices);

// What work() returns; an Error about an atlas gets the file that the atlas was read from.
template <class Work>
auto NamingFile(const std::string& path, const Work& work) {
  try {
    return work();
  } catch (const Error& error) {
    throw Error(error.kind(), error.path().empty() ? path : error.path(), error.place(), error.problem());
  }
}

// Writes the result, unless --dry-run, and what is `beside` it right before it appears. `provenance` is its line in the
// history of a store: `cull session_a.osa`.
void WriteResult(const Atlas& atlas, const EditOptions& options, const std::string& provenance, Console& console,
                 Notices& notices, SideFile* beside = nullptr);

// The end of a verb that writes an atlas and has no report: prints the notices, and where the output went (see
// Console::PrintWritten). Returns kLossy when they hold a loss.
ExitCode FinishWriting(const Location& output, const std::string& details, Console& console, const Notices& notices);

// Prints what a verb reports, as JSON or for people, in the words of the command: on standard output, or on standard
// error where that is taken by what was written (`piped`). When quiet, JSON alone.
void PrintReport(std::string_view report, bool json, bool piped, Console& console);

// Prints the report (PrintReport), where the output went, and the notices. Returns kLossy when they hold a loss.
ExitCode FinishEdit(std::string_view text, std::string_view json, const EditOptions& options, Console& console,
                    const Notices& notices);

}  // namespace slamdb::cli
