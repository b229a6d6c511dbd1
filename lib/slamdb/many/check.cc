// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/check.h"

#include <memory>

#include "slamdb/base/error.h"
#include "slamdb/edit/words/mend.h"

namespace slamdb {

std::vector<Outcome<CheckReport>> CheckAtlases(const AtlasInputs& inputs, const CheckAtlasesOptions& options) {
  if (inputs.atlases.empty()) throw Error(ErrorKind::kNotFound, "there is no atlas to check");
  const LoadedVocabulary* words = options.vocabulary;
  CheckOptions check = options.check;
  if (words != nullptr) check.vocabulary_words = words->tree.word_count;
  (void)CheckAtlas(Atlas(), check);  // throws for what no atlas can be held against
  return ForEachInput<CheckReport>(
      inputs.atlases, options.read, [&](const AtlasInput& input, const ReadOptions& read, Notices& notices) {
        const std::shared_ptr<const Atlas> atlas = AtlasOf(input, read, notices);
        if (words != nullptr)
          RequireVocabulary(*atlas, {.tree = &words->tree, .identity = words->identity, .threads = read.threads});
        CheckOptions own = check;
        own.threads = read.threads;
        own.progress = read.progress;
        return CheckAtlas(*atlas, own);
      });
}

std::vector<CheckedFile> CheckedFilesOf(std::span<const Outcome<CheckReport>> outcomes) {
  std::vector<CheckedFile> files;
  for (const auto& outcome : outcomes)
    files.push_back({.name = outcome.path, .report = outcome.result, .failure = outcome.error});
  return files;
}

}  // namespace slamdb
