// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <iterator>
#include <map>
#include <utility>

namespace slamdb::detail {

// Which bytes of a file are taken: the ranges between them that are free, and where the last taken one ends.
class FreeRanges {
 public:
  // Bytes that nobody has taken, in the first gap that holds them. Returns where they begin.
  std::size_t Take(std::size_t bytes) {
    for (auto gap = gaps_.begin(); gap != gaps_.end(); ++gap) {
      const auto [begin, size] = *gap;
      if (size < bytes) continue;
      gaps_.erase(gap);
      if (size > bytes) gaps_.emplace(begin + bytes, size - bytes);
      return begin;
    }
    return std::exchange(end_, end_ + bytes);
  }
  void GiveBack(std::size_t begin, std::size_t bytes) {
    auto behind = gaps_.lower_bound(begin);
    if (behind != gaps_.begin()) {
      const auto before = std::prev(behind);
      if (before->first + before->second == begin) {
        begin = before->first;
        bytes += before->second;
        gaps_.erase(before);
      }
    }
    if (behind != gaps_.end() && behind->first == begin + bytes) {
      bytes += behind->second;
      gaps_.erase(behind);
    }
    if (begin + bytes == end_)
      end_ = begin;
    else
      gaps_.emplace(begin, bytes);
  }
  // What is free now is never taken; what is taken is not to be given back.
  void Retire() { gaps_.clear(); }
  // Behind all that is taken.
  std::size_t end() const { return end_; }

 private:
  std::map<std::size_t, std::size_t> gaps_;  // begin -> bytes; no two of them meet
  std::size_t end_ = 0;
};

}  // namespace slamdb::detail
