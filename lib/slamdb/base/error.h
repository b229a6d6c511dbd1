// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

#include "slamdb/export.h"

namespace slamdb {

// What went wrong, for programs to act on.
enum class ErrorKind {
  kNotFound,        // no such file, folder, atlas of a store, or entity
  kAlreadyExists,   // the target is there, and overwriting was not asked for
  kPermission,      // the system denies it: rights, a read-only disk
  kDamaged,         // bytes that cannot be what they claim: truncated, overwritten, not an atlas at all
  kUnsupported,     // sound, but of a newer version, another fork, another program
  kLocked,          // another program is at work on it; trying again later may help
  kOutOfResources,  // memory, disk space, open files
  kUsage,           // the caller asks for what makes no sense: options, arguments, texts it gave
  kNotPossible,     // sensible, but this input does not allow it: too few pairs, vocabularies that differ
  kInternal,        // a fault of slamdb
};

// `not found`, `already exists`, `permission`, `damaged`, `unsupported`, `locked`, `out of resources`, `usage`,
// `not possible`, `internal`.
SLAMDB_EXPORT std::string_view ToString(ErrorKind kind);

// The one exception type of the library.
// what() reads `<path>: <place>: <problem>`, with empty parts left out.
//
// Immutable, and so safe to share between threads. No part shows the password of a server, whoever made the error.
class SLAMDB_EXPORT Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, std::string problem) : Error(kind, "", "", std::move(problem)) {}
  Error(ErrorKind kind, std::string path, std::string place, std::string problem);

  ErrorKind kind() const { return kind_; }
  // The file that was read or written.
  const std::string& path() const { return path_; }
  // Where in it: `byte 48213, map 0, kf 77, descriptors`, or `table map_point, row 12`.
  const std::string& place() const { return place_; }
  // What is wrong, what was expected and found, and the likely cause or the remedy.
  const std::string& problem() const { return problem_; }

 private:
  ErrorKind kind_;
  std::string path_, place_, problem_;
};

// An error with the text of errno behind the problem: `cannot open: No such file or directory`.
// Its kind is that of errno: ENOENT is kNotFound, EACCES kPermission, ENOSPC kOutOfResources, and so on.
SLAMDB_EXPORT Error SystemError(const std::string& path, const std::string& problem);

}  // namespace slamdb
