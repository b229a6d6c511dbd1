// SPDX-License-Identifier: BSD-3-Clause
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "cli/libraries.h"
#include "slamdb/base/error.h"

namespace slamdb::cli {
namespace {

// The words that this process was started with.
std::vector<std::string> OwnWords() {
  std::ifstream stream("/proc/self/cmdline", std::ios::binary);
  std::vector<std::string> words;
  for (std::string word; std::getline(stream, word, '\0');) words.push_back(word);
  return words;
}

}  // namespace

void GoOnWithLibraries() {
  namespace fs = std::filesystem;
  std::vector<std::string> words = OwnWords();
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  std::error_code unknown;
  const fs::path folder = fs::read_symlink("/proc/self/exe", unknown).parent_path();
  if (unknown)
    throw Error(
        ErrorKind::kNotPossible, "/proc/self/exe", "",
        "cannot be read: by it slamdb finds its program that has Cairo, Ceres and OpenCV, which this verb needs");
  const fs::path beside = folder / "libexec/slamdb/slamdb";  // in a build folder
  const fs::path program = fs::exists(beside, unknown) ? beside : folder.parent_path() / "libexec/slamdb/slamdb";
  ::execv(program.c_str(), pointers.data());
  throw SystemError(program.string(),
                    "cannot start the program of slamdb that has Cairo, Ceres and OpenCV, which this verb needs");
}

}  // namespace slamdb::cli
