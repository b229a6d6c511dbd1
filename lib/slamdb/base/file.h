// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "slamdb/export.h"

namespace slamdb {

using Bytes = std::span<const std::byte>;

// What is read: a file, `-` for standard input, or bytes in memory, which are not copied and must outlive the reading.
struct Source {
  Source(std::string file) : path(std::move(file)) {}  // NOLINT(google-explicit-constructor): a path is a source
  Source(const char* file) : path(file) {}             // NOLINT(google-explicit-constructor)
  Source(std::string file, std::string atlas) : path(std::move(file)), name(std::move(atlas)) {}
  Source(Bytes bytes, std::string called) : path(std::move(called)), memory(bytes) {}

  std::string path;             // of bytes in memory: what errors call them
  std::string name;             // of the atlas that is meant, where a file holds several; empty: the only one
  std::optional<Bytes> memory;  // nullopt: a file

  bool is_file() const { return !memory && path != "-"; }
};

// Where bytes go: a file, `-` for standard output, or a function that takes them in order.
struct Target {
  using Sink = std::function<void(Bytes)>;

  Target(std::string file) : path(std::move(file)) {}  // NOLINT(google-explicit-constructor): a path is a target
  Target(const char* file) : path(file) {}             // NOLINT(google-explicit-constructor)
  Target(std::string file, std::string atlas) : path(std::move(file)), name(std::move(atlas)) {}
  Target(Sink to, std::string called) : path(std::move(called)), sink(std::move(to)) {}

  std::string path;  // with a sink: what errors call it
  std::string name;  // of the atlas that is written, where a file holds several
  Sink sink;         // empty: a file

  bool is_file() const { return !sink && path != "-"; }
};

// The bytes of a source, all of them at hand: a file is mapped, standard input is read into memory.
// Opening never changes a file.
// A file that another program shortens while it is mapped raises SIGBUS, as with every mapping.
//
// Throws Error: kNotFound when the path is missing; kUsage when it is a directory or no regular file; kPermission and
// others as the system has it (SystemError); kOutOfResources when standard input does not fit into memory.
class SLAMDB_EXPORT MappedFile {
 public:
  explicit MappedFile(const Source& source);
  ~MappedFile();
  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&& other) noexcept;

  Bytes bytes() const { return bytes_; }
  std::string_view text() const { return {reinterpret_cast<const char*>(bytes_.data()), bytes_.size()}; }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  Bytes bytes_;
  bool mapped_;  // by this object; otherwise the bytes are somebody else's
};

// The first bytes of a source: what a format looks at to say whether it is its own.
struct Probe {
  std::string path;
  std::string head;        // up to 4096 bytes
  std::uint64_t size = 0;  // of the file
  bool is_directory = false;
  std::optional<Bytes> memory;  // of a source in memory, all of it

  // Standard input (`-`) gives an empty head.
  //
  // Throws Error when the path is missing (kNotFound) or cannot be opened (kPermission and others, see SystemError).
  SLAMDB_EXPORT static Probe Of(const Source& source);
};

}  // namespace slamdb
