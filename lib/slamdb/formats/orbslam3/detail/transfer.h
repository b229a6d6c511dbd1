// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>

// What programs do to a binary archive that take it for text.
namespace slamdb::orbslam3 {

enum class Transfer {
  kCarriageReturns,    // each line feed got a carriage return before it
  kLatin1,             // each byte from 0x80 on was taken for a character, and encoded in UTF-8
  kReplaced,           // bytes that are no UTF-8 became U+FFFD
  kNoCarriageReturns,  // carriage returns went, all of them, or those before line feeds
  kNoLineFeeds,        // line feeds became carriage returns
  kSevenBits,          // the highest bit of each byte went
};

// What was done to a binary archive, as its bytes tell; nothing when they tell nothing.
std::optional<Transfer> FindTransfer(std::string_view file);

// Whether what was done can be undone, exactly.
constexpr bool CanUndo(Transfer transfer) {
  return transfer == Transfer::kCarriageReturns || transfer == Transfer::kLatin1;
}
// The bytes as they were. `transfer` is one that can be undone.
std::string Undo(Transfer transfer, std::string_view file);

// For people: `every line feed has a carriage return before it, as a transfer in text mode leaves it`.
std::string_view SentenceOf(Transfer transfer);

}  // namespace slamdb::orbslam3
