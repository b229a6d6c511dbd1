// SPDX-License-Identifier: BSD-3-Clause
#include <sys/auxv.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <string>

#include "cli/libraries.h"
#include "slamdb/base/error.h"

namespace slamdb::cli {
namespace {

namespace fs = std::filesystem;

char** own_words = nullptr;

// The folder of this program, also where there is no /proc.
fs::path OwnFolder() {
  std::error_code unknown;
  fs::path program = fs::read_symlink("/proc/self/exe", unknown);
  if (unknown) program = fs::canonical(reinterpret_cast<const char*>(::getauxval(AT_EXECFN)), unknown);
  return program.parent_path();
}

}  // namespace

void RememberWords(char** words) { own_words = words; }

void GoOnWithLibraries() {
  std::error_code unknown;
  const fs::path folder = OwnFolder();
  const fs::path beside = folder / "libexec/slamdb/slamdb";  // in a build folder
  const fs::path program = fs::exists(beside, unknown) ? beside : folder.parent_path() / "libexec/slamdb/slamdb";
  ::execv(program.c_str(), own_words);
  const bool missing = errno == ENOENT;
  throw SystemError(program.string(),
                    "this needs Cairo, Ceres, OpenCV or libpq, and with them slamdb's second program" +
                        std::string(missing ? ", which belongs here: install both" : ""));
}

}  // namespace slamdb::cli
