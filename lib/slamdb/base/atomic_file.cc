// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/descriptor.h"
#include "slamdb/base/detail/file_calls.h"
#include "slamdb/base/error.h"

namespace slamdb {
namespace {

using detail::Descriptor;

std::string FolderOf(const std::string& path) {
  const std::string folder = std::filesystem::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

void WriteAll(const std::string& path, int descriptor, Bytes bytes) {
  while (!bytes.empty()) {
    const ssize_t written = detail::CallsOfFiles().write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw SystemError(path, "cannot write");
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

}  // namespace

detail::FileCalls& detail::CallsOfFiles() {
  static FileCalls calls{.write = ::write, .fsync = ::fsync, .close = ::close, .rename = std::rename};
  return calls;
}

AtomicFile::AtomicFile(const Target& target, AtomicFileOptions options)
    : path_(target.path), sink_(target.sink), options_(options) {
  if (target.is_file())
    CreateTemporary();
  else if (!sink_)
    descriptor_ = STDOUT_FILENO;
}

void AtomicFile::CreateTemporary() {
  std::error_code ignored;
  const std::filesystem::path followed = std::filesystem::weakly_canonical(path_, ignored);
  target_ = followed.empty() ? path_ : followed.string();
  struct stat status {};
  const bool exists = ::stat(target_.c_str(), &status) == 0;
  if (exists && S_ISDIR(status.st_mode))
    throw Error(ErrorKind::kUsage, path_, "", "is a directory, expected a file to write");
  if (exists && !options_.overwrite)
    throw Error(ErrorKind::kAlreadyExists, path_, "", "is there already; WriteOptions::overwrite replaces it");
  temporary_ = target_ + ".XXXXXX";
  descriptor_ = ::mkostemp(temporary_.data(), O_CLOEXEC);
  if (descriptor_ < 0) throw SystemError(path_, "cannot create a temporary file in " + FolderOf(target_));
  const mode_t mask = ::umask(0);
  ::umask(mask);
  ::fchmod(descriptor_, exists ? status.st_mode & 07777 : 0666 & ~mask);
}

AtomicFile::~AtomicFile() {
  if (temporary_.empty()) return;
  if (descriptor_ >= 0) ::close(descriptor_);
  ::unlink(temporary_.c_str());
}

void AtomicFile::Write(Bytes bytes) {
  if (sink_)
    sink_(bytes);
  else
    WriteAll(path_, descriptor_, bytes);
  size_ += bytes.size();
}

void AtomicFile::Commit() {
  if (temporary_.empty()) {
    if (options_.before_commit) options_.before_commit();
    return;
  }
  if (options_.sync && detail::CallsOfFiles().fsync(descriptor_) != 0)
    throw SystemError(path_, "cannot be synced to disk");
  Place();
  if (options_.sync) SyncFolder();
}

// Closes the temporary file, which tells of writing that the system had put off, and renames it.
void AtomicFile::Place() {
  if (detail::CallsOfFiles().close(std::exchange(descriptor_, -1)) != 0)
    throw SystemError(path_, "cannot finish the file");
  if (options_.before_commit) options_.before_commit();
  if (detail::CallsOfFiles().rename(temporary_.c_str(), target_.c_str()) != 0)
    throw SystemError(path_, "cannot rename the finished file into place");
  temporary_.clear();
}

void AtomicFile::SyncFolder() {
  const std::string folder = FolderOf(target_);
  const Descriptor opened(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (opened.value >= 0 && detail::CallsOfFiles().fsync(opened.value) == 0) return;
  if (opened.value >= 0 && errno == EINVAL) return;  // a file system that has no way to sync a folder
  throw SystemError(path_, detail::Concat("is written, but its folder ", folder,
                                          " cannot be synced to disk, so that a power cut may lose the file"));
}

}  // namespace slamdb
