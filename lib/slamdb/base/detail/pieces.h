// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "slamdb/base/column.h"
#include "slamdb/base/file.h"

namespace slamdb::detail {

// Bytes that are about to be written, one behind the other: small ones, which are collected here, and large columns
// that stay where they are and so are not copied twice.
class Pieces {
 public:
  Pieces() = default;
  Pieces(const Pieces&) = delete;
  Pieces& operator=(const Pieces&) = delete;

  // Keeps the memory.
  void clear() {
    next_ = memory_.data();
    columns_.clear();
  }

  // Room for so many bytes more, which the caller fills before anything else is added.
  char* Extend(std::size_t bytes) {
    if (static_cast<std::size_t>(end_ - next_) < bytes) [[unlikely]]
      Grow(bytes);
    return std::exchange(next_, next_ + bytes);
  }
  // Takes back the last of them, of what was added behind the last column.
  void Shorten(std::size_t bytes) { next_ -= bytes; }
  // Bytes that outlive this.
  void Refer(Bytes column) { columns_.push_back({collected(), column}); }

  // Bytes without the columns.
  std::size_t collected() const { return static_cast<std::size_t>(next_ - memory_.data()); }
  template <class Write>
  void ForEach(const Write& write) const {
    const Bytes own = std::as_bytes(std::span(memory_.data(), collected()));
    std::size_t begin = 0;
    for (const ColumnAt& at : columns_) {
      if (at.behind > begin) write(own.subspan(begin, at.behind - begin));
      write(at.column);
      begin = at.behind;
    }
    if (own.size() > begin) write(own.subspan(begin));
  }

 private:
  struct ColumnAt {
    std::size_t behind;  // collected bytes in front of it
    Bytes column;
  };

  [[gnu::noinline]] void Grow(std::size_t bytes) {
    const std::size_t size = collected();
    memory_.resize(std::max(2 * memory_.size(), size + bytes));
    next_ = memory_.data() + size;
    end_ = memory_.data() + memory_.size();
  }

  Column<char> memory_;
  char *next_ = nullptr, *end_ = nullptr;  // of what is not in use
  std::vector<ColumnAt> columns_;
};

}  // namespace slamdb::detail
