// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <vector>

#include "python/src/arguments.h"
#include "slamdb/base/notices.h"
#include "slamdb/many/each.h"
#include "slamdb/many/inputs.h"

namespace slamdb::python {

// What functions take that take many atlases: files, folders and stores, and atlases in memory.
struct ManyInputs {
  std::vector<AtlasOrPath> sources;
  std::string name;  // of what is in memory; any text
  FindAtlasesOptions options;

  std::vector<std::string> Named() const;
  // To be called without the GIL.
  AtlasInputs Find() const;
};

// `sources`, recursive, name, wait, progress.
ManyInputs InputsOf(Arguments& given);

// What readers had to say of each, with its path where there are several.
template <class Result>
void TellOutcomes(const std::vector<Outcome<Result>>& outcomes, Notices& notices) {
  for (const Outcome<Result>& outcome : outcomes)
    for (const Notice& notice : outcome.notices.items()) {
      const std::string text = (outcomes.size() > 1 ? outcome.path + ": " : "") + notice.text;
      if (notice.kind == Notice::Kind::kLoss) notices.Lose(text);
      if (notice.kind == Notice::Kind::kWarning) notices.Warn(text);
    }
}

}  // namespace slamdb::python
