// SPDX-License-Identifier: BSD-3-Clause
#include "cli/choices.h"
#include "python/src/inputs.h"
#include "python/src/module.h"
#include "python/src/verb.h"
#include "slamdb/edit/diff/diff.h"
#include "slamdb/edit/repair/recover.h"
#include "slamdb/edit/repair/repair.h"
#include "slamdb/edit/tables/tables.h"
#include "slamdb/formats/rows/options.h"
#include "slamdb/formats/salvage.h"
#include "slamdb/many/check.h"

// Checks, repairs and comparisons. slamdb/verbs.py documents what is here.
namespace slamdb::python {

namespace py = pybind11;

CheckOptions CheckOptionsOf(Arguments& given) {
  CheckOptions options;
  given.Take("ignore", options.ignore);
  given.Take("note", options.note);
  given.Take("warn", options.warn);
  given.Take("error", options.error);
  given.Take("strict", options.strict);
  given.Take("max_findings", options.max_findings);
  for (const auto& [gate, limit] : given.Get<std::map<std::string, double>>("gates"))
    options.gates.push_back({gate, limit});
  given.TakeRun(options);
  return options;
}

namespace {

void DefineCheck(py::module_& module) {
  DefineReport(module, "check", [](Arguments& given) {
    const CheckAtlasesOptions options{
        .read = ReadingOf(given), .check = CheckOptionsOf(given), .journal = given.Path("journal")};
    return [options, inputs = InputsOf(given), vocabulary = given.Path("vocabulary")](Notices& notices) {
      CheckAtlasesOptions check = options;
      const auto loaded = VocabularyAt(vocabulary, options.read.threads);
      if (loaded) check.vocabulary = &*loaded;
      const auto outcomes = CheckAtlases(inputs.Find(), check);
      TellOutcomes(outcomes, notices);
      return ToJson(CheckedFilesOf(outcomes));
    };
  });
}

// Beside what is changed.
void WriteBeside(const Journal& journal, const OutputFile& file) {
  if (file.any()) WriteJournal(journal, file.path, file.options);
}

void DefineRepair(py::module_& module) {
  DefineChange(module, "repair", [](Arguments& given) {
    RepairOptions options;
    given.Take("rule", options.rules);
    given.TakeRun(options);
    return [options, journal = given.Output("journal"), path = given.Path("vocabulary")](Atlas& atlas, Notices&) {
      const auto vocabulary = VocabularyAt(path, options.threads);
      RepairOptions repair = options;
      if (vocabulary) {
        repair.vocabulary = &vocabulary->tree;
        repair.vocabulary_identity = vocabulary->identity;
      }
      const RepairReport report = RepairAtlas(atlas, repair);
      WriteBeside(report.journal, journal);
      return ToJson(report);
    };
  });
  DefineChange(module, "undo", [](Arguments& given) {
    UndoOptions options;
    given.TakeRun(options);
    return [options, path = given.Path("journal")](Atlas& atlas, Notices&) {
      return ToJson(UndoRepair(atlas, ReadJournal(path), options));
    };
  });
}

void DefineEdit(py::module_& module) {
  DefineChange(module, "edit_tables", [](Arguments& given) {
    TableEditOptions options;
    if (given.Has("points")) options.points = given.Path("points");
    if (given.Has("keyframes")) options.keyframes = given.Path("keyframes");
    given.Take("delete_missing", options.delete_missing);
    if (!options.points && !options.keyframes)
      throw Error(ErrorKind::kUsage, "no table to edit by: give points= or keyframes=");
    options.threads = given.threads();
    return [options, journal = given.Output("journal")](Atlas& atlas, Notices& notices) {
      const TableEditReport report = EditByTables(atlas, options);
      TellWarnings(report, options, notices);
      WriteBeside(report.journal, journal);
      return ToJson(report);
    };
  });
}

void DefineRecover(py::module_& module) {
  DefineMaker(module, "recover", [](Arguments& given) {
    ReadOptions reading = ReadingOf(given);
    reading.of<StoreReadOptions>().accept_edits = given.Get<bool>("accept_edits");
    RecoverOptions options{.triangulate = given.Get<bool>("triangulate", true)};
    given.TakeRun(options);
    return [=, cameras = given.SourceAt("cameras"), path = given.Path("path"), words = given.Path("vocabulary")](
               Atlas& atlas, Notices& notices) {
      RecoverOptions recover = options;
      const auto rig = cameras.any() ? Hold(cameras, {.threads = options.threads}, notices) : nullptr;
      recover.rig = rig.get();
      const auto vocabulary = VocabularyAt(words, options.threads);
      if (vocabulary) {
        recover.vocabulary = &vocabulary->tree;
        recover.vocabulary_identity = vocabulary->identity;
      }
      Salvage salvage = SalvageAtlas(Location(path), reading);
      const SalvageReport report = RecoverSalvage(salvage, recover);
      for (const std::string& loss : report.losses) notices.Lose(loss);
      atlas = std::move(salvage.atlas);
      return ToJson(report, {.input = path});
    };
  });
}

// Of a cloud and an atlas points alone.
AtlasDiff Compare(const Atlas& before, const Atlas& after, const DiffOptions& options, Notices& notices) {
  if (SubstanceOf(before, /*with_bad=*/true).keyframes == SubstanceOf(after, /*with_bad=*/true).keyframes)
    return DiffAtlases(before, after, options);
  Atlas one = before, other = after;
  if (KeepWhatCloudsHold(one, other)) notices.Note("compares points alone, as one of the inputs holds no more");
  return DiffAtlases(one, other, options);
}

void DefineDiff(py::module_& module) {
  DefineReport(module, "diff", [](Arguments& given) {
    DiffOptions options;
    given.Take("tolerance", options.tolerance, cli::kNonNegative);
    given.TakeRun(options);
    const AtlasOrPath before = given.SourceAt("before"), after = given.SourceAt("after");
    DiffReportOptions report{.before = before.path, .after = after.path};
    given.Take("max_listed", report.max_listed);
    return [=, read = ReadingOf(given)](Notices& notices) {
      const auto one = Hold(before, read, notices), other = Hold(after, read, notices);
      return ToJson(Compare(*one, *other, options, notices), report);
    };
  });
}

}  // namespace

void DefineVerbs(py::module_& module) {
  DefineCheck(module);
  DefineRepair(module);
  DefineEdit(module);
  DefineRecover(module);
  DefineDiff(module);
}

}  // namespace slamdb::python
