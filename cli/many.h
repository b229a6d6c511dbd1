// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "cli/options.h"
#include "slamdb/many/inputs.h"

// Verbs of many atlases: files, folders, stores, and patterns of names in a store.
namespace slamdb::cli {

struct ManyOptions {
  InputOptions inputs;
  bool recursive = false;
  bool revisions = false;
};

// The positional FILE..., --from, and -r/--recursive.
CLI::Option* AddMany(CLI::App& verb, ManyOptions& options);

// What the inputs stand for. Tells what of folders was left out, and which stores are empty.
AtlasInputs FindInputs(const ManyOptions& options, Console& console, double wait = kUsualWait);

}  // namespace slamdb::cli
