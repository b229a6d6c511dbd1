// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/layouts/detail/wire.h"

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"

namespace slamdb::layouts {
namespace {

using Kind = LayoutType::Kind;
using Number = LayoutType::Number;

// size_t is `unsigned long` on 64-bit Linux, so that vectors of both are one class.
LayoutType Canonical(LayoutType type, const ArchiveEncoding& encoding) {
  if (type.kind == Kind::kNumber && type.number == Number::kSize && encoding.long_bytes == encoding.size_bytes)
    type.number = Number::kU64;
  for (LayoutType& element : type.elements) element = Canonical(std::move(element), encoding);
  return type;
}

}  // namespace

std::uint64_t Wire::WidthOf(Number number, const ArchiveEncoding& encoding) {
  switch (number) {
    case Number::kU8:
    case Number::kI8:
    case Number::kBool:
      return 1;
    case Number::kI16:
    case Number::kU16:
      return 2;
    case Number::kU32:
    case Number::kI32:
    case Number::kF32:
      return 4;
    case Number::kU64:
    case Number::kLong:
      return encoding.long_bytes;
    case Number::kSize:
      return encoding.size_bytes;
    case Number::kI64:
    case Number::kF64:
    case Number::kULongLong:
      return 8;
  }
  return 1;
}

Wire::Wire(const Layout& layout, const ArchiveEncoding& encoding) : encoding_(encoding) {
  for (const LayoutClass& of : layout.classes) {
    rows_[of.name] = static_cast<std::uint32_t>(classes.size());
    WireClass& added = classes.emplace_back();
    added.name = of.name;
    added.key = KeyOf("class " + of.name);
    added.abstract = of.abstract;
    added.exported = of.exported;
  }
  for (std::size_t row = 0; row < layout.classes.size(); ++row) {
    for (const LayoutMember& member : layout.classes[row].members) {
      const std::uint32_t type = Add(ParseLayoutType(member.type));
      classes[row].members.push_back({member.name, type});
    }
    for (const std::string& name : layout.classes[row].registers)
      classes[row].registers.push_back(KeyOf("class " + name));
  }
  for (const std::string& type : layout.root) root.push_back(Add(ParseLayoutType(type)));
  class_of_key.assign(keys, -1);
  for (std::size_t row = 0; row < classes.size(); ++row)
    class_of_key[classes[row].key] = static_cast<std::int64_t>(row);
}

std::int64_t Wire::RowOf(std::string_view class_name) const {
  const auto found = rows_.find(class_name);
  return found == rows_.end() ? -1 : static_cast<std::int64_t>(found->second);
}

std::uint32_t Wire::KeyOf(const std::string& name) {
  const auto [found, added] = keys_.try_emplace(name, keys);
  if (added) ++keys;
  return found->second;
}

std::uint32_t Wire::Add(const LayoutType& parsed) {
  const LayoutType type = Canonical(parsed, encoding_);
  WireType wire;
  const auto number = [&](const LayoutType& of) { return WidthOf(of.number, encoding_); };
  if (!type.elements.empty() && type.kind != Kind::kMap) wire.element = Add(type.elements.front());
  if (type.kind == Kind::kMap) {
    wire.element = Add(type.elements[0]);
    wire.second = Add(type.elements[1]);
    wire.pair_key = KeyOf("pair " + ToString(type));
  }
  if (!type.name.empty()) {
    if (RowOf(type.name) < 0) throw Error(ErrorKind::kUsage, detail::Concat("no class is called ", type.name));
    wire.class_row = static_cast<std::uint32_t>(RowOf(type.name));
    wire.key = classes[wire.class_row].key;
  }
  switch (type.kind) {
    case Kind::kNumber:
      wire.bytes = number(type);
      break;
    case Kind::kString:
      wire.kind = WireType::Kind::kString;
      break;
    case Kind::kArray:
      wire.kind = WireType::Kind::kArray;
      wire.count = type.count;
      if (types[wire.element].kind == WireType::Kind::kFixed) {
        wire.kind = WireType::Kind::kFixed;
        wire.bytes = type.count * types[wire.element].bytes;
      }
      break;
    case Kind::kVector:
    case Kind::kSet:
    case Kind::kList: {
      const LayoutType& element = type.elements.front();
      const bool numbers = type.kind == Kind::kVector && element.kind == Kind::kNumber;
      wire.kind = WireType::Kind::kCollection;
      if (numbers) wire.kind = element.number == Number::kBool ? WireType::Kind::kBools : WireType::Kind::kNumbers;
      if (numbers) wire.bytes = number(element);
      wire.info = element.kind != Kind::kNumber;
      wire.key = KeyOf(ToString(type));
      break;
    }
    case Kind::kMap:
      wire.kind = WireType::Kind::kMap;
      wire.key = KeyOf(ToString(type));
      break;
    case Kind::kPointer:
      wire.kind = WireType::Kind::kPointer;
      break;
    case Kind::kValue:
      wire.kind = WireType::Kind::kValue;
      break;
    case Kind::kRaw:
      wire.kind = WireType::Kind::kRaw;
      break;
    case Kind::kMatrix:
      wire.kind = WireType::Kind::kMatrix;
      break;
    case Kind::kMatrix2:
      wire.kind = WireType::Kind::kMatrix2;
      wire.key = KeyOf("Mat");
      break;
    case Kind::kKeypoints:
      wire.kind = WireType::Kind::kKeypoints;
      break;
  }
  types.push_back(wire);
  return static_cast<std::uint32_t>(types.size() - 1);
}

}  // namespace slamdb::layouts
