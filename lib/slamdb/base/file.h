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

// The most bytes that are read of a stream: standard input, a FIFO, a device. A file may be larger.
inline constexpr std::uint64_t kMostStreamBytes = std::uint64_t{2} << 30;

struct Probe;

// The bytes of a source, all of them, read into memory; those of a source in memory stay where they are.
// Reading never changes a file. One that another program shortens meanwhile gives an Error.
//
// Throws Error: kNotFound when the path is missing; kUsage when it is a directory, a block device or a socket;
// kPermission and others as the system has it (SystemError); kDamaged when the file becomes shorter while it is read;
// kNotPossible for a FIFO that nothing writes into; kOutOfResources when the bytes do not fit into memory, or those of
// a stream are more than kMostStreamBytes.
class SLAMDB_EXPORT WholeFile {
 public:
  // Sees the beginning of a stream, 64 kB of it, before the rest is read; may throw.
  using Look = std::function<void(const Probe&)>;

  explicit WholeFile(const Source& source, const Look& look = {});
  ~WholeFile();
  WholeFile(WholeFile&& other) noexcept;
  WholeFile& operator=(WholeFile&& other) noexcept;

  Bytes bytes() const { return bytes_; }
  std::string_view text() const { return {reinterpret_cast<const char*>(bytes_.data()), bytes_.size()}; }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  Bytes bytes_;
  std::size_t reserved_ = 0;  // bytes of a mapping that is this object's; 0: the bytes are somebody else's
};

// A source that can be looked at, and then read: the bytes of a stream, which come once, are read into memory. A file,
// and bytes in memory, are as they were.
//
// Throws Error as WholeFile does, and what `look` throws.
class SLAMDB_EXPORT HeldSource {
 public:
  explicit HeldSource(Source source, const WholeFile::Look& look = {});
  const Source& source() const { return source_; }

 private:
  Source source_;
  std::optional<WholeFile> stream_;
};

// The first bytes of a source: what a format looks at to say whether it is its own.
struct Probe {
  std::string path;
  std::string head;        // up to 64 kB
  std::uint64_t size = 0;  // of the file
  bool is_directory = false;
  std::optional<Bytes> memory;  // of a source in memory, all of it

  // Of a stream that is not held, nothing: an empty head.
  //
  // Throws Error when the path is missing (kNotFound) or cannot be opened (kPermission and others, see SystemError),
  // and for a block device or a socket (kUsage).
  SLAMDB_EXPORT static Probe Of(const Source& source);
};

}  // namespace slamdb
