// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/temporary_folder.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace slamdb {

TemporaryFolder::TemporaryFolder() {
  std::string name = ::testing::TempDir() + "slamdb_test.XXXXXX";
  if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make a temporary folder: " + name);
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string TemporaryFolder::Make(std::string_view name, std::string_view content) const {
  const std::string path = Path(name);
  std::ofstream(path, std::ios::binary) << content;
  return path;
}

std::vector<std::string> TemporaryFolder::Names() const {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(path_))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::string ReadFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::string ReadFileOrFolder(const std::string& path) {
  if (!std::filesystem::is_directory(path)) return ReadFile(path);
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(path))
    if (entry.is_regular_file()) names.push_back(entry.path().string());
  std::sort(names.begin(), names.end());
  std::string all;
  for (const std::string& name : names) all += name.substr(path.size()) + "\n" + ReadFile(name);
  return all;
}

std::string CaptureStandardOutput(const std::function<void()>& work) {
  const TemporaryFolder folder;
  std::fflush(stdout);
  const int kept = ::dup(STDOUT_FILENO);
  const int file = ::open(folder.Path("stdout").c_str(), O_CREAT | O_RDWR, 0600);
  ::dup2(file, STDOUT_FILENO);
  ::close(file);
  const auto restore = [kept] {
    ::dup2(kept, STDOUT_FILENO);
    ::close(kept);
  };
  try {
    work();
  } catch (...) {
    restore();
    throw;
  }
  restore();
  return ReadFile(folder.Path("stdout"));
}

}  // namespace slamdb
