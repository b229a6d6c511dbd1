// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/repair/repair.h"

#include <memory>

#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/help/usage.h"
#include "cli/report/layout.h"
#include "cli/words.h"
#include "slamdb/base/error.h"

namespace slamdb::cli {
namespace {

struct RepairVerbOptions {
  EditOptions edit;
  std::vector<std::string> rules;
  std::string journal, undo, vocabulary;
};

std::string Line(const Finding& finding) { return "      " + ToString(finding.place) + ": " + finding.message + "\n"; }

std::string More(std::uint64_t findings) {
  return findings > 1 ? "      and " + Grouped(findings - 1) + " more\n" : std::string();
}

std::string TextOf(const RepairReport& report, bool dry_run) {
  std::string text = report.applied.empty() ? "nothing to repair\n" : dry_run ? "would repair\n" : "repaired\n";
  for (const AppliedFix& fix : report.applied)
    text += "  " + fix.rule + ": " + fix.title + " (" + fix.fix + ", " + Counted(fix.changes, "change") + ")\n" +
            Line(fix.first) + More(fix.findings);
  std::uint64_t notes = 0;
  bool head = false;
  for (const Unrepaired& rule : report.left) {
    if (rule.severity == Severity::kNote) {
      notes += rule.findings;
      continue;
    }
    if (!std::exchange(head, true)) text += "without a safe repair\n";
    text += "  " + std::string(ToString(rule.severity)) + " " + rule.rule + ": " + rule.title + "\n" +
            Line(rule.first) + More(rule.findings) + "      stays: " + rule.reason + "\n";
  }
  if (notes > 0) text += Counted(notes, "note") + " left, as healthy files have them; `slamdb check -v` tells\n";
  return text;
}

ExitCode RunUndo(const RepairVerbOptions& options, Console& console) {
  Notices notices;
  const Journal journal = ReadJournal(options.undo);
  Atlas atlas = ReadInput(options.edit, console, notices, InputErrors::kAreRepaired);
  const UndoReport report = NamingFile(options.edit.input, [&] {
    return UndoRepair(atlas, journal, {.threads = console.threads(), .progress = console.MakeProgress()});
  });
  WriteResult(atlas, options.edit, "repair --undo " + options.edit.input, console, notices);
  const std::string text =
      (options.edit.dry_run ? "would take back " : "took back ") + Counted(report.edits, "edit") + "\n";
  return FinishEdit(text, ToJson(report, FilesOf(options.edit)), options.edit, console, notices);
}

ExitCode RunRepair(const RepairVerbOptions& options, Console& console) {
  if (!options.undo.empty()) return RunUndo(options, console);
  SideFile journal(options.journal, options.edit);
  Notices notices;
  Atlas atlas = ReadInput(options.edit, console, notices, InputErrors::kAreRepaired);
  const std::optional<LoadedVocabulary> vocabulary = LoadGivenVocabulary(options.vocabulary, console);
  RepairOptions repair = {.rules = options.rules,
                          .journal = journal.wanted() || options.edit.json,  // which counts its edits
                          .threads = console.threads(),
                          .progress = console.MakeProgress()};
  if (vocabulary) {
    repair.vocabulary = &vocabulary->tree;
    repair.vocabulary_identity = vocabulary->identity;
  }
  const RepairReport report = NamingFile(options.edit.input, [&] { return RepairAtlas(atlas, repair); });
  if (journal.wanted()) journal.Write(ToJson(report.journal));
  WriteResult(atlas, options.edit, "repair " + options.edit.input, console, notices, &journal);
  const ExitCode code = FinishEdit(TextOf(report, options.edit.dry_run), ToJson(report, FilesOf(options.edit)),
                                   options.edit, console, notices);
  return report.sound() ? code : ExitCode::kFailed;
}

std::string CheckFixableRule(const std::string& id) {
  std::vector<std::string> ids;
  for (const Rule& rule : ReadRules()) ids.emplace_back(rule.id);
  const Rule* rule = FindRule(id);
  if (rule == nullptr) {
    const std::string meant = MeantInstead(id, ids);
    return "no rule '" + id + "'" + (meant.empty() ? "; `slamdb check --list` shows them" : meant);
  }
  return rule->fix ? std::string()
                   : InCommandWords("rule '" + id + "' has no repair: " + std::string(rule->fix.unfixable));
}

Run AddRepair(CLI::App& verb) {
  const auto options = std::make_shared<RepairVerbOptions>();
  options->edit.needs = Content::kObservations | Content::kLandmarks;
  AddEdit(verb, options->edit);
  verb.add_option("--rule", options->rules, "Apply the repair of this rule only; may be given several times")
      ->type_name("RULE")
      ->allow_extra_args(false)
      ->check(CheckFixableRule);
  AddVocabulary(verb, options->vocabulary);
  CLI::Option* journal =
      Mark(verb.add_option("--journal", options->journal, "Write every edit here, with what was there before"),
           Writes::kFile)
          ->type_name("FILE");
  verb.add_option("--undo", options->undo, "Take back the edits of this journal: INPUT is what the repair wrote")
      ->type_name("FILE")
      ->excludes(journal)
      ->excludes(verb.get_option("--rule"))
      ->excludes(verb.get_option("--vocabulary"));
  return [options](Console& console) { return RunRepair(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb repair crashed.osa sound.osa", "Repairs what can be repaired, and says what cannot and why."},
    {"slamdb repair crashed.osa --dry-run", "Only says what it would do."},
    {"slamdb repair crashed.osa sound.osa --vocabulary ORBvoc.txt",
     "Words that are damaged come back; without the vocabulary they are dropped."},
    {"slamdb repair saved_twice.osa good.osa --rule map-listed-once", "Applies one repair and touches nothing else."},
    {"slamdb repair crashed.osa sound.osa --journal fix.json\nslamdb repair --undo fix.json sound.osa again.osa",
     "Keeps a journal, and gets the file back as it was, byte for byte."},
};

}  // namespace

const Command kRepair = {
    .name = "repair",
    .summary = "repair what checks find",
    .group = Group::kCheck,
    .description =
        R"(Applies the repairs of the rules that 'slamdb check' breaks, in the order of the catalogue, until nothing is left that can
be repaired safely. Nothing is invented: a repair restores what another part of the atlas tells, or drops what leads
nowhere. What has no safe repair stays, and is listed with the reason. The input is never changed.

With --journal every edit is kept with its value before and after, exactly; --undo with that journal gives the original
back, uninitialised memory and the order of lists included. A journal names the content of what it belongs to, and
refuses any other atlas.)",
    .done = "Done, and no errors are left.",
    .failed =
        "Errors are left that have no safe repair (the output is written all the same), an input could not be read, "
        "or the output not be written.",
    .lossy = kOutputLossy,
    .examples = kExamples,
    .add = AddRepair,
};

}  // namespace slamdb::cli
