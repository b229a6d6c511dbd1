// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/detail/natural.h"

#include <algorithm>
#include <cstddef>

namespace slamdb::detail {
namespace {

bool IsDigit(char letter) { return letter >= '0' && letter <= '9'; }

std::size_t DigitsAt(std::string_view text, std::size_t from) {
  std::size_t end = from;
  while (end < text.size() && IsDigit(text[end])) ++end;
  return end - from;
}

// Below 0, 0 or above it, as the numbers are, however many digits they have.
int CompareNumbers(std::string_view a, std::string_view b) {
  a.remove_prefix(std::min(a.find_first_not_of('0'), a.size()));
  b.remove_prefix(std::min(b.find_first_not_of('0'), b.size()));
  if (a.size() != b.size()) return a.size() < b.size() ? -1 : 1;
  return a.compare(b);
}

// A slash is before all other letters, so that the files of a folder stand together.
unsigned Rank(char letter) { return letter == '/' ? 0 : static_cast<unsigned char>(letter) + 1U; }

}  // namespace

bool NaturalLess(std::string_view a, std::string_view b) {
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (IsDigit(a[i]) && IsDigit(b[j])) {
      const std::size_t of_a = DigitsAt(a, i), of_b = DigitsAt(b, j);
      if (const int order = CompareNumbers(a.substr(i, of_a), b.substr(j, of_b)); order != 0) return order < 0;
      i += of_a;
      j += of_b;
    } else if (a[i] != b[j]) {
      return Rank(a[i]) < Rank(b[j]);
    } else {
      ++i;
      ++j;
    }
  }
  if (i < a.size() || j < b.size()) return i == a.size();
  return a.size() != b.size() ? a.size() < b.size() : a < b;  // equal but for leading zeros
}

}  // namespace slamdb::detail
