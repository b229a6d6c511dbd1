// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/files_together.h"

#include <fcntl.h>
#include <stdio.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <set>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/descriptor.h"
#include "slamdb/base/detail/file_calls.h"
#include "slamdb/base/detail/links.h"
#include "slamdb/base/detail/recognize.h"
#include "slamdb/base/detail/rights.h"
#include "slamdb/base/detail/run_files.h"
#include "slamdb/base/detail/unfinished.h"
#include "slamdb/base/error.h"

namespace slamdb::detail {
namespace {

namespace fs = std::filesystem;

bool IsThere(const std::string& path) {
  std::error_code missing;
  return fs::exists(fs::symlink_status(path, missing));
}

bool ExchangeFiles(const std::string& a, const std::string& b) {
  return CallsOfFiles().renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE) == 0;
}

bool Rename(const std::string& from, const std::string& to) {
  return CallsOfFiles().rename(from.c_str(), to.c_str()) == 0;
}

// Whoever works in a folder would find himself in one that is gone.
bool IsWorkedIn(const std::string& folder) {
  std::error_code failed;
  const fs::path here = fs::current_path(failed);
  if (failed) return true;
  const std::string relative = here.lexically_relative(fs::canonical(folder, failed)).string();
  return failed || (!relative.empty() && !relative.starts_with(".."));
}

void TakeRightsOf(const std::string& old, const std::string& made) {
  struct stat status {};
  if (::stat(old.c_str(), &status) != 0) return;
  const Descriptor file(::open(made.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC));
  if (file.value >= 0) TakeRights(status, file.value);  // as far as it goes
}

bool HaveSameBytes(const std::string& one, const std::string& other) {
  std::error_code failed;
  if (fs::file_size(one, failed) != fs::file_size(other, failed) || failed) return false;
  std::ifstream first(one, std::ios::binary), second(other, std::ios::binary);
  std::vector<char> left(std::size_t{1} << 16), right(left.size());
  while (first && second) {
    first.read(left.data(), static_cast<std::streamsize>(left.size()));
    second.read(right.data(), static_cast<std::streamsize>(right.size()));
    if (first.gcount() != second.gcount() || !std::equal(left.begin(), left.begin() + first.gcount(), right.begin()))
      return false;
  }
  return first.eof() && second.eof();
}

Error AlreadyThere(const std::string& place) {
  return {ErrorKind::kAlreadyExists, place, "", "is there already; WriteOptions::overwrite replaces it"};
}

bool TakeBack(const std::string& made, const std::string& place, const std::string& kept) {
  if (kept == made) return ExchangeFiles(made, place);
  return Rename(place, made) && (kept.empty() || Rename(kept, place));
}

// Makes the folders on the way to what is made in them, and removes those again that it made, unless they are kept.
class NewFolders {
 public:
  ~NewFolders() {
    std::error_code not_empty;
    for (auto folder = made_.rbegin(); folder != made_.rend(); ++folder) fs::remove(*folder, not_empty);
  }
  void Make(const fs::path& folder) {
    std::error_code missing;
    if (folder.empty() || fs::is_directory(folder, missing)) return;
    Make(folder.parent_path());
    std::error_code error;
    if (fs::create_directory(folder, error)) made_.push_back(folder);
    if (error) throw Error(ErrorKind::kPermission, folder.string(), "", "cannot be made: " + error.message());
  }
  void Keep() { made_.clear(); }

 private:
  std::vector<fs::path> made_;
};

// What a killed program was replacing has to be replaced as a whole.
void RefuseLeft(const Unfinished& unfinished, const fs::path& folder, const std::string& root,
                const std::vector<std::string>& names, const std::string& path) {
  for (const std::string& left : unfinished.left()) {
    const std::string name = (folder / left).string();
    if (std::ranges::find(names, name) == names.end() && IsThere((fs::path(root) / name).string()))
      throw Error(ErrorKind::kAlreadyExists, path, "",
                  Concat("a program that replaced its files was killed between two of them, and ", name,
                         ", which is not written now, may be old or new; remove it, or name another output"));
  }
}

}  // namespace

// A file that was made goes to its place. What was there comes to where it was made, or, where the system cannot
// exchange them, beside that.
struct FilesTogether::Move {
  std::string made, place, kept;  // `kept`: where the old one is; empty: there was none
};

FilesTogether::FilesTogether(const std::string& beside, std::string root, std::string unfinished, std::string path,
                             AtomicFileOptions options)
    : root_(std::move(root)),
      unfinished_(std::move(unfinished)),
      path_(std::move(path)),
      options_(std::move(options)),
      temporary_(beside, path_) {}

std::string FilesTogether::PlaceOf(const std::string& name) const {
  return FollowLinks(fs::path(root_) / name).string();
}

std::string FilesTogether::MadeOf(const std::string& name) const {
  return (fs::path(temporary_.path()) / name).string();
}

bool FilesTogether::IsThereAlready(const std::string& name) const { return HaveSameBytes(PlaceOf(name), MadeOf(name)); }

std::unique_ptr<AtomicFile> FilesTogether::Make(const std::string& name, Replaces replaces) {
  const fs::path made = MadeOf(name);
  std::error_code error;
  fs::create_directories(made.parent_path(), error);
  if (error) throw Error(ErrorKind::kPermission, path_, "", "cannot make a folder in it: " + error.message());
  EnterOutput(PlaceOf(name));
  names_.push_back(name);
  if (replaces == Replaces::kEqual) equal_.insert(name);
  if (unfinished_.empty()) unfinished_ = UnfinishedBeside(PlaceOf(name));
  return std::make_unique<AtomicFile>(made.string(), AtomicFileOptions{.sync = options_.sync});
}

void FilesTogether::Place() {
  if (IsThere(root_) && IsWorkedIn(root_)) return Replace(/*whole=*/false);
  SyncFolders(temporary_.path());
  temporary_.Place(root_);
  for (const std::string& name : names_) EnterPlaced(PlaceOf(name));
}

void FilesTogether::Replace(bool whole) {
  KeepDatabases();
  RefusePlaces();
  TakeRightsOfOld();
  if (!whole || !Exchange()) MoveEach();
  for (const std::string& name : names_) EnterPlaced(PlaceOf(name));
}

// Nothing replaces a database, and one that is as it was made needs not to be: a killed run may have moved it there.
// Whoever has it open goes on with it.
void FilesTogether::KeepDatabases() {
  if (!options_.overwrite) return;
  for (const std::string& name : names_)
    if (const std::string place = PlaceOf(name);
        IsDatabase(place) && LogOfDatabase(place).empty() && IsThereAlready(name))
      staying_.insert(name);
}

void FilesTogether::RefusePlaces() const {
  for (const std::string& name : names_) {
    const std::string place = PlaceOf(name);
    RefuseInput(place);
    if (!staying_.contains(name)) RefuseReplacingMap(place);
    if (IsDatabase(MadeOf(name))) RefuseLogOfAnother(place);
    if (!options_.overwrite && IsThere(place)) throw AlreadyThere(place);
    std::error_code missing;
    if (fs::exists(place, missing) && !fs::is_regular_file(place, missing))
      throw Error(ErrorKind::kUsage, place, "", "is no file, where one is to be written; name another output");
    if (equal_.contains(name) && IsThere(place) && !IsThereAlready(name))
      throw Error(ErrorKind::kAlreadyExists, place, "",
                  "is another file than the one that is written, and may be the only one of its kind; nothing replaces "
                  "it: remove it, or name another output");
  }
}

void FilesTogether::TakeRightsOfOld() const {
  for (const std::string& name : names_) TakeRightsOf(PlaceOf(name), MadeOf(name));
}

// ---- the whole folder at once

bool FilesTogether::HoldsOnlyThese(const std::string& folder) const {
  const std::set<std::string> names(names_.begin(), names_.end());
  const std::vector<std::string> folders = Folders();
  const std::string unfinished = fs::path(unfinished_).filename().string();
  std::error_code failed;
  for (fs::recursive_directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed)) {
    const std::string name = entry->path().lexically_relative(folder).string();
    const bool is_folder = entry->is_directory(failed) && !entry->is_symlink(failed);
    if (is_folder && std::ranges::find(folders, name) != folders.end()) continue;
    if (!entry->is_regular_file(failed) || entry->is_symlink(failed) || (!names.contains(name) && name != unfinished))
      return false;
  }
  return !failed;
}

// False: it is not to be, or cannot be, and nothing is changed.
bool FilesTogether::Exchange() {
  if (!staying_.empty() || IsWorkedIn(root_) || !HoldsOnlyThese(root_)) return false;
  const Unfinished unfinished(unfinished_, path_);
  for (const std::string& folder : Folders())
    TakeRightsOf((fs::path(root_) / folder).string(), (fs::path(temporary_.path()) / folder).string());
  SyncFolders(temporary_.path());
  if (!temporary_.Exchange(root_)) return false;
  if (HoldsOnlyThese(temporary_.path())) return true;
  temporary_.Exchange(root_);  // somebody put a file there meanwhile
  return false;
}

// ---- one file after the other

void FilesTogether::MakeMove(Move& move) const {
  if (!options_.overwrite) {
    if (RenameToNew(move.made, move.place)) return;
    if (errno == EEXIST) throw AlreadyThere(move.place);
  } else {
    move.kept = IsThere(move.place) ? move.made : "";
    if (!move.kept.empty() && ExchangeFiles(move.made, move.place)) return;
    if (!move.kept.empty()) move.kept += ".old";
    if ((move.kept.empty() || Rename(move.place, move.kept)) && Rename(move.made, move.place)) return;
    if (!move.kept.empty() && !IsThere(move.place)) Rename(move.kept, move.place);
  }
  throw SystemError(move.place, "cannot rename the finished file into place");
}

// Those that programs left which were killed while they replaced files of a folder in the root.
std::vector<std::unique_ptr<Unfinished>> FilesTogether::UnfinishedBelow() const {
  std::vector<std::unique_ptr<Unfinished>> below;
  for (const std::string& folder : Folders()) {
    const std::string unfinished = UnfinishedIn(PlaceOf(folder));
    if (folder.empty() || !IsThere(unfinished)) continue;
    below.push_back(std::make_unique<Unfinished>(unfinished, path_));
    RefuseLeft(*below.back(), folder, root_, names_, path_);
  }
  return below;
}

void FilesTogether::MoveEach() {
  Unfinished unfinished(unfinished_, path_);
  RefuseLeft(unfinished, "", root_, names_, path_);
  const std::vector<std::unique_ptr<Unfinished>> below = UnfinishedBelow();
  unfinished.Begin(names_, options_.sync);
  NewFolders folders;
  std::vector<Move> moved;
  try {
    for (const std::string& name : names_) {
      if (staying_.contains(name)) continue;
      Move move{.made = MadeOf(name), .place = PlaceOf(name), .kept = ""};
      folders.Make(fs::path(move.place).parent_path());
      MakeMove(move);
      moved.push_back(std::move(move));
    }
    SyncFolders(root_);
  } catch (...) {
    bool all = true;
    for (auto move = moved.rbegin(); move != moved.rend(); ++move)
      all = TakeBack(move->made, move->place, move->kept) && all;
    if (all) unfinished.Withdraw();
    throw;
  }
  folders.Keep();
  for (const auto& mended : below) mended->Finish();
  for (const std::string& folder : Folders())
    if (!below.empty()) RemoveDeadTemporaryFiles(PlaceOf(folder));
  unfinished.Finish();
}

// ---- power cuts

// Those that hold a file of the root, and the root.
std::vector<std::string> FilesTogether::Folders() const {
  std::set<std::string> folders = {""};
  for (const std::string& name : names_)
    for (fs::path folder = fs::path(name).parent_path(); !folder.empty(); folder = folder.parent_path())
      folders.insert(folder.string());
  return {folders.begin(), folders.end()};
}

void FilesTogether::SyncFolders(const std::string& root) const {
  if (!options_.sync) return;
  for (const std::string& folder : Folders()) SyncFolderOf((fs::path(root) / folder / "file").string(), path_);
}

}  // namespace slamdb::detail
