// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/check.h"

#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "slamdb/base/error.h"
#include "slamdb/edit/words/mend.h"
#include "slamdb/formats/rows/options.h"
#include "slamdb/many/detail/check_journal.h"

namespace slamdb {
namespace {

struct Checked {
  CheckReport report;
  bool is_known = false;  // to the journal
  std::string content;
};

CheckReport CheckOne(const Atlas& atlas, const ReadOptions& read, CheckOptions check, const LoadedVocabulary* words) {
  if (words != nullptr)
    RequireVocabulary(atlas, {.tree = &words->tree, .identity = words->identity, .threads = read.threads});
  check.threads = read.threads;
  check.progress = read.progress;
  return CheckAtlas(atlas, check);
}

}  // namespace

std::uint64_t CheckAtlases(const AtlasInputs& inputs, const CheckAtlasesOptions& options,
                           const std::function<void(Outcome<CheckReport>&& outcome)>& take) {
  if (inputs.atlases.empty()) throw Error(ErrorKind::kNotFound, "there is no atlas to check");
  const LoadedVocabulary* words = options.vocabulary;
  CheckOptions check = options.check;
  if (words != nullptr) check.vocabulary_words = words->tree.word_count;
  (void)CheckAtlas(Atlas(), check);  // throws for what no atlas can be held against
  std::optional<detail::CheckJournal> journal;
  std::map<std::string, std::string> contents;  // by input
  if (!options.journal.empty()) {
    journal.emplace(options.journal, options);
    detail::Contents of(options.read.of<StoreReadOptions>().lock_timeout);
    for (const AtlasInput& input : inputs.atlases) contents[input.location.ToString()] = of.Of(input);
  }
  const auto work = [&](const AtlasInput& input, const ReadOptions& read, Notices& notices) -> Checked {
    Checked checked;
    if (journal) {
      const std::string name = input.location.ToString();
      checked.content = contents.at(name);
      if (std::optional<CheckReport> known = journal->Find(name, checked.content)) {
        checked.report = std::move(*known);
        checked.is_known = true;
        return checked;
      }
    }
    const std::shared_ptr<const Atlas> atlas = AtlasOf(input, read, notices);
    checked.report = CheckOne(*atlas, read, check, words);
    if (!detail::IsContent(checked.content, input, *atlas, read.threads)) checked.content.clear();
    return checked;
  };
  std::uint64_t known = 0;
  ForEachInput<Checked>(inputs.atlases, options.read, work, [&](Outcome<Checked>&& outcome) {
    known += outcome.result.is_known ? 1 : 0;
    Outcome<CheckReport> checked{.path = std::move(outcome.path),
                                 .result = std::move(outcome.result.report),
                                 .error = std::move(outcome.error),
                                 .notices = std::move(outcome.notices)};
    if (journal && !outcome.result.is_known) journal->Add(CheckedFileOf(checked), outcome.result.content);
    take(std::move(checked));
  });
  return known;
}

std::vector<Outcome<CheckReport>> CheckAtlases(const AtlasInputs& inputs, const CheckAtlasesOptions& options) {
  std::vector<Outcome<CheckReport>> outcomes;
  CheckAtlases(inputs, options, [&](Outcome<CheckReport>&& outcome) { outcomes.push_back(std::move(outcome)); });
  return outcomes;
}

CheckedFile CheckedFileOf(const Outcome<CheckReport>& outcome) {
  return {.name = outcome.path, .report = outcome.result, .failure = outcome.error, .file = {}};
}

std::vector<CheckedFile> CheckedFilesOf(std::span<const Outcome<CheckReport>> outcomes) {
  std::vector<CheckedFile> files;
  for (const auto& outcome : outcomes) files.push_back(CheckedFileOf(outcome));
  return files;
}

}  // namespace slamdb
