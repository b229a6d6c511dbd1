// SPDX-License-Identifier: BSD-3-Clause
#include "tests/formats/orbslam3/crafted_archive.h"

#include <cstdio>
#include <limits>

namespace slamdb {
namespace {

constexpr std::string_view kSignature = "serialization::archive";

std::string Print(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof(text), format, value);
  return text;
}

}  // namespace

CraftedArchive::CraftedArchive(const Craft& craft) : craft_(craft) {
  if (craft.text) {
    bytes_ = std::to_string(kSignature.size()) + " " + std::string(kSignature) + " " + std::to_string(craft.version);
    return;
  }
  SizeValue(kSignature.size());
  bytes_ += kSignature;
  Integer(craft.version, 2);
  for (const int size : {4, craft.long_bytes, 4, 8}) Byte(size);
  Int(1);
}

void CraftedArchive::UnsignedLong(std::uint64_t value) {
  if (craft_.text && craft_.long_bytes == 8) return Token(std::to_string(value));
  if (craft_.text) return Token(std::to_string(static_cast<std::uint32_t>(value)));
  Integer(static_cast<std::int64_t>(value), craft_.long_bytes);
}

void CraftedArchive::Float(float value) {
  if (!craft_.text) return Raw(&value, sizeof(value));
  Token(Print(craft_.version <= 10 ? "%.8g" : "%.9e", static_cast<double>(value)));
}

void CraftedArchive::Floats(float value, int count) {
  for (int i = 0; i < count; ++i) Float(value);
}

void CraftedArchive::Double(double value) {
  if (!craft_.text) return Raw(&value, sizeof(value));
  Token(Print(craft_.version <= 10 ? "%.17g" : "%.17e", value));
}

void CraftedArchive::String(std::string_view value) {
  SizeValue(value.size());
  if (craft_.text) bytes_ += ' ';
  bytes_ += value;
}

void CraftedArchive::IntCount(int count) {
  const std::size_t begin = bytes_.size();
  Int(count);
  Mark(Field::Kind::kCount, begin);
}

void CraftedArchive::NumberVector(const std::string& type, std::size_t count) {
  ClassId(type);
  const std::size_t begin = bytes_.size();
  SizeValue(count);
  Mark(Field::Kind::kCount, begin);
  if (craft_.text) Int(0);
}

void CraftedArchive::Container(const std::string& type, std::size_t count) {
  Value(type);
  const std::size_t begin = bytes_.size();
  SizeValue(count);
  Mark(Field::Kind::kCount, begin);
  Int(0);
}

void CraftedArchive::Value(const std::string& type) {
  ClassId(type);
  ClassInfo(type, 0);
}

void CraftedArchive::Null(const std::string& type) {
  ClassId(type);
  Integer(-1, 2);
}

bool CraftedArchive::Object(const std::string& type, int key) {
  const std::size_t begin = bytes_.size();
  Integer(ClassId(type), 2);
  Mark(Field::Kind::kClassId, begin);
  ClassInfo(type, 1);
  const auto [object, is_new] = objects_[type].try_emplace(key, object_count_);
  if (is_new) ++object_count_;
  const std::size_t id_begin = bytes_.size();
  if (craft_.text) {
    Token(std::to_string(object->second), is_new ? '\n' : ' ');
  } else {
    Int(object->second);
  }
  Mark(Field::Kind::kObjectId, id_begin);
  return is_new;
}

void CraftedArchive::Integer(std::int64_t value, int width) {
  if (!craft_.text) return Raw(&value, static_cast<std::size_t>(width));  // little endian, as this machine
  Token(std::to_string(value));
}

void CraftedArchive::Token(const std::string& token, char separator) {
  bytes_ += separator;
  bytes_ += token;
}

void CraftedArchive::Mark(Field::Kind kind, std::size_t offset) {
  const std::size_t begin = craft_.text ? offset + 1 : offset;
  fields_.push_back({kind, begin, bytes_.size() - begin});
}

int CraftedArchive::ClassId(const std::string& type) {
  return classes_.try_emplace(Identity(type), static_cast<int>(classes_.size())).first->second;
}

void CraftedArchive::ClassInfo(const std::string& type, int tracking) {
  if (!described_.insert(type).second) return;
  Byte(tracking);
  Unsigned(0);
}

std::string CraftedArchive::Identity(const std::string& type) const {
  if (type != "vector<size_t>") return type;
  if (craft_.size_bytes == 4) return "vector<unsigned>";
  return craft_.long_bytes == 8 ? "vector<unsigned long>" : "vector<unsigned long long>";
}

}  // namespace slamdb
