// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/export.h"

// Layouts of ORB-SLAM3's forks as data: which members stand in an atlas file, in which order, of which type.
// schema/layouts.md describes the JSON; known/*.json are those that slamdb comes with.
//
// Thread-safe.
namespace slamdb {

// The type of a member, parsed. `vec<ptr<KeyFrame>>` is kVector of kPointer to class KeyFrame.
struct SLAMDB_EXPORT LayoutType {
  enum class Kind : std::uint8_t {
    kNumber,    // u8 i8 bool i16 u16 i32 u32 u64 i64 f32 f64, long ulonglong size
    kString,    // string
    kArray,     // arr<T,n>: n of them, without a count
    kVector,    // vec<T>
    kSet,       // set<T>
    kList,      // list<T>
    kMap,       // map<K,V>
    kPointer,   // ptr<C>
    kValue,     // val<C>: a class by value, with class information
    kRaw,       // raw<C>: the members of a class, without class information
    kMatrix,    // mat: i32 columns, i32 rows, i32 type, bool, elements
    kMatrix2,   // mat2: a class; i32 columns, i32 rows, u64 element size, u64 type, elements
    kKeypoints  // kps: i32 count, 28 bytes each
  };
  // u64 is `unsigned long`, which has 4 bytes on Windows; kLong is `long`; kSize is size_t; the others have their
  // width.
  enum class Number : std::uint8_t {
    kU8,
    kBool,
    kI16,
    kU16,
    kI32,
    kU32,
    kU64,
    kI64,
    kF32,
    kF64,
    kLong,
    kULongLong,
    kSize,
    kI8
  };

  Kind kind = Kind::kNumber;
  Number number = Number::kU8;       // kNumber
  std::uint32_t count = 0;           // kArray
  std::string name;                  // of the class: kPointer, kValue, kRaw
  std::vector<LayoutType> elements;  // one, or key and value

  friend bool operator==(const LayoutType&, const LayoutType&) = default;
};

// Throws Error (kUsage) saying what was expected where.
[[nodiscard]] SLAMDB_EXPORT LayoutType ParseLayoutType(std::string_view text);
[[nodiscard]] SLAMDB_EXPORT std::string ToString(const LayoutType& type);

// A member. What has one of ORB-SLAM3's own names becomes that part of the model, anything else travels as it is.
struct SLAMDB_EXPORT LayoutMember {
  std::string name;  // mnId, mvKeys, ...
  std::string type;  // as ParseLayoutType reads it

  friend bool operator==(const LayoutMember&, const LayoutMember&) = default;
};

struct SLAMDB_EXPORT LayoutClass {
  std::string name;                    // KeyFrame, MapPoint, ...
  std::vector<LayoutMember> members;   // in the order of the file
  std::vector<std::string> registers;  // classes that it registers by name in front of its members (register_type)
  bool abstract = false;               // takes no class id where a pointer to it is declared
  std::string exported;  // the key that stands in the file where it is not registered (BOOST_CLASS_EXPORT)

  friend bool operator==(const LayoutClass&, const LayoutClass&) = default;
};

struct SLAMDB_EXPORT Layout {
  std::string id;                 // v1.0, obvi, ...
  std::string title;              // what is different, for people
  std::string who;                // whose files have it
  bool header = true;             // the file begins with the header of a Boost archive
  std::vector<std::string> root;  // types of what is saved, one behind the other
  std::vector<LayoutClass> classes;

  // The class of that name; null when there is none.
  const LayoutClass* Find(std::string_view name) const;
  LayoutClass* Find(std::string_view name);

  friend bool operator==(const Layout&, const Layout&) = default;
};

// Whether files of both have the same bytes: ids, titles and authors do not count.
[[nodiscard]] SLAMDB_EXPORT bool SameBytes(const Layout& a, const Layout& b);

// Reads a layout, which stands there in full or as changes to a known one. Short member names of older files become
// ORB-SLAM3's own. `path` is for errors.
//
// Throws Error (kDamaged) with the place in the JSON: no JSON, unknown members, types, classes; too large or too deep.
[[nodiscard]] SLAMDB_EXPORT Layout ParseLayout(std::string_view json, const std::string& path = {});
// The layout in full.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const Layout& layout);

// Those that slamdb comes with, v1.0 first.
[[nodiscard]] SLAMDB_EXPORT std::span<const Layout> KnownLayouts();
// Null when there is none of that id.
[[nodiscard]] SLAMDB_EXPORT const Layout* FindKnownLayout(std::string_view id);

// A known layout by its id, or one in JSON: what Atlas::layout holds.
//
// Throws Error (kDamaged) as ParseLayout does.
[[nodiscard]] SLAMDB_EXPORT Layout LayoutOf(std::string_view id_or_json);
// A known layout by its id, or the file of that path: what users name.
//
// Throws Error as ParseLayout and the file do; kNotFound naming the known ids.
[[nodiscard]] SLAMDB_EXPORT Layout LoadLayout(const std::string& id_or_path);

}  // namespace slamdb
