// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam3/detail/archive_header.h"

#include <algorithm>
#include <charconv>
#include <cstring>

#include "slamdb/base/error.h"

namespace slamdb::orbslam3 {
namespace {

constexpr std::string_view kSignature = "serialization::archive";
constexpr std::string_view kTextStart = "22 serialization::archive ";
constexpr char kEndianProbe[] = {1, 0, 0, 0};

std::string_view Begin(detail::FileStream& file) {
  file.FillTo(1);
  return {file.data(), file.filled()};
}

void CheckVersion(const detail::FileStream& file, std::uint32_t version, Notices& notices) {
  const std::string found = "Boost archive version " + std::to_string(version);
  if (version < kOldestBoost)
    throw Error(
        ErrorKind::kUnsupported, file.path(), "archive header",
        found + " (Boost 1.52 or older), which writes other bytes; oldest known is " + std::to_string(kOldestBoost));
  if (version > kNewestBoost)
    notices.Warn(file.path() + ": written by " + found + ", newest known is " + std::to_string(kNewestBoost) +
                 "; read by the same rules");
}

ArchiveHeader ReadBinary(const detail::FileStream& file, std::string_view text) {
  ArchiveHeader header;
  // A 32-bit writer counts the signature in 4 bytes, everybody else in 8.
  header.encoding.size_bytes = text.size() > 4 && text.substr(4).starts_with(kSignature) ? 4 : 8;
  const std::size_t version_at = header.encoding.size_bytes + kSignature.size();
  header.bytes = version_at + 10;
  if (text.size() < header.bytes)
    throw Error(ErrorKind::kDamaged, file.path(), "archive header", "the file ends here: it is truncated");
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(text[version_at + i]); };
  if (std::memcmp(text.data() + version_at + 6, kEndianProbe, 4) != 0)
    throw Error(ErrorKind::kUnsupported, file.path(), "archive header",
                "written on a big-endian machine, or damaged; expected a little-endian archive");
  header.encoding.boost_version = static_cast<std::uint32_t>(byte(0) | byte(1) << 8);
  header.encoding.long_bytes = byte(3);
  if (byte(2) != 4 || byte(4) != 4 || byte(5) != 8 || (byte(3) != 4 && byte(3) != 8) ||
      (header.encoding.size_bytes == 4 && byte(3) == 8))
    throw Error(ErrorKind::kUnsupported, file.path(), "archive header",
                "sizes of int, long, float, double are " + std::to_string(byte(2)) + ", " + std::to_string(byte(3)) +
                    ", " + std::to_string(byte(4)) + ", " + std::to_string(byte(5)) + ", expected 4, 8 (or 4), 4, 8");
  return header;
}

ArchiveHeader ReadText(const detail::FileStream& file, std::string_view text) {
  ArchiveHeader header;
  header.encoding.text = true;
  const char* begin = text.data() + kTextStart.size();
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), header.encoding.boost_version);
  if (error != std::errc())
    throw Error(ErrorKind::kDamaged, file.path(), "archive header",
                "the library version is missing: the file is truncated or damaged");
  header.bytes = static_cast<std::size_t>(end - text.data());
  if (text.substr(0, header.bytes) != WriteArchiveHeader(header.encoding))
    throw Error(ErrorKind::kDamaged, file.path(), "archive header",
                "a library version with a zero in front: the file is damaged");
  return header;
}

}  // namespace

std::optional<bool> SniffArchive(std::string_view head) {
  if (head.starts_with(kTextStart)) return true;
  if (head.size() < 4 || head.substr(0, 4) != std::string_view("\x16\0\0\0", 4)) return std::nullopt;
  if (head.substr(4).starts_with(kSignature)) return false;
  if (head.size() > 8 && head.substr(4, 4) == std::string_view("\0\0\0\0", 4) && head.substr(8).starts_with(kSignature))
    return false;
  return std::nullopt;
}

ArchiveHeader ReadArchiveHeader(detail::FileStream& file, Notices& notices) {
  const std::string_view text = Begin(file);
  if (text.empty())
    throw Error(ErrorKind::kDamaged, file.path(), "", "the file is empty; was its writer killed, or the disk full?");
  const std::optional<bool> kind = SniffArchive(text);
  if (!kind)
    throw Error(ErrorKind::kDamaged, file.path(), "byte 0",
                "not a Boost archive: expected the signature 'serialization::archive'");
  const ArchiveHeader header = *kind ? ReadText(file, text) : ReadBinary(file, text);
  CheckVersion(file, header.encoding.boost_version, notices);
  return header;
}

ArchiveHeader UsualArchiveHeader(std::string_view file) {
  ArchiveHeader header;
  const std::string_view middle = file.substr(file.size() / 2, 4096);
  header.encoding.text =
      std::all_of(middle.begin(), middle.end(), [](char c) { return c == '\n' || (c >= ' ' && c <= '~'); });
  header.bytes = WriteArchiveHeader(header.encoding).size();
  return header;
}

std::string WriteArchiveHeader(const ArchiveEncoding& encoding) {
  if (encoding.text) return std::string(kTextStart) + std::to_string(encoding.boost_version);
  std::string header(encoding.size_bytes, '\0');
  header[0] = static_cast<char>(kSignature.size());
  header += kSignature;
  header += static_cast<char>(encoding.boost_version & 0xFF);
  header += static_cast<char>(encoding.boost_version >> 8);
  header += {4, static_cast<char>(encoding.long_bytes), 4, 8};
  header.append(kEndianProbe, sizeof(kEndianProbe));
  return header;
}

}  // namespace slamdb::orbslam3
