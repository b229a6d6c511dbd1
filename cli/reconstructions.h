// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "cli/help/tree.h"
#include "slamdb/formats/format.h"

// What reconstructions of other programs are written and read with: picture files, COLMAP's database.
namespace slamdb::cli {

struct ReconstructionOptions {
  std::string images, schema, database;
  bool with_database = false;
};

// --images, --with-database, --colmap-schema and --database.
void AddReconstructionOptions(CLI::App& verb, ReconstructionOptions& options);

// Throws CLI::ValidationError when one of them would be without effect on an output of the format.
void RefuseIdleReconstructionOptions(const Format& output, const ReconstructionOptions& options);

// The same of --database, and an input of the format. Null: not known.
void RefuseIdleDatabase(const Format* input, const ReconstructionOptions& options);

// Puts them into what is asked of reader and writer. Throws Error as FindPictures does.
void SetReconstructionOptions(const ReconstructionOptions& options, ReadOptions& read);
void SetReconstructionOptions(const ReconstructionOptions& options, WriteOptions& write);

}  // namespace slamdb::cli
