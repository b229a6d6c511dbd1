// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>

namespace slamdb {

// The one exception type of the library. what() reads `<path>: <place>: <problem>`, with empty parts left out.
//   path     the file that was read or written
//   place    where in it: `byte 48213, map 0, kf 77, descriptors`, or `table map_point, row 12`
//   problem  what is wrong, what was expected and found, and the likely cause or the remedy
// Immutable, and so safe to share between threads.
class Error : public std::runtime_error {
 public:
  explicit Error(std::string problem) : Error("", "", std::move(problem)) {}
  Error(std::string path, std::string place, std::string problem);

  const std::string& path() const { return path_; }
  const std::string& place() const { return place_; }
  const std::string& problem() const { return problem_; }

 private:
  std::string path_, place_, problem_;
};

// An error with the text of errno behind the problem: `cannot open: No such file or directory`.
Error SystemError(const std::string& path, const std::string& problem);

}  // namespace slamdb
