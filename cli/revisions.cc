// SPDX-License-Identifier: BSD-3-Clause
#include "cli/revisions.h"

namespace slamdb::cli {

void AddRevision(CLI::App& verb, RevisionOptions& options, const std::string& help) {
  const auto check = [](const std::string& text) {
    return Location::Parse(text).name.empty()
               ? "expected STORE.db#NAME or postgresql://USER@HOST/DATABASE#NAME, found '" + text + "'"
               : std::string();
  };
  verb.add_option("STORE#NAME", options.atlas, help)->type_name("FILE")->required()->check(check);
  AddWait(verb, options.wait);
}

Store OpenToChange(const std::string& path, double wait, Console& console) {
  Store::Open(path, wait);
  return Store::OpenForWriting(path, {.lock_timeout = wait, .progress = console.MakeProgress(false)});
}

}  // namespace slamdb::cli
