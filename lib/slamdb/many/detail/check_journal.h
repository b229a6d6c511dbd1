// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "slamdb/base/detail/descriptor.h"
#include "slamdb/checks/report.h"
#include "slamdb/many/check.h"
#include "slamdb/many/inputs.h"

// What checks of many atlases have found, so that one that was interrupted goes on where it stopped, and the next one
// reads what has changed since.
//
// A file of lines of JSON: what the check was asked, and then an atlas each, as in schema/check.schema.json, with what
// its content is known again by. A line that was cut off is the last, and taken away. Of two lines on one atlas the
// later one counts.
namespace slamdb::detail {

class CheckJournal {
 public:
  // Makes it where it is missing.
  //
  // Throws Error: kUsage when it is of a check with other options, or of another version; kAlreadyExists when it is
  // another file, kDamaged when a line of it is none; kLocked when another program has it; as the system has it
  // (SystemError).
  CheckJournal(const std::string& path, const CheckAtlasesOptions& options);

  // What was found when the content of the input was the same. Thread-safe.
  std::optional<CheckReport> Find(const std::string& input, const std::string& content) const;
  // Throws Error (SystemError) when the disk is full.
  void Add(const CheckedFile& file, const std::string& content);

 private:
  struct Line {
    std::uint64_t begin = 0, end = 0;
    std::string content;
  };

  void Lock() const;
  void Read(const std::string& head);
  void Enter(std::string_view text, std::uint64_t begin, std::size_t number);
  void Append(const std::string& text) const;

  const std::string path_;
  const Descriptor file_;
  std::map<std::string, Line> lines_;  // by input
};

// What the content of inputs is known by: the hash of the atlas, which stores record, or size and time of a file.
class Contents {
 public:
  explicit Contents(double lock_timeout) : lock_timeout_(lock_timeout) {}

  // Empty: it is not known, as of standard input and earlier revisions that were named.
  std::string Of(const AtlasInput& input);

 private:
  const double lock_timeout_;
  std::map<std::string, std::map<std::string, std::uint64_t>> stores_;  // hashes by name, by path
};

// Whether it is that of the atlas that was read: somebody may have saved another one since the content was asked for.
bool IsContent(const std::string& content, const AtlasInput& input, const Atlas& atlas, int threads);

}  // namespace slamdb::detail
