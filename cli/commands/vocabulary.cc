// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/dbow2/vocabulary.h"

#include <memory>

#include "cli/batch.h"
#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/input_errors.h"
#include "cli/options.h"
#include "cli/report/layout.h"
#include "slamdb/base/detail/visible.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/words/words.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/vocabularies.h"
#include "slamdb/many/names.h"

namespace slamdb::cli {
namespace {

using detail::Visible;

struct ShowVocabularyOptions {
  InputOptions inputs;
  bool json = false;
};

struct VerifyOptions {
  InputOptions inputs;
  std::string vocabulary;
};

struct SetOptions {
  std::string input, output;
  StampOptions stamp;
  InputFormat from;
  TargetOptions target;
};

struct RecomputeOptions {
  EditOptions edit;
  std::string vocabulary;
  bool missing = false;
};

// ---- show

std::string ShownText(const Outcome<ShownVocabulary>& outcome) {
  const Vocabulary& vocabulary = outcome.result.vocabulary;
  std::string text = Visible(outcome.path) + "\n  name       " + Visible(vocabulary.name) + "\n  checksum   " +
                     Visible(vocabulary.checksum) + "\n";
  const auto& file = outcome.result.file;
  if (!file) return text;
  const auto& shape = file->shape;
  if (!shape) return text + "  (" + (file->other.empty() ? "a vocabulary in its binary form" : file->other) + ")\n";
  return text + "  words      " + Grouped(shape->words) + "\n  branching  " + std::to_string(shape->branching) +
         "\n  depth      " + std::to_string(shape->depth) + "\n  weighting  " + shape->weighting + "\n  scoring    " +
         shape->scoring + "\n";
}

ExitCode RunShow(const ShowVocabularyOptions& options, Console& console) {
  const auto outcomes = ForEachInput<ShownVocabulary>(
      options.inputs, console, [&](const std::string& path, const ReadOptions& read, Notices& notices) {
        return ShowVocabulary(path, read, notices);
      });
  std::vector<ShownVocabulary> shown;
  for (const auto& outcome : outcomes) {
    if (!outcome.ok()) continue;
    shown.push_back(outcome.result);
    if (!options.json) console.Print(ShownText(outcome));
  }
  if (options.json) console.PrintData(ToJson(shown));
  return ReportOutcomes(outcomes, console);
}

// ---- verify

ExitCode RunVerify(const VerifyOptions& options, Console& console) {
  const Vocabulary wanted = ReadVocabularyIdentity(options.vocabulary);
  const auto outcomes = ForEachInput<Vocabulary>(
      options.inputs, console, [&](const std::string& path, const ReadOptions& read, Notices& notices) {
        ReadOptions names = read;
        names.needs = Content::kBagOfWords;
        names.features = FeatureColumns::kNone;
        return ReadAtlas(path, names, &notices).vocabulary;
      });
  ExitCode code = ReportOutcomes(outcomes, console);
  for (const auto& outcome : outcomes) {
    if (!outcome.ok()) continue;
    const std::string mismatch = VocabularyMismatch(outcome.result, wanted);
    console.Print(Visible(outcome.path) + ": " + Visible(mismatch.empty() ? "matches " + wanted.name : mismatch) +
                  "\n");
    if (!mismatch.empty()) code = ExitCode::kFailed;
  }
  return code;
}

// ---- set

ExitCode RunSet(const SetOptions& options, Console& console) {
  const StampOptions& stamp = options.stamp;
  if (stamp.vocabulary.empty() && stamp.name.empty() && stamp.checksum.empty())
    RefuseUsage("nothing to do: give --vocabulary, or --name and --checksum");
  RequireOutput(options.output);
  const Location input(options.input), output(NamedOutput(options.input, options.output, options.target.to));
  const Format& format = FormatOfOutput(output, options.target.to);
  RefuseBadTarget(output, format, options.target);
  RefuseBinaryOnTerminal(output, format);
  Notices notices;
  ReadOptions read = MakeReadOptions(console, options.from);
  read.needs = Content::kBagOfWords;
  Atlas atlas = ReadAtlas(input, read, &notices);
  StampVocabulary(atlas, stamp);
  WriteOptions write = MakeWriteOptions(console, options.target, "vocabulary set " + options.input);
  write.format = FormatToWrite(atlas, output, options.target.to);
  WriteAtlas(atlas, output, write, &notices);
  return FinishWriting(output, " with " + atlas.vocabulary.name + " (" + atlas.vocabulary.checksum + ")", console,
                       notices);
}

// ---- recompute

std::string RecomputedText(const RecomputeWordsReport& report) {
  const Vocabulary &before = report.before, &after = report.after;
  const std::uint64_t others = report.recomputed - report.missing - report.equal;
  std::string text = "recomputed " + Counted(report.recomputed, "keyframe") + " of " + Grouped(report.keyframes) +
                     ": " + Counted(report.words, "word") + "\n";
  text += "  as they were  " + Grouped(report.equal) + "\n  changed       " + Grouped(others) + "\n  were missing  " +
          Grouped(report.missing) + "\n";
  const std::string now = after.name + " (" + after.checksum + ")";
  if (before == after) return text + "vocabulary " + now + ", as before\n";
  return text + "vocabulary " + before.name + " (" + before.checksum + ") -> " + now + "\n";
}

ExitCode RunRecompute(const RecomputeOptions& options, Console& console) {
  Notices notices;
  Atlas atlas = ReadInput(options.edit, console, notices, InputErrors::kAreRepaired);
  const LoadedVocabulary vocabulary = LoadVocabulary(options.vocabulary, console.threads());
  const RecomputeWordsReport report = RecomputeWords(
      atlas, vocabulary.tree, vocabulary.identity,
      {.only_missing = options.missing, .threads = console.threads(), .progress = console.MakeProgress()});
  TellErrors(options.edit.input, atlas, console, notices);  // those that missing words were are mended
  WriteResult(atlas, options.edit, "vocabulary recompute " + options.edit.input, console, notices);
  return FinishEdit(RecomputedText(report), ToJson(report, FilesOf(options.edit)), options.edit, console, notices);
}

// ---- options

Run BindShow(CLI::App& verb) {
  const auto options = std::make_shared<ShowVocabularyOptions>();
  AddInputs(verb, options->inputs, "An atlas, or a vocabulary file");
  AddJson(verb, options->json);
  return [options](Console& console) { return RunShow(*options, console); };
}

Run BindVerify(CLI::App& verb) {
  const auto options = std::make_shared<VerifyOptions>();
  AddInputs(verb, options->inputs, "An atlas: a file, or STORE.db#NAME");
  verb.add_option("--vocabulary", options->vocabulary, "The vocabulary file that they should match")
      ->type_name("FILE")
      ->required();
  return [options](Console& console) { return RunVerify(*options, console); };
}

Run BindSet(CLI::App& verb) {
  const auto options = std::make_shared<SetOptions>();
  verb.add_option("INPUT", options->input, "The atlas")->type_name("FILE")->required();
  AddOutputPlace(verb, options->output, Writes::kAtlas, "The copy to write");
  CLI::Option* file =
      verb.add_option("--vocabulary", options->stamp.vocabulary, "Stamp the name and checksum of this file")
          ->type_name("FILE");
  verb.add_option("--name", options->stamp.name, "Stamp this name")
      ->type_name("NAME")
      ->check(WhyNoVocabularyName)
      ->excludes(file);
  verb.add_option("--checksum", options->stamp.checksum, "Stamp this MD5")
      ->type_name("MD5")
      ->check(WhyNoChecksum)
      ->excludes(file);
  verb.add_flag("--force", options->stamp.force, "Stamp also what is no vocabulary");
  AddFrom(verb, options->from);
  AddTarget(verb, options->target);
  return [options](Console& console) { return RunSet(*options, console); };
}

Run BindRecompute(CLI::App& verb) {
  const auto options = std::make_shared<RecomputeOptions>();
  options->edit.needs = Content::kDescriptors;
  AddEdit(verb, options->edit);
  verb.add_option("--vocabulary", options->vocabulary, "The vocabulary file: DBoW2 text, or its binary form")
      ->type_name("FILE")
      ->required();
  verb.add_flag("--missing", options->missing, "Only keyframes without bag of words or feature vector");
  return [options](Console& console) { return RunRecompute(*options, console); };
}

Run AddVocabulary(CLI::App& verb) {
  verb.require_subcommand(1);
  std::vector<std::pair<const CLI::App*, Run>> runs;
  const auto add = [&](const char* name, const char* summary, Run (*bind)(CLI::App&)) {
    CLI::App* inner = verb.add_subcommand(name, summary);
    runs.emplace_back(inner, bind(*inner));
  };
  add("show", "Show which vocabulary an atlas was made with, or what a vocabulary file is", BindShow);
  add("verify", "Tell whether atlases were made with a vocabulary file", BindVerify);
  add("set", "Write a copy of an atlas that names another vocabulary", BindSet);
  add("recompute", "Write a copy of an atlas with the words of a vocabulary", BindRecompute);
  return [runs](Console& console) {
    for (const auto& [inner, run] : runs)
      if (inner->parsed()) return run(console);
    return ExitCode::kUsage;
  };
}

constexpr Example kExamples[] = {
    {"slamdb vocabulary show lab.osa ORBvoc.txt", "The name and checksum in an atlas, and of a vocabulary file."},
    {"slamdb vocabulary verify maps/*.osa --vocabulary ORBvoc.txt", "Whether ORB-SLAM3 will take these maps."},
    {"slamdb vocabulary set lab.osa stamped.osa --vocabulary ORBvoc.txt",
     "For a vocabulary that is the same in another file, such as ORBvoc.bin and ORBvoc.txt."},
    {"slamdb vocabulary recompute lab.osa moved.osa --vocabulary smaller.txt",
     "Move a map to another vocabulary: every bag of words and feature vector anew."},
    {"slamdb vocabulary recompute lab.osa --vocabulary ORBvoc.txt --dry-run",
     "Whether the words in the map are those that this vocabulary gives."},
};

}  // namespace

const Command kVocabulary = {
    .name = "vocabulary",
    .summary = "show, verify or change the vocabulary that an atlas was made with",
    .group = Group::kChange,
    .description =
        R"(An ORB-SLAM3 atlas names the vocabulary it was made with by file name and MD5, and ORB-SLAM3 refuses the whole atlas when
the MD5 is not that of its own vocabulary file, even if the file differs in its spelling only. The words of the atlas are
not changed by 'set', so stamp only what has the same words.

'recompute' looks up the words of every keyframe's descriptors in a vocabulary file, as ORB-SLAM3 does to the last bit, and
stamps its name and MD5: it moves a map to another vocabulary, and restores bags of words and feature vectors that are
missing ('--missing' for those alone).)",
    .failed = "An atlas does not match, or a file could not be read or written.",
    .examples = kExamples,
    .add = AddVocabulary,
};

}  // namespace slamdb::cli
