// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "slamdb/base/atomic_file.h"
#include "slamdb/base/atomic_folder.h"
#include "slamdb/base/detail/temporary_file.h"
#include "slamdb/base/detail/unfinished.h"

namespace slamdb::detail {

// Files that belong together: made in a temporary folder, then moved to their places one after the other, while they
// are Unfinished. What fails takes those back that were moved; what is killed leaves the file that says so.
class FilesTogether {
 public:
  // The temporary folder is beside `beside`; names of files are relative to `root`; `unfinished` is the path of
  // that file; empty: the one beside the first file. Errors name `path`.
  FilesTogether(const std::string& beside, std::string root, std::string unfinished, std::string path,
                AtomicFileOptions options);

  std::unique_ptr<AtomicFile> Make(const std::string& name, Replaces replaces = Replaces::kOthers);
  const std::vector<std::string>& names() const { return names_; }

  // Gives the temporary folder the name of the root, where nothing or an empty folder is that nobody works in.
  void Place();
  // Puts the files among those of the root: by exchanging the folders, where `whole` and the old one holds nothing but
  // files of these names, else one by one.
  void Replace(bool whole);

 private:
  struct Move;

  std::string PlaceOf(const std::string& name) const;
  std::string MadeOf(const std::string& name) const;
  // Whether its place has the very bytes that were made.
  bool IsThereAlready(const std::string& name) const;
  bool HoldsOnlyThese(const std::string& folder) const;
  bool Exchange();
  std::vector<std::unique_ptr<Unfinished>> UnfinishedBelow() const;
  void MoveEach();
  void MakeMove(Move& move) const;
  std::vector<std::string> Folders() const;
  void SyncFolders(const std::string& root) const;
  void RefusePlaces() const;
  void KeepDatabases();
  void TakeRightsOfOld() const;

  std::string root_, unfinished_, path_;
  AtomicFileOptions options_;
  TemporaryFolder temporary_;
  std::vector<std::string> names_;         // in the order in which they were asked for
  std::set<std::string> equal_, staying_;  // of those that replace none but equal ones; whose place is not touched
};

}  // namespace slamdb::detail
