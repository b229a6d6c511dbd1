// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace slamdb {

// A folder of its own for one test, in one process, removed with everything in it.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::string Path(std::string_view name) const { return (path_ / name).string(); }
  std::string operator/(std::string_view name) const { return Path(name); }
  std::string Make(std::string_view name, std::string_view content) const;  // writes a file, gives its path
  std::vector<std::string> Names() const;                                   // what is in it, sorted

 private:
  std::filesystem::path path_;
};

std::string ReadFile(const std::string& path);
// Of a folder: the names of all files in it, each with its bytes behind it, sorted.
std::string ReadFileOrFolder(const std::string& path);

// What `work` writes to file descriptor 1.
std::string CaptureStandardOutput(const std::function<void()>& work);

}  // namespace slamdb
