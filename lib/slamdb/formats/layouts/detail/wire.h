// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/formats/layouts/layout.h"
#include "slamdb/model/atlas.h"

// A layout made ready for walking through binary archives.
namespace slamdb::layouts {

struct WireType {
  enum class Kind : std::uint8_t {
    kFixed,       // `bytes` of them
    kNumbers,     // count, then elements of `bytes` each, without class information
    kBools,       // count, a byte each
    kCollection,  // class information, but in front of numbers, count, item version, elements
    kMap,         // the same with pairs of `element` and `second`
    kArray,       // `count` elements
    kString,
    kPointer,
    kValue,  // class information, members
    kRaw,    // members
    kMatrix,
    kMatrix2,
    kKeypoints,
  } kind = Kind::kFixed;
  std::uint64_t bytes = 0;                // kFixed; of an element: kNumbers
  std::uint64_t count = 0;                // kArray
  std::uint32_t element = 0, second = 0;  // rows of types
  std::uint32_t class_row = 0;            // kPointer, kValue, kRaw
  std::uint32_t key = 0, pair_key = 0;    // in the class table
  bool info = true;                       // kCollection, kMap: class information stands in front of the first one
};

struct WireMember {
  std::string name;
  std::uint32_t type = 0;
};

struct WireClass {
  std::string name;
  std::vector<WireMember> members;
  std::vector<std::uint32_t> registers;  // keys
  std::uint32_t key = 0;
  bool abstract = false;
  std::string exported;
};

struct Wire {
  std::vector<WireType> types;
  std::vector<WireClass> classes;
  std::vector<std::uint32_t> root;         // rows of types
  std::uint32_t keys = 0;                  // C++ types that take part in the class table
  std::vector<std::int64_t> class_of_key;  // row, or -1

  // Throws Error when the layout is none.
  Wire(const Layout& layout, const ArchiveEncoding& encoding);

  // Row of the class, -1 when there is none.
  std::int64_t RowOf(std::string_view class_name) const;
  // Compiles one more type.
  std::uint32_t Add(const LayoutType& type);
  static std::uint64_t WidthOf(LayoutType::Number number, const ArchiveEncoding& encoding);

 private:
  std::uint32_t KeyOf(const std::string& name);

  ArchiveEncoding encoding_;
  std::map<std::string, std::uint32_t, std::less<>> keys_, rows_;
};

}  // namespace slamdb::layouts
