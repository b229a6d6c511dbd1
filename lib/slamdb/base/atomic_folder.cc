// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/atomic_folder.h"

#include <filesystem>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/files_together.h"
#include "slamdb/base/detail/links.h"
#include "slamdb/base/detail/temporary_file.h"
#include "slamdb/base/detail/unfinished.h"
#include "slamdb/base/error.h"

namespace slamdb {
namespace {

namespace fs = std::filesystem;

// `model/` is `model`.
std::string WithoutSlash(std::string path) {
  while (path.size() > 1 && path.ends_with('/')) path.pop_back();
  return path;
}

// Where the folder is, or will be. One that is there may go by a name that nothing is beside, as `.`.
std::string PlaceOf(const std::string& path) {
  std::error_code missing;
  const fs::path there = fs::canonical(path, missing);
  return missing ? detail::FollowLinks(WithoutSlash(path)).string() : there.string();
}

bool HoldsFiles(const std::string& folder) {
  std::error_code missing;
  return fs::is_directory(folder, missing) && !fs::is_empty(folder, missing);
}

void RefuseWhatIsThere(const std::string& path, const std::string& target, bool overwrite) {
  std::error_code missing;
  const fs::file_status status = fs::status(target, missing);
  if (fs::exists(status) && !fs::is_directory(status))
    throw Error(ErrorKind::kUsage, path, "", "is a file, expected a folder to write; name another output");
  if (!overwrite && HoldsFiles(target))
    throw Error(ErrorKind::kAlreadyExists, path, "",
                "is there already and holds files; WriteOptions::overwrite replaces those of the same names");
}

}  // namespace

AtomicFolder::AtomicFolder(const Target& target, AtomicFileOptions options)
    : path_(target.path), options_(std::move(options)) {
  if (path_.empty()) throw Error(ErrorKind::kUsage, "the name of the folder to write is empty");
  if ((sink_ = target.sink)) return;
  if (!target.is_file())
    throw Error(ErrorKind::kUsage, path_, "", "takes one file, and this format is a folder of files; name a folder");
  target_ = PlaceOf(path_);
  RefuseWhatIsThere(path_, target_, options_.overwrite);
  detail::RemoveDeadTemporaryFiles(target_);
  files_ = std::make_unique<detail::FilesTogether>(target_, target_, detail::UnfinishedIn(target_), path_, options_);
}

AtomicFolder::~AtomicFolder() = default;

std::unique_ptr<AtomicFile> AtomicFolder::Make(const std::string& name, Replaces replaces) {
  if (files_ == nullptr) return std::make_unique<AtomicFile>(Target(sink_, name));
  return files_->Make(name, replaces);
}

void AtomicFolder::Commit() {
  if (files_ == nullptr) return;
  if (options_.before_commit) options_.before_commit();
  RefuseWhatIsThere(path_, target_, options_.overwrite);
  if (HoldsFiles(target_))
    files_->Replace(/*whole=*/true);
  else
    files_->Place();
  detail::RemoveDeadTemporaryFiles(target_);  // those that a claim kept
  if (options_.sync) detail::SyncFolderOf(target_, path_);
}

AtomicFiles::AtomicFiles(const Target& target, AtomicFileOptions options)
    : path_(target.path), options_(std::move(options)) {
  if (path_.empty()) throw Error(ErrorKind::kUsage, "the name of the file to write is empty");
  std::error_code missing;
  if (!fs::path(path_).has_filename() || fs::is_directory(path_, missing))
    throw Error(ErrorKind::kUsage, path_, "", "is a directory, expected a file to write");
  target_ = detail::LeadsTo(path_);
  if ((sink_ = target.sink)) return;
  detail::RemoveDeadTemporaryFiles(target_);
  files_ = std::make_unique<detail::FilesTogether>(target_, detail::FolderOf(target_).string(), "", path_, options_);
}

AtomicFiles::~AtomicFiles() = default;

std::unique_ptr<AtomicFile> AtomicFiles::Make(const std::string& name) {
  if (files_ == nullptr) {
    const bool is_target = name == fs::path(target_).filename();
    return std::make_unique<AtomicFile>(Target(
        is_target ? sink_ : [](Bytes) {}, name));
  }
  std::error_code missing;
  const fs::path place = detail::FolderOf(target_) / name;
  if (!options_.overwrite && fs::exists(fs::symlink_status(place, missing)))
    throw Error(ErrorKind::kAlreadyExists, path_, "",
                detail::Concat(name == fs::path(path_).filename() ? std::string() : name + ", which goes with it, ",
                               "is there already; WriteOptions::overwrite replaces it"));
  return files_->Make(name);
}

std::unique_ptr<AtomicFile> AtomicFiles::MakeTarget() { return Make(fs::path(target_).filename().string()); }

void AtomicFiles::Commit() {
  if (files_ == nullptr) return;
  if (options_.before_commit) options_.before_commit();
  files_->Replace(/*whole=*/false);
  detail::RemoveDeadTemporaryFiles(target_);  // those that a claim kept
}

}  // namespace slamdb
