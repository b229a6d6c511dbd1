// SPDX-License-Identifier: BSD-3-Clause
// What slamdb is held against: plain Boost, the limits of the machine, and what other programs do with the same bytes.
#include "bench/references.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <span>

#include "bench/plain_sqlite.h"
#include "bench/process.h"
#include "bench/timing.h"
#include "slamdb/base/column.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/base/error.h"
#include "slamdb/base/file.h"
#include "slamdb/formats/formats.h"
#include "tests/support/boost_reference/boost_reference.h"

namespace slamdb::bench {
namespace {

using reference::Encoding;

// ---- plain Boost

Sample ReadBinary(const Workplace& at) {
  return Time([&] { Keep(reference::Load(at.binary(), Encoding::kBinary)); });
}
Sample ReadText(const Workplace& at) {
  return Time([&] { Keep(reference::Load(at.text(), Encoding::kText)); });
}
Sample ReadMemory(const Workplace& at) {
  return WatchMemory([&] { Keep(reference::Load(at.binary(), Encoding::kBinary)); });
}
Sample WriteAs(const Workplace& at, Encoding encoding) {
  const Atlas atlas = ReadAtlas(at.binary());
  std::filesystem::remove(at.output());
  return Time([&] { reference::Save(atlas, at.output(), encoding); });
}
Sample WriteBinary(const Workplace& at) { return WriteAs(at, Encoding::kBinary); }
Sample WriteText(const Workplace& at) { return WriteAs(at, Encoding::kText); }

// ---- the same bytes from the page cache into memory: by read(), which is faster than mapping the file

constexpr std::size_t kBlock = std::size_t{256} << 10;  // stays in the caches of a core

class Descriptor {
 public:
  Descriptor(const std::string& path, int flags) : path_(path), number_(open(path.c_str(), flags | O_CLOEXEC, 0666)) {
    if (number_ < 0) throw SystemError(path, "cannot open");
  }
  ~Descriptor() { close(number_); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  int number() const { return number_; }
  void Read(std::span<char> into, std::size_t from) const {
    while (!into.empty()) {
      const ssize_t got = pread(number_, into.data(), into.size(), static_cast<off_t>(from));
      if (got <= 0) throw SystemError(path_, "cannot read");
      into = into.subspan(static_cast<std::size_t>(got));
      from += static_cast<std::size_t>(got);
    }
  }

 private:
  const std::string path_;
  const int number_;
};

void CopyInto(const std::string& path, std::span<char> memory) {
  const Descriptor file(path, O_RDONLY);
  detail::ParallelFor(memory.size(), kBlock, 0, [&](std::size_t begin, std::size_t end) {
    for (; begin < end; begin += kBlock) file.Read(memory.subspan(begin, std::min(kBlock, end - begin)), begin);
  });
}

// Huge pages, as the reader of atlases uses.
std::span<char> FreshMemory(std::size_t bytes) { return {static_cast<char*>(AllocateColumn(bytes)), bytes}; }

Sample Copy(const Workplace& at) {
  const std::size_t bytes = std::filesystem::file_size(at.binary());
  return Time([&] { CopyInto(at.binary(), FreshMemory(bytes)); });
}
Sample CopyToTouched(const Workplace& at) {
  const std::span<char> memory = FreshMemory(std::filesystem::file_size(at.binary()));
  std::memset(memory.data(), 1, memory.size());
  return Time([&] { CopyInto(at.binary(), memory); });
}

// ---- ... and into a new file

// Written from memory, in blocks as large as they come.
Sample WriteBytes(const Workplace& at, const std::string& bytes) {
  return Time([&] {
    const Descriptor file(at.output(), O_WRONLY | O_CREAT | O_TRUNC);
    for (std::string_view left = bytes; !left.empty();) {
      const ssize_t put = write(file.number(), left.data(), left.size());
      if (put <= 0) throw SystemError(at.output(), "cannot write");
      left.remove_prefix(static_cast<std::size_t>(put));
    }
  });
}
Sample CopyToFile(const Workplace& at) {
  const std::string bytes(WholeFile(Source(at.binary())).text());
  std::filesystem::remove(at.output());
  return WriteBytes(at, bytes);
}
Sample CopyFileRange(const Workplace& at) {
  std::filesystem::remove(at.output());
  return Time([&] {
    const Descriptor from(at.binary(), O_RDONLY), to(at.output(), O_WRONLY | O_CREAT | O_TRUNC);
    constexpr std::size_t kMost = std::size_t{1} << 30;
    ssize_t copied = 0;
    while ((copied = copy_file_range(from.number(), nullptr, to.number(), nullptr, kMost, 0)) > 0) continue;
    if (copied < 0) throw SystemError(at.output(), "cannot copy_file_range");
  });
}

// ---- other programs, as whole processes

Sample Run(const std::vector<std::string>& arguments) {
  return Time([&] { RunProgram(arguments, Cores::kAll, Output::kDiscard); });  // on the cores that this one has
}
Sample RunCp(const Workplace& at) {
  std::filesystem::remove(at.output());
  return Run({"cp", at.binary(), at.output()});
}
Sample RunCat(const Workplace& at) { return Run({"cat", at.binary()}); }
Sample RunTrue(const Workplace&) { return Run({"true"}); }

// ---- the numbers of the text, none of them kept

bool IsSpace(char c) { return c == ' ' || c == '\n'; }

template <class Number>
bool Parses(const char* begin, const char* end, double& sum) {
  Number number{};
  const auto [parsed, error] = std::from_chars(begin, end, number);
  if (error != std::errc() || parsed != end) return false;
  sum += static_cast<double>(number);
  return true;
}

double SumOfNumbers(std::string_view text) {
  double sum = 0;
  const char *at = text.data(), *const end = at + text.size();
  while (at != end) {
    at = std::find_if_not(at, end, IsSpace);
    const char* token = std::find_if(at, end, IsSpace);
    if (!Parses<std::int64_t>(at, token, sum)) Parses<double>(at, token, sum);
    at = token;
  }
  return sum;
}

Sample ParseNumbers(const Workplace& at) {
  return Time([&] {
    const WholeFile file{Source(at.text())};
    Keep(SumOfNumbers(file.text()));
  });
}

// ---- SQLite alone

Sample SqliteInsert(const Workplace& at) {
  const SqliteTables tables(at.store());
  std::filesystem::remove(at.output());
  return Time([&] { tables.Insert(at.output()); });
}
Sample SqliteSelect(const Workplace& at) {
  return Time([&] { Keep(SqliteTables(at.store())); });
}

// ---- what exports write

Sample WriteBytesOf(const Workplace& at, const std::string& format) {
  const auto remove = [&] { std::filesystem::remove_all(at.output()); };
  remove();
  WriteAtlas(ReadAtlas(at.binary()), at.output(), {.format = format, .sync = false, .threads = 1});
  std::string bytes;
  if (std::filesystem::is_directory(at.output()))
    for (const auto& entry : std::filesystem::directory_iterator(at.output()))
      bytes += WholeFile(Source(entry.path().string())).text();
  else
    bytes = WholeFile(Source(at.output())).text();
  remove();
  return WriteBytes(at, bytes);
}
Sample WriteStellaBytes(const Workplace& at) { return WriteBytesOf(at, "stella"); }
Sample WriteStellaDatabaseBytes(const Workplace& at) { return WriteBytesOf(at, "stella-sqlite"); }
Sample WriteColmapBytes(const Workplace& at) { return WriteBytesOf(at, "colmap"); }

constexpr Measurement kReferences[] = {
    {"boost-read-binary", ReadBinary, FromFile::kYes},
    {"boost-read-text", ReadText, FromFile::kYes},
    {"boost-read-memory", ReadMemory},
    {"boost-write-binary", WriteBinary},
    {"boost-write-text", WriteText},
    {"copy", Copy, FromFile::kYes},
    {"copy-touched", CopyToTouched, FromFile::kYes},
    {"copy-to-file", CopyToFile},
    {"copy-file-range", CopyFileRange, FromFile::kYes},
    {"cp", RunCp, FromFile::kYes},
    {"cat", RunCat, FromFile::kYes},
    {"true", RunTrue},
    {"parse-numbers", ParseNumbers, FromFile::kYes},
    {"sqlite-insert", SqliteInsert},
    {"sqlite-select", SqliteSelect, FromFile::kYes},
    {"export-stella-bytes", WriteStellaBytes},
    {"export-stella-sqlite-bytes", WriteStellaDatabaseBytes},
    {"export-colmap-bytes", WriteColmapBytes},
};

}  // namespace

std::span<const Measurement> References() { return kReferences; }

}  // namespace slamdb::bench
