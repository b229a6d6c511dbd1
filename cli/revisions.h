// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "cli/console.h"
#include "cli/options.h"
#include "slamdb/formats/store/store.h"

namespace slamdb::cli {

// The positional STORE#NAME of verbs that change which revisions an atlas has, and --wait.
struct RevisionOptions {
  std::string atlas;  // STORE.db#NAME, or STORE.db#NAME@WHICH
  double wait = kUsualWait;
};
void AddRevision(CLI::App& verb, RevisionOptions& options, const std::string& help);

// Why a word names no atlas in a store; empty: it does.
std::string WhyNoAtlasInAStore(const std::string& text);

// A store that is there, to write: a name that is mistyped does not make one.
Store OpenToChange(const std::string& path, double wait, Console& console);

}  // namespace slamdb::cli
