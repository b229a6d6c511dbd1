// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace slamdb {

// Which program on which machine an archive pretends to come from.
struct Craft {
  bool text = false;
  int version = 18;    // library version of Boost.Serialization
  int long_bytes = 8;  // 4 on Windows and 32-bit systems
  int size_bytes = 8;  // sizeof(size_t): 4 on 32-bit systems
};

// Writes a Boost archive token by token from the rules of the format, without Boost and without any code of the
// library, so that tests have archives that this machine's Boost cannot make. Types are named by their C++ spelling.
class CraftedArchive {
 public:
  // A place whose value decides how the rest is read: where damage is worst.
  struct Field {
    enum class Kind { kCount, kClassId, kObjectId };
    Kind kind;
    std::size_t offset = 0, length = 0;
  };

  explicit CraftedArchive(const Craft& craft);

  void Bool(bool value) { Integer(value ? 1 : 0, 1); }
  void Byte(int value) { Integer(value, 1); }
  void Int(std::int32_t value) { Integer(value, 4); }
  void Unsigned(std::uint32_t value) { Integer(value, 4); }
  void LongLong(std::int64_t value) { Integer(value, 8); }
  void Long(std::int64_t value) { Integer(value, craft_.long_bytes); }
  // All ones stay all ones where the type is narrower.
  void UnsignedLong(std::uint64_t value);
  void SizeValue(std::uint64_t value) { Integer(static_cast<std::int64_t>(value), craft_.size_bytes); }
  void Float(float value);
  void Floats(float value, int count);
  void Double(double value);
  void String(std::string_view value);

  // The count of a key point list: an int.
  void IntCount(int count);
  // In front of a vector of arithmetic type, which is registered but has no class information.
  void NumberVector(const std::string& type, std::size_t count);
  // In front of any other container.
  void Container(const std::string& type, std::size_t count);
  // In front of an object held by value: class information the first time.
  void Value(const std::string& type);
  void Null(const std::string& type);
  // In front of an object held by pointer. True when it is new and its contents have to follow.
  bool Object(const std::string& type, int key);
  // Atlas registers its camera classes before anything else.
  void Register(const std::string& type) { ClassId(type); }

  // The archive; ends a text archive with its newline.
  std::string Finish() const { return craft_.text ? bytes_ + "\n" : bytes_; }
  const std::vector<Field>& fields() const { return fields_; }

 private:
  void Integer(std::int64_t value, int width);
  void Raw(const void* value, std::size_t size) { bytes_.append(static_cast<const char*>(value), size); }
  void Token(const std::string& token, char separator = ' ');
  void Mark(Field::Kind kind, std::size_t offset);
  int ClassId(const std::string& type);
  void ClassInfo(const std::string& type, int tracking);
  // The C++ type behind a spelling on that machine.
  std::string Identity(const std::string& type) const;

  Craft craft_;
  std::string bytes_;
  std::map<std::string, int> classes_;
  std::set<std::string> described_;
  std::map<std::string, std::map<int, int>> objects_;
  int object_count_ = 0;
  std::vector<Field> fields_;
};

}  // namespace slamdb
