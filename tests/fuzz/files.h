// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <unistd.h>

#include <array>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

// What fuzzers of formats that are several files share.
namespace slamdb::fuzz {

inline constexpr std::string_view kFileMark = "\x1e<FILE>\x1e";

// Several files in one input, with a mark between them; those that are not there are empty.
template <std::size_t count>
std::array<std::string, count> SplitFiles(std::string_view input) {
  std::array<std::string, count> files;
  for (std::string& file : files) {
    const std::size_t end = input.find(kFileMark);
    file = input.substr(0, end);
    input.remove_prefix(end == input.npos ? input.size() : end + kFileMark.size());
  }
  return files;
}

template <class Files>
std::string JoinFiles(const Files& files) {
  std::string input;
  for (const std::string& file : files) input.append(file).append(kFileMark);
  return input;
}

// A folder of this process, on a file system in memory where there is one.
class Folder {
 public:
  explicit Folder(const std::string& name)
      : path_(Base() / (name + "_" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(path_);
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::string Path(std::string_view name) const { return (path_ / name).string(); }
  void Write(std::string_view name, std::string_view bytes) const {
    std::ofstream(path_ / name, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  }

 private:
  static std::filesystem::path Base() {
    return std::filesystem::is_directory("/dev/shm") ? "/dev/shm" : std::filesystem::temp_directory_path();
  }

  std::filesystem::path path_;
};

}  // namespace slamdb::fuzz
