// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam3/detail/transfer.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "slamdb/base/detail/concat.h"

namespace slamdb::orbslam3 {
namespace {

enum class Transfer {
  kCarriageReturns,    // each line feed got a carriage return before it
  kLatin1,             // each byte from 0x80 on was taken for a character of Latin-1 or Windows-1252, now in UTF-8
  kReplaced,           // bytes that are no UTF-8 became U+FFFD
  kNoCarriageReturns,  // carriage returns went, all of them, or those before line feeds
  kNoLineFeeds,        // line feeds became carriage returns
  kSevenBits,          // the highest bit of each byte went
};

constexpr int kMostTransfers = 8;  // one after the other

// In bytes that mean nothing, each of 256 values is as frequent as the others, and each pair of them. What is missing
// where so many would be expected did not get lost by chance.
constexpr std::uint64_t kEnough = 256;
constexpr std::uint64_t kOfOneByte = kEnough * 256, kOfTwoBytes = kEnough * 65536;

// What the bytes of a file are, as far as transfers change them.
struct Census {
  std::uint64_t carriage_returns = 0, line_feeds = 0, pairs = 0;  // pairs: of both, in this order
  std::uint64_t high = 0;                                         // bytes from 0x80 on
  // Characters in UTF-8: those of Latin-1 and Windows-1252, U+FFFD, and others beyond ASCII. Bytes from 0x80 on that
  // are of none.
  std::uint64_t latin1 = 0, replacements = 0, others = 0, strays = 0;

  // What decoders put for bytes that are no UTF-8 is all UTF-8. Some bytes were, by chance; damage came later.
  bool is_replaced() const { return replacements > 0 && strays <= replacements / kFew; }
  bool is_latin1() const { return latin1 > 1 && replacements + others + strays <= latin1 / kFew; }

  // Whether so many bytes more cannot make it what any transfer leaves: the binary files of nearly all, soon.
  bool is_settled(std::size_t left) const {
    const std::uint64_t most = latin1 + replacements + left / 2;  // characters have two bytes or three
    return strays > most / kFew && high > 0 && carriage_returns > 0 && pairs > 0 && pairs < line_feeds;
  }

  static constexpr std::uint64_t kFew = 64;  // of so many, one is an exception
};

// A character beyond ASCII in UTF-8.
struct Character {
  std::size_t bytes = 0;  // 0: none stands there
  std::uint32_t code = 0;
};

Character CharacterAt(std::string_view file, std::size_t at) {
  const auto first = static_cast<unsigned char>(file[at]);
  const std::size_t bytes = first < 0xc2 ? 0 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : first < 0xf5 ? 4 : 0;
  if (bytes == 0 || file.size() - at < bytes) return {};
  std::uint32_t code = first & (0x7fU >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    const auto next = static_cast<unsigned char>(file[at + i]);
    if ((next & 0xc0U) != 0x80) return {};
    code = code << 6U | (next & 0x3fU);
  }
  return {bytes, code};
}

// What Windows-1252 has for the bytes from 0x80 to 0x9f; 0: nothing, for which decoders leave the byte's own code.
constexpr std::array<std::uint16_t, 32> kWindows1252 = {0x20ac, 0,      0x201a, 0x0192, 0x201e, 0x2026, 0x2020, 0x2021,
                                                        0x02c6, 0x2030, 0x0160, 0x2039, 0x0152, 0,      0x017d, 0,
                                                        0,      0x2018, 0x2019, 0x201c, 0x201d, 0x2022, 0x2013, 0x2014,
                                                        0x02dc, 0x2122, 0x0161, 0x203a, 0x0153, 0,      0x017e, 0x0178};

// The byte that a program took for this character, by Latin-1 or Windows-1252.
std::optional<char> ByteOf(const Character& character) {
  if (character.bytes == 0) return std::nullopt;
  if (character.code < 0x100) return static_cast<char>(character.code);
  const auto* found = std::ranges::find(kWindows1252, character.code);
  if (found == kWindows1252.end()) return std::nullopt;
  return static_cast<char>(0x80 + (found - kWindows1252.begin()));
}

// Ends early where it is settled.
Census Count(std::string_view file) {
  constexpr std::size_t kBetweenLooks = std::size_t{1} << 16;
  Census census;
  std::size_t look = kBetweenLooks;
  for (std::size_t i = 0; i < file.size(); ++i) {
    if (i >= look) {
      if (census.is_settled(file.size() - i)) break;
      look += kBetweenLooks;
    }
    const auto byte = static_cast<unsigned char>(file[i]);
    census.carriage_returns += byte == '\r';
    census.line_feeds += byte == '\n';
    census.pairs += byte == '\n' && i > 0 && file[i - 1] == '\r';
    if (byte < 0x80) continue;
    ++census.high;
    const Character character = CharacterAt(file, i);
    if (character.bytes == 0) {
      census.strays += file.size() - i > 3;  // the end may be cut
      continue;
    }
    ++(ByteOf(character) ? census.latin1 : character.code == 0xfffd ? census.replacements : census.others);
    i += character.bytes - 1;
  }
  return census;
}

std::optional<Transfer> FindTransfer(std::string_view file) {
  const Census census = Count(file);
  if (census.is_replaced()) return Transfer::kReplaced;
  if (census.is_latin1()) return Transfer::kLatin1;
  if (census.line_feeds > 1 && census.pairs == census.line_feeds) return Transfer::kCarriageReturns;
  if (census.high == 0 && file.size() > kOfOneByte) return Transfer::kSevenBits;
  if (census.line_feeds == 0 && file.size() > kOfOneByte) return Transfer::kNoLineFeeds;
  if ((census.carriage_returns == 0 && file.size() > kOfOneByte) || (census.pairs == 0 && file.size() > kOfTwoBytes))
    return Transfer::kNoCarriageReturns;
  return std::nullopt;
}

bool CanUndo(Transfer transfer) { return transfer == Transfer::kCarriageReturns || transfer == Transfer::kLatin1; }

std::string Undo(Transfer transfer, std::string_view file) {
  std::string bytes;
  bytes.reserve(file.size());
  for (std::size_t i = 0; i < file.size(); ++i) {
    const bool pair = i + 1 < file.size();
    if (transfer == Transfer::kCarriageReturns && pair && file[i] == '\r' && file[i + 1] == '\n') continue;
    const Character character = transfer == Transfer::kLatin1 ? CharacterAt(file, i) : Character();
    if (const auto byte = ByteOf(character)) {
      bytes += *byte;
      i += character.bytes - 1;
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

}  // namespace

Transfers FindTransfers(std::string_view file) {
  Transfers transfers;
  for (int round = 0; round < kMostTransfers; ++round) {
    const std::optional<Transfer> transfer = FindTransfer(round == 0 ? file : transfers.bytes);
    if (!transfer) break;
    if (!CanUndo(*transfer)) {
      transfers.left = SentenceOf(*transfer);
      break;
    }
    transfers.bytes = Undo(*transfer, round == 0 ? file : transfers.bytes);
    transfers.undone += detail::Concat(transfers.undone.empty() ? "" : "; then ", SentenceOf(*transfer));
  }
  return transfers;
}

}  // namespace slamdb::orbslam3
