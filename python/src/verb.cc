// SPDX-License-Identifier: BSD-3-Clause
#include "python/src/verb.h"

#include "slamdb/edit/words/mend.h"

namespace slamdb::python {

void HoldWords(const std::string& vocabulary, int threads, Atlas& atlas, Notices& notices) {
  const auto loaded = VocabularyAt(vocabulary, threads);
  if (!loaded) return;
  const MendWordsReport report =
      MendWords(atlas, {.tree = &loaded->tree, .identity = loaded->identity, .threads = threads});
  for (const std::string& sentence : SentencesOf(report)) notices.Warn(sentence);
}

}  // namespace slamdb::python
