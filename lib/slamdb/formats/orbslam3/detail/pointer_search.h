// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <charconv>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

#include "slamdb/formats/orbslam3/detail/class_table.h"

// Pointers to new objects, found in a damaged archive by their looks.
namespace slamdb::orbslam3 {

// Where the pointer to a new object stands.
struct Sighting {
  std::size_t offset = 0;
  std::uint32_t object = 0;
};

// What the pointer to a new object looks like.
struct PointerPattern {
  std::int16_t class_id;
  bool with_info;             // the class stands in the archive for the first time
  std::uint32_t first, last;  // object ids

  PointerPattern(ClassTable classes, WireClass wire_class, std::uint32_t first_object, std::uint32_t last_object)
      : class_id(classes.Register(wire_class)),
        with_info(classes.FirstUse(wire_class)),
        first(first_object),
        last(last_object) {}
};

// Finds pointers by their looks alone, from `offset` on.
class BinarySearch {
 public:
  BinarySearch(std::string_view file, const PointerPattern& pattern) : file_(file), pattern_(pattern) {}

  std::optional<Sighting> Next(std::size_t offset) const {
    std::string head(reinterpret_cast<const char*>(&pattern_.class_id), sizeof(pattern_.class_id));
    if (pattern_.with_info) head += std::string_view("\1\0\0\0\0", 5);
    for (offset = file_.find(head, offset); offset != std::string_view::npos; offset = file_.find(head, offset + 1)) {
      std::uint32_t object = 0;
      if (file_.size() - offset < head.size() + sizeof(object)) return std::nullopt;
      std::memcpy(&object, file_.data() + offset + head.size(), sizeof(object));
      if (object >= pattern_.first && object <= pattern_.last) return Sighting{offset, object};
    }
    return std::nullopt;
  }
  // Where the list begins whose first pointer stands at `offset`.
  static std::size_t ListBegin(std::string_view, std::size_t offset, bool list_with_info, std::uint8_t size_bytes) {
    const std::size_t head = size_bytes + sizeof(std::uint32_t) + (list_with_info ? 5 : 0);
    return offset < head ? 0 : offset - head;
  }
  // Where the last `count` numbers of the file begin.
  static std::size_t LastNumbers(std::string_view file, std::size_t count, std::uint8_t bytes) {
    return file.size() < count * bytes ? 0 : file.size() - count * bytes;
  }

 private:
  std::string_view file_;
  PointerPattern pattern_;
};

// A text archive begins a line before the number of a new object, and nowhere else.
class TextSearch {
 public:
  TextSearch(std::string_view file, const PointerPattern& pattern) : file_(file), pattern_(pattern) {}

  std::optional<Sighting> Next(std::size_t offset) const {
    const std::string head = std::to_string(pattern_.class_id) + (pattern_.with_info ? " 1 0" : "");
    for (std::size_t line = file_.find('\n', offset); line != std::string_view::npos;
         line = file_.find('\n', line + 1)) {
      std::uint32_t object = 0;
      const char* const end = file_.data() + file_.size();
      const auto [behind, error] = std::from_chars(file_.data() + line + 1, end, object);
      if (error != std::errc() || behind == end || *behind != ' ') continue;
      if (object < pattern_.first || object > pattern_.last || line < offset + head.size() + 1) continue;
      const std::size_t begin = line - head.size();
      if (file_.substr(begin, head.size()) == head && file_[begin - 1] == ' ') return Sighting{begin, object};
    }
    return std::nullopt;
  }
  static std::size_t ListBegin(std::string_view file, std::size_t offset, bool list_with_info, std::uint8_t) {
    for (int tokens = list_with_info ? 4 : 2; tokens > 0 && offset > 0; --tokens) {
      offset = file.find_last_not_of(' ', offset - 1);
      offset = offset == std::string_view::npos ? 0 : file.find_last_of(" \n", offset) + 1;
    }
    return offset;
  }
  static std::size_t LastNumbers(std::string_view file, std::size_t count, std::uint8_t) {
    std::size_t offset = file.size();
    for (; count > 0 && offset > 0; --count) {
      offset = file.find_last_not_of(" \n", offset - 1);
      offset = offset == std::string_view::npos ? 0 : file.find_last_of(" \n", offset) + 1;
    }
    return offset;
  }

 private:
  std::string_view file_;
  PointerPattern pattern_;
};

}  // namespace slamdb::orbslam3
