// SPDX-License-Identifier: BSD-3-Clause
#include "cli/choices.h"
#include "python/src/module.h"
#include "python/src/verb.h"
#include "slamdb/checks/report.h"
#include "slamdb/edit/diff/diff.h"
#include "slamdb/edit/repair/recover.h"
#include "slamdb/edit/repair/repair.h"
#include "slamdb/edit/tables/tables.h"
#include "slamdb/edit/words/mend.h"
#include "slamdb/formats/layouts/layout_text.h"
#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/salvage.h"
#include "slamdb/formats/sqlite/options.h"

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
    return [options = CheckOptionsOf(given), atlas = given.AtlasAt("source"), name = given.Get<std::string>("name"),
            vocabulary = given.Path("vocabulary")](Notices&) {
      CheckOptions check = options;
      if (const auto loaded = VocabularyAt(vocabulary, options.threads)) {
        RequireVocabulary(*atlas, {.tree = &loaded->tree, .identity = loaded->identity, .threads = options.threads});
        check.vocabulary_words = loaded->tree.word_count;
      }
      CheckedFile checked{.name = name};
      checked.report = CheckAtlas(*atlas, check);
      return ToJson(std::span<const CheckedFile>(&checked, 1));
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
    const std::shared_ptr<const Atlas> rig = given.Has("cameras") ? given.AtlasAt("cameras") : nullptr;
    return [=, path = given.Path("path"), words = given.Path("vocabulary")](Atlas& atlas, Notices& notices) {
      RecoverOptions recover = options;
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
    const auto names = given.Get<std::pair<std::string, std::string>>("names");
    DiffReportOptions report{.before = names.first, .after = names.second};
    given.Take("max_listed", report.max_listed);
    return [=, before = given.AtlasAt("before"), after = given.AtlasAt("after")](Notices& notices) {
      return ToJson(Compare(*before, *after, options, notices), report);
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
