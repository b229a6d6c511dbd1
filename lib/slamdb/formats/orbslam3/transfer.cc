// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam3/detail/transfer.h"

#include <array>
#include <cstdint>

namespace slamdb::orbslam3 {
namespace {

// In bytes that mean nothing, each of 256 values is as frequent as the others, and each pair of them. What is missing
// where so many would be expected did not get lost by chance.
constexpr std::uint64_t kEnough = 256;
constexpr std::uint64_t kOfOneByte = kEnough * 256, kOfTwoBytes = kEnough * 65536;

// What the bytes of a file are, as far as transfers change them.
struct Census {
  std::uint64_t carriage_returns = 0, line_feeds = 0, pairs = 0;  // pairs: of both, in this order
  std::uint64_t high = 0;                                         // bytes from 0x80 on
  std::uint64_t latin1 = 0, replacements = 0;                     // characters of two bytes below U+0100, and U+FFFD
  bool utf8 = true;                                               // and no other character beyond ASCII
};

Census Count(std::string_view file) {
  Census census;
  for (std::size_t i = 0; i < file.size(); ++i) {
    const auto byte = static_cast<unsigned char>(file[i]);
    census.carriage_returns += byte == '\r';
    census.line_feeds += byte == '\n';
    census.pairs += byte == '\n' && i > 0 && file[i - 1] == '\r';
    if (byte < 0x80) continue;
    ++census.high;
    if (!census.utf8) continue;
    const auto next = i + 1 < file.size() ? static_cast<unsigned char>(file[i + 1]) : 0U;
    if ((byte == 0xc2 || byte == 0xc3) && next >= 0x80 && next < 0xc0) {
      ++census.latin1;
      ++i;
    } else if (file.substr(i, 3) == "\xef\xbf\xbd") {
      ++census.replacements;
      i += 2;
    } else if (file.size() - i > 3) {  // the end may be cut
      census.utf8 = false;
    }
  }
  return census;
}

}  // namespace

std::optional<Transfer> FindTransfer(std::string_view file) {
  const Census census = Count(file);
  if (census.utf8 && census.replacements > 0) return Transfer::kReplaced;
  if (census.utf8 && census.latin1 > 1) return Transfer::kLatin1;
  if (census.line_feeds > 1 && census.pairs == census.line_feeds) return Transfer::kCarriageReturns;
  if (census.high == 0 && file.size() > kOfOneByte) return Transfer::kSevenBits;
  if (census.line_feeds == 0 && file.size() > kOfOneByte) return Transfer::kNoLineFeeds;
  if ((census.carriage_returns == 0 && file.size() > kOfOneByte) || (census.pairs == 0 && file.size() > kOfTwoBytes))
    return Transfer::kNoCarriageReturns;
  return std::nullopt;
}

std::string Undo(Transfer transfer, std::string_view file) {
  std::string bytes;
  bytes.reserve(file.size());
  for (std::size_t i = 0; i < file.size(); ++i) {
    const bool pair = i + 1 < file.size();
    if (transfer == Transfer::kCarriageReturns && pair && file[i] == '\r' && file[i + 1] == '\n') continue;
    const auto byte = static_cast<unsigned char>(file[i]);
    if (transfer == Transfer::kLatin1 && pair && byte >= 0x80) {
      bytes += static_cast<char>((byte & 3U) << 6U | (static_cast<unsigned char>(file[++i]) & 0x3fU));
      continue;
    }
    bytes += file[i];
  }
  return bytes;
}

std::string_view SentenceOf(Transfer transfer) {
  constexpr std::array<std::string_view, 6> kSentences = {
      "every line feed has a carriage return before it, as a transfer in text mode leaves it",
      "every byte from 0x80 on was encoded in UTF-8, as a program leaves it that takes the file for text",
      "bytes from 0x80 on were replaced by U+FFFD, as a program leaves it that takes the file for text: they are lost",
      "carriage returns are missing, as a transfer in text mode leaves it: where they stood is lost",
      "it has no line feeds, as a transfer in text mode leaves it: which of its carriage returns they were is lost",
      "no byte has its highest bit set, as a transfer in 7-bit mode leaves it: what they were is lost",
  };
  return kSentences.at(static_cast<std::size_t>(transfer));
}

}  // namespace slamdb::orbslam3
