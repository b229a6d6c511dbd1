// SPDX-License-Identifier: BSD-3-Clause
#include "cli/revisions.h"

namespace slamdb::cli {

std::string WhyNoAtlasInAStore(const std::string& text) {
  if (!Location::Parse(text).name.empty()) return {};
  return "expected STORE.db#NAME or postgresql://USER@HOST/DATABASE#NAME, found '" + text + "'";
}

void AddRevision(CLI::App& verb, RevisionOptions& options, const std::string& help) {
  verb.add_option("STORE#NAME", options.atlas, help)->type_name("FILE")->required()->check(WhyNoAtlasInAStore);
  AddWait(verb, options.wait);
}

Store OpenToChange(const std::string& path, double wait, Console& console) {
  Store::Open(path, wait);
  return Store::OpenForWriting(path, {.lock_timeout = wait, .progress = console.MakeProgress(false)});
}

}  // namespace slamdb::cli
