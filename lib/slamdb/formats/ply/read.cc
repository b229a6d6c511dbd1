// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/ply/detail/read.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/open_end.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/formats/points/detail/point_set.h"

namespace slamdb::detail {
namespace {

constexpr std::string_view kSpaces = " \t\r\n";

struct Property {
  CloudColumn column;
  std::optional<NumberType> count;  // of a list, how its length is written
};
struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;

  // That a row takes at least.
  std::uint64_t least_bytes(bool text) const {
    std::uint64_t bytes = 0;
    for (const Property& property : properties)
      bytes += text ? 2 : SizeOf(property.count.value_or(property.column.type));
    return bytes;
  }
};
enum class Encoding { kAscii, kLittleEndian, kBigEndian };

struct Header {
  Encoding encoding = Encoding::kAscii;
  std::vector<Element> elements;
};

std::optional<NumberType> TypeByName(std::string_view name) {
  struct Named {
    std::string_view name;
    NumberType type;
  };
  constexpr Named kTypes[] = {
      {"char", NumberType::kInt8},     {"int8", NumberType::kInt8},     {"uchar", NumberType::kUint8},
      {"uint8", NumberType::kUint8},   {"short", NumberType::kInt16},   {"int16", NumberType::kInt16},
      {"ushort", NumberType::kUint16}, {"uint16", NumberType::kUint16}, {"int", NumberType::kInt32},
      {"int32", NumberType::kInt32},   {"uint", NumberType::kUint32},   {"uint32", NumberType::kUint32},
      {"float", NumberType::kFloat},   {"float32", NumberType::kFloat}, {"double", NumberType::kDouble},
      {"float64", NumberType::kDouble}};
  const auto found = std::ranges::find(kTypes, name, &Named::name);
  return found == std::end(kTypes) ? std::nullopt : std::optional(found->type);
}

class HeaderReader {
 public:
  explicit HeaderReader(const std::string& path) : path_(path) {}

  // Takes the header off the text.
  Header Read(std::string_view& text) {
    if (TakeLine(text) != "ply") Fail("expected `ply`");
    bool has_format = false;
    while (!text.empty()) {
      ++line_;
      std::string_view line = TakeLine(text);
      const std::string_view word = TakeWord(line, kBlanks);
      if (word == "end_header") {
        if (!has_format) Fail("expected a format before the end of the header");
        return std::move(header_);
      }
      if (word == "format")
        ReadFormat(line), has_format = true;
      else if (word == "element")
        ReadElement(line);
      else if (word == "property")
        ReadProperty(line);
      else if (word != "comment" && word != "obj_info")
        Fail(Concat("expected a line of a header, found ", Excerpt(word)));
    }
    Fail("the file ends in its header");
  }

 private:
  [[noreturn]] void Fail(const std::string& problem) const {
    throw Error(ErrorKind::kDamaged, path_, Concat("line ", line_), problem);
  }
  void ReadFormat(std::string_view line) {
    const std::string_view name = TakeWord(line, kBlanks), version = TakeWord(line, kBlanks);
    constexpr std::array<std::string_view, 3> kNames{"ascii", "binary_little_endian", "binary_big_endian"};
    const auto found = std::ranges::find(kNames, name);
    if (found == kNames.end())
      Fail(Concat("expected ascii, binary_little_endian or binary_big_endian, found ", Excerpt(name)));
    if (version != "1.0")
      throw Error(ErrorKind::kUnsupported, path_, Concat("line ", line_),
                  Concat("PLY of version ", Excerpt(version), "; 1.0 is read"));
    header_.encoding = static_cast<Encoding>(found - kNames.begin());
  }
  void ReadElement(std::string_view line) {
    Element& element = header_.elements.emplace_back();
    element.name = TakeWord(line, kBlanks);
    const auto count = ParseNumber<std::uint64_t>(TakeWord(line, kBlanks));
    if (!count) Fail("expected the name of an element and how many there are");
    element.count = *count;
  }
  void ReadProperty(std::string_view line) {
    if (header_.elements.empty()) Fail("a property before the first element");
    Property property;
    std::string_view type = TakeWord(line, kBlanks);
    if (type == "list") {
      property.count = TypeByName(TakeWord(line, kBlanks));
      if (!property.count || *property.count >= NumberType::kFloat)
        Fail("expected a whole type for the length of a list");
      type = TakeWord(line, kBlanks);
    }
    const auto known = TypeByName(type);
    if (!known) Fail(Concat("expected a type, found ", Excerpt(type)));
    property.column.type = *known;
    property.column.name = TakeWord(line, kBlanks);
    property.column.field = property.count ? PointField::kUnknown : FieldByName(property.column.name);
    header_.elements.back().properties.push_back(std::move(property));
  }

  const std::string& path_;
  std::uint64_t line_ = 1;
  Header header_;
};

// The body as bytes or words, from which numbers are taken.
class Body {
 public:
  Body(const std::string& path, std::string_view text, Encoding encoding)
      : path_(path), rest_(text), encoding_(encoding) {}

  // With the line end that the last line of a text may lack.
  std::uint64_t left() const { return rest_.size() + (is_text() ? 1 : 0); }
  bool is_text() const { return encoding_ == Encoding::kAscii; }

  void Take(const CloudColumn& column, PointSet& points) {
    if (!is_text()) return points.Set(column, TakeBytes(SizeOf(column.type)), encoding_ == Encoding::kBigEndian);
    const std::string_view word = TakeText();
    if (!points.Set(column, word)) Fail(Concat("expected a number for ", column.name, ", found ", Excerpt(word)));
  }
  void Skip(NumberType type, std::uint64_t count) {
    if (is_text()) {
      for (; count > 0; --count) TakeText();
    } else {
      if (count > rest_.size() / SizeOf(type)) Fail("the file ends here");
      rest_.remove_prefix(count * SizeOf(type));
    }
  }
  std::uint64_t TakeLength(NumberType type) {
    if (is_text()) {
      const auto length = ParseNumber<std::uint64_t>(TakeText());
      if (!length) Fail("expected the length of a list");
      return *length;
    }
    const std::byte* bytes = TakeBytes(SizeOf(type));
    std::uint64_t length = 0;
    for (std::size_t i = 0; i < SizeOf(type); ++i) {
      const std::size_t at = encoding_ == Encoding::kBigEndian ? i : SizeOf(type) - 1 - i;
      length = length << 8 | static_cast<std::uint8_t>(bytes[at]);
    }
    return length;
  }
  void SetPlace(std::string_view element, std::uint64_t row) { element_ = element, row_ = row; }
  [[noreturn]] void Fail(const std::string& problem) const {
    throw Error(ErrorKind::kDamaged, path_, Concat(element_, " ", row_), problem);
  }

 private:
  const std::byte* TakeBytes(std::size_t size) {
    if (rest_.size() < size) Fail("the file ends here");
    const auto* bytes = reinterpret_cast<const std::byte*>(rest_.data());
    rest_.remove_prefix(size);
    return bytes;
  }
  std::string_view TakeText() {
    const std::string_view word = TakeWord(rest_, kSpaces);
    if (word.empty()) Fail("the file ends here");
    return word;
  }

  const std::string& path_;
  std::string_view rest_;
  Encoding encoding_;
  std::string_view element_;
  std::uint64_t row_ = 0;
};

void SkipElement(const std::string& path, const Element& element, Body& body) {
  if (element.properties.empty()) return;
  RequireRoom(path, element.count, element.least_bytes(body.is_text()), body.left());
  for (std::uint64_t row = 0; row < element.count; ++row) {
    body.SetPlace(element.name, row);
    for (const Property& property : element.properties)
      body.Skip(property.column.type, property.count ? body.TakeLength(*property.count) : 1);
  }
}

PointSet ReadVertices(const std::string& path, const Element& element, Body& body) {
  std::vector<CloudColumn> columns;
  for (const Property& property : element.properties) columns.push_back(property.column);
  PointSet points(path, columns);
  RequireRoom(path, element.count, element.least_bytes(body.is_text()), body.left());
  points.Reserve(element.count);
  for (std::uint64_t row = 0; row < element.count; ++row) {
    body.SetPlace(element.name, row);
    points.BeginPoint();
    for (const Property& property : element.properties)
      if (property.count)
        body.Skip(property.column.type, body.TakeLength(*property.count));
      else
        body.Take(property.column, points);
    points.EndPoint();
  }
  return points;
}

}  // namespace

Atlas ReadPly(const Source& source, const ReadOptions& options, Notices& notices) {
  const WholeFile file(source);
  std::string_view text = file.text();
  const Header header = HeaderReader(file.path()).Read(text);
  const auto vertices = std::ranges::find(header.elements, "vertex", &Element::name);
  if (vertices == header.elements.end())
    throw Error(ErrorKind::kUnsupported, file.path(), "",
                "is a PLY without an element `vertex`, and so without points");
  Body body(file.path(), text, header.encoding);
  if (body.is_text()) WarnOfOpenEnd(file.text(), file.path(), notices);
  for (auto element = header.elements.begin(); element != vertices; ++element) SkipElement(file.path(), *element, body);
  Atlas atlas = ReadVertices(file.path(), *vertices, body).Finish(options.selection, notices);
  for (const Element& element : header.elements)
    if (element.name != "vertex" && element.name != "edge" && element.count > 0)
      notices.Lose(
          Concat("an atlas has no place for elements `", element.name, "`: ", Thousands(element.count), " left out"));
  return atlas;
}

}  // namespace slamdb::detail
