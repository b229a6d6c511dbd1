// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "slamdb/export.h"

namespace slamdb::detail {

// The file that says that files which belong together are being replaced one after the other: in their folder, or
// beside the first of them that is moved, by its name without its suffix. Links are followed.
SLAMDB_EXPORT std::string UnfinishedIn(const std::string& folder);
SLAMDB_EXPORT std::string UnfinishedBeside(const std::string& file);
// Whether it names files. An empty one is of a program that has moved none yet, or all.
SLAMDB_EXPORT bool IsUnfinished(const std::string& unfinished);

// Whoever reads files that belong together asks before, and once it has read them.
//
// Throws Error when some may be old and some new: kLocked while a program replaces them, kDamaged when it was killed.
// `unfinished` is the path of the file, `path` what errors name. Only files whose names begin with `below` matter.
SLAMDB_EXPORT void RefuseUnfinished(const std::string& unfinished, const std::string& path,
                                    std::string_view below = "");

// The right to replace files that belong together: that file, locked. While it is empty nothing was moved; with names
// in it, each of those may be old or new. It goes with this object, unless files are left in that state.
class Unfinished {
 public:
  // Errors name `path`. Throws Error: kLocked when another program holds it; as the system has it otherwise.
  Unfinished(std::string unfinished, std::string path);
  ~Unfinished();
  Unfinished(const Unfinished&) = delete;
  Unfinished& operator=(const Unfinished&) = delete;

  // What a killed program was replacing.
  const std::vector<std::string>& left() const { return left_; }

  // From now on the files may be old or new; on disk before the first is moved. Throws Error (SystemError).
  void Begin(const std::vector<std::string>& names, bool sync);
  // All are as they were before Begin().
  void Withdraw();
  // All are new. Throws Error (SystemError) when the file still says otherwise.
  void Finish();

 private:
  bool Lock();
  bool IsStillThere() const;  // and not gone with its folder, which another one has replaced

  std::string unfinished_, path_;
  int descriptor_ = -1, slot_ = -1;
  bool begun_ = false;
  std::vector<std::string> left_;
};

}  // namespace slamdb::detail
