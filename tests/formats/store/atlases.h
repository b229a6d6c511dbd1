// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "slamdb/base/error.h"
#include "slamdb/formats/store/store.h"
#include "slamdb/model/atlas.h"
#include "tests/support/equals_atlas.h"
#include "tests/support/temporary_folder.h"

namespace slamdb::store_test {

using slamdb::TemporaryFolder;

// Everything that a format can hold and that is hard to keep: NaNs with payload, -0.0, infinities, flags that are
// neither 0 nor 1, ids that repeat, dangle, are none or need 64 bits, empty maps and cameras, irregular list entries,
// lists out of order, columns of different lengths, grids that follow from the keypoints and grids that do not.
Atlas OddAtlas();

// A sound atlas of two maps.
Atlas SoundAtlas();

std::string FileBytes(const std::string& path);

// Saves in a fresh store, or in the one that is there, without waiting for the disk.
SaveReport SaveIn(const std::string& path, const Atlas& atlas, const std::string& name = "a");
Atlas LoadFrom(const std::string& path, const std::string& name = "a", const ReadOptions& options = {});

// Step by step, each as a slamdb of that version takes it; keeps no backup.
void MigrateBackTo(const std::string& path, int version);

// What `work` throws; empty when it throws nothing.
template <class Work>
std::string ErrorOf(Work work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

// Runs SQL on a file through a plain connection, as a person with `sqlite3` would. Rows are joined by `;`, columns by
// `|`.
std::string Sql(const std::string& path, const std::string& sql);

// Runs `work` in a child process; returns its exit status as waitpid gives it.
int InChild(void (*work)(const std::string&), const std::string& argument);

}  // namespace slamdb::store_test
