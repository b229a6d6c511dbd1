// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/file_calls.h"
#include "slamdb/base/detail/links.h"
#include "slamdb/base/detail/rights.h"
#include "slamdb/base/detail/run_files.h"
#include "slamdb/base/detail/server.h"
#include "slamdb/base/detail/temporary_file.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"

namespace slamdb {
namespace {

using detail::CallsOfFiles;

void WriteAll(const std::string& path, int descriptor, Bytes bytes) {
  while (!bytes.empty()) {
    const ssize_t written = CallsOfFiles().write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw SystemError(path, "cannot write");
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

// nullopt: nothing is there.
std::optional<struct stat> StatusOf(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return std::nullopt;
  return status;
}

void RefuseReplacing(const std::string& path, const std::string& target, const AtomicFileOptions& options) {
  if (!options.overwrite)
    throw Error(ErrorKind::kAlreadyExists, path, "", "is there already; WriteOptions::overwrite replaces it");
  if (detail::IsDatabase(target))
    throw Error(
        ErrorKind::kAlreadyExists, path, "",
        "is an SQLite database, a store of atlases perhaps, which no single file replaces; name another output, "
        "or remove it first");
}

// The number of `/proc/self/fd/N`.
std::optional<int> OwnDescriptor(const std::filesystem::path& followed) {
  if (followed.parent_path() != detail::Concat("/proc/", ::getpid(), "/fd")) return std::nullopt;
  return detail::ParseNumber<int>(followed.filename().native());
}

}  // namespace

detail::FileCalls& detail::CallsOfFiles() {
  static FileCalls calls{.write = ::write,
                         .fsync = ::fsync,
                         .close = ::close,
                         .rename = std::rename,
                         .renameat2 = ::renameat2,
                         .link = ::link,
                         .unlink = ::unlink};
  return calls;
}

bool IsSpecialFile(const std::string& path) {
  if (detail::IsServer(path)) return false;
  if (detail::IsOpenFile(detail::FollowLinks(path))) return true;
  const auto status = StatusOf(path);
  return status && !S_ISREG(status->st_mode) && !S_ISDIR(status->st_mode);
}

AtomicFile::AtomicFile(const Target& target, AtomicFileOptions options)
    : path_(target.path), sink_(target.sink), options_(std::move(options)) {
  if (target.is_file())
    Open();
  else if (!sink_)
    descriptor_ = STDOUT_FILENO;
}

void AtomicFile::Open() {
  if (path_.empty()) throw Error(ErrorKind::kUsage, "the name of the file to write is empty");
  detail::RequireFile(path_);
  target_ = detail::FollowLinks(path_).string();
  std::error_code missing;
  if (std::filesystem::is_symlink(std::filesystem::symlink_status(target_, missing)) && !detail::IsOpenFile(target_))
    throw Error(ErrorKind::kNotFound, path_, "",
                "is a symbolic link into a folder that is not there, or a ring of them");
  special_ = IsSpecialFile(target_);
  if (special_) return OpenSpecial();
  const auto old = StatusOf(target_);
  if (target_.ends_with('/') || (old && S_ISDIR(old->st_mode)))
    throw Error(ErrorKind::kUsage, path_, "", "is a directory, expected a file to write");
  detail::EnterOutput(path_);
  detail::RemoveDeadTemporaryFiles(target_);
  if (old) RefuseReplacing(path_, target_, options_);
  temporary_ = std::make_unique<detail::TemporaryFile>(target_, old ? S_IRUSR | S_IWUSR : 0666, path_);
  descriptor_ = temporary_->descriptor();
  if (old) detail::TakeRights(*old, descriptor_);  // as far as it goes
}

// An open file of this process is shared with whoever else writes to it; opening its path would begin at its beginning.
void AtomicFile::OpenSpecial() {
  if (const auto number = OwnDescriptor(target_))
    descriptor_ = ::fcntl(*number, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  else
    descriptor_ = ::open(target_.c_str(), O_WRONLY | O_APPEND | O_NOCTTY | O_CLOEXEC);
  if (descriptor_ < 0) throw SystemError(path_, "cannot open to write");
}

AtomicFile::~AtomicFile() {
  if (special_ && descriptor_ >= 0) ::close(descriptor_);
}

void AtomicFile::Write(Bytes bytes) {
  if (sink_)
    sink_(bytes);
  else
    WriteAll(path_, descriptor_, bytes);
  size_ += bytes.size();
}

void AtomicFile::Commit() {
  if (temporary_ == nullptr) return CommitSpecial();
  if (options_.sync && CallsOfFiles().fsync(descriptor_) != 0) throw SystemError(path_, "cannot be synced to disk");
  if (temporary_->Close() != 0) throw SystemError(path_, "cannot finish the file");
  if (options_.before_commit) options_.before_commit();
  Place();
  if (options_.sync) detail::SyncFolderOf(target_, path_);
}

void AtomicFile::CommitSpecial() {
  if (special_ && CallsOfFiles().close(std::exchange(descriptor_, -1)) != 0)
    throw SystemError(path_, "cannot finish writing");
  if (options_.before_commit) options_.before_commit();
}

// What is there is looked at once more: hours may have passed.
void AtomicFile::Place() {
  detail::RefuseInput(path_);
  if (detail::IsDatabase(temporary_->path())) detail::RefuseLogOfAnother(target_);
  if (!options_.overwrite) {
    temporary_->Claim(target_);
  } else {
    if (StatusOf(target_)) RefuseReplacing(path_, target_, options_);
    temporary_->Replace(target_);
  }
  detail::EnterPlaced(path_);
}

}  // namespace slamdb
