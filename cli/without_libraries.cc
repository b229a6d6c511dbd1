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
  const fs::path folder = fs::read_symlink("/proc/self/exe").parent_path();
  const fs::path installed = folder.parent_path() / "libexec/slamdb/slamdb";
  for (const fs::path& program : {folder / "libexec/slamdb/slamdb", installed})  // the first: in a build folder
    ::execv(program.c_str(), pointers.data());
  throw SystemError(installed.string(),
                    "cannot start the program of slamdb that has Cairo, Ceres and OpenCV, which this verb needs");
}

}  // namespace slamdb::cli
