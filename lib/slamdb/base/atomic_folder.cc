// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/atomic_folder.h"

#include <fcntl.h>
#include <stdio.h>

#include <filesystem>
#include <utility>
#include <vector>

#include "slamdb/base/detail/file_calls.h"
#include "slamdb/base/detail/links.h"
#include "slamdb/base/detail/recognize.h"
#include "slamdb/base/detail/run_files.h"
#include "slamdb/base/detail/temporary_file.h"
#include "slamdb/base/error.h"

namespace slamdb {
namespace {

namespace fs = std::filesystem;

// `model/` is `model`.
std::string WithoutSlash(std::string path) {
  while (path.size() > 1 && path.ends_with('/')) path.pop_back();
  return path;
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

// A file that was made goes to its place; what was there comes to where it was made, if the system can exchange them.
struct Move {
  std::string made, place;
  bool was_there = false, exchanged = false;
};

bool Exchange(const std::string& a, const std::string& b) {
  return detail::CallsOfFiles().renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE) == 0;
}

void MakeMove(Move& move, bool sync) {
  std::error_code ignored;
  fs::create_directories(fs::path(move.place).parent_path(), ignored);
  move.was_there = fs::exists(move.place, ignored);
  move.exchanged = move.was_there && Exchange(move.made, move.place);
  if (!move.exchanged && detail::CallsOfFiles().rename(move.made.c_str(), move.place.c_str()) != 0)
    throw SystemError(move.place, "cannot rename the finished file into place");
  if (sync) detail::SyncFolderOf(move.place, move.place);
}

void TakeBack(const Move& move) {
  if (move.exchanged)
    Exchange(move.made, move.place);
  else if (!move.was_there)
    detail::CallsOfFiles().rename(move.place.c_str(), move.made.c_str());
}

}  // namespace

AtomicFolder::AtomicFolder(const Target& target, AtomicFileOptions options)
    : path_(target.path), options_(std::move(options)) {
  if (path_.empty()) throw Error(ErrorKind::kUsage, "the name of the folder to write is empty");
  if (!target.is_file())
    throw Error(ErrorKind::kUsage, path_, "", "takes one file, and this format is a folder of files; name a folder");
  target_ = detail::FollowLinks(WithoutSlash(path_)).string();
  RefuseWhatIsThere(path_, target_, options_.overwrite);
  detail::RemoveDeadTemporaryFiles(target_);
  temporary_ = std::make_unique<detail::TemporaryFolder>(target_, path_);
}

AtomicFolder::~AtomicFolder() = default;

std::unique_ptr<AtomicFile> AtomicFolder::Make(const std::string& name) {
  const fs::path place = fs::path(temporary_->path()) / name;
  std::error_code error;
  fs::create_directories(place.parent_path(), error);
  if (error) throw Error(ErrorKind::kPermission, path_, "", "cannot make a folder in it: " + error.message());
  const std::string final_place = (fs::path(target_) / name).string();
  detail::EnterOutput(final_place);
  names_.push_back(name);
  return std::make_unique<AtomicFile>(place.string(), AtomicFileOptions{.sync = options_.sync});
}

void AtomicFolder::Commit() {
  if (options_.before_commit) options_.before_commit();
  RefuseWhatIsThere(path_, target_, options_.overwrite);
  if (HoldsFiles(target_))
    MoveInto();
  else
    temporary_->Place(target_);
  for (const std::string& name : names_) detail::EnterPlaced((fs::path(target_) / name).string());
  if (options_.sync) detail::SyncFolderOf(target_, path_);
}

void AtomicFolder::MoveInto() {
  std::vector<Move> moves;
  for (const std::string& name : names_) {
    Move& move = moves.emplace_back();
    move.made = (fs::path(temporary_->path()) / name).string();
    move.place = (fs::path(target_) / name).string();
    detail::RefuseInput(move.place);
    detail::RefuseReplacingMap(move.place);
  }
  std::size_t done = 0;
  try {
    for (; done < moves.size(); ++done) MakeMove(moves[done], options_.sync);
  } catch (...) {
    while (done > 0) TakeBack(moves[--done]);
    throw;
  }
}

}  // namespace slamdb
