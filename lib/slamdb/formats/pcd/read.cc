// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/pcd/detail/read.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/open_end.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/formats/pcd/detail/lzf.h"
#include "slamdb/formats/points/detail/point_set.h"

namespace slamdb::detail {
namespace {

constexpr std::string_view kPadding = "_";  // of PCL's, so many bytes
constexpr std::string_view kSpaces = " \t\r\n";
constexpr std::string_view kUsualViewpoint = "0 0 0 1 0 0 0";  // position, rotation: the points are in the world
constexpr std::uint64_t kMostNumbers = 65536;                  // of one point, more than any sensor has

enum class Data { kAscii, kBinary, kCompressed };

struct Field {
  CloudColumn column;
  std::uint64_t count = 1;  // numbers of it, as histograms have
  std::uint64_t bytes() const { return count * SizeOf(column.type); }
};
struct Header {
  std::string viewpoint;  // where it is not the usual one
  std::vector<Field> fields;
  std::uint64_t points = 0;
  Data data = Data::kAscii;

  std::uint64_t row_bytes() const {
    std::uint64_t bytes = 0;
    for (const Field& field : fields) bytes += field.bytes();
    return bytes;
  }
  std::uint64_t numbers() const {
    std::uint64_t numbers = 0;
    for (const Field& field : fields) numbers += field.count;
    return numbers;
  }
};

// PCD's letter and size of a type.
std::optional<NumberType> TypeOf(std::string_view letter, std::uint64_t size) {
  constexpr NumberType kSigned[] = {NumberType::kInt8, NumberType::kInt16, NumberType::kInt32, NumberType::kInt64};
  constexpr NumberType kUnsigned[] = {NumberType::kUint8, NumberType::kUint16, NumberType::kUint32,
                                      NumberType::kUint64};
  constexpr std::array<std::uint64_t, 4> kSizes{1, 2, 4, 8};
  const auto found = std::ranges::find(kSizes, size);
  if (found == kSizes.end()) return std::nullopt;
  if (letter == "I") return kSigned[found - kSizes.begin()];
  if (letter == "U") return kUnsigned[found - kSizes.begin()];
  if (letter == "F" && size >= 4) return size == 4 ? NumberType::kFloat : NumberType::kDouble;
  return std::nullopt;
}

class HeaderReader {
 public:
  explicit HeaderReader(const std::string& path) : path_(path) {}

  // Takes the header off the text.
  Header Read(std::string_view& text) {
    while (!text.empty()) {
      ++line_;
      std::string_view line = TakeLine(text);
      const std::string_view key = TakeWord(line, kBlanks);
      if (key.empty() || key.starts_with('#')) continue;
      if (key == "DATA") return Finish(Trimmed(line));
      ReadLine(key, line);
    }
    Fail("the file ends in its header, before a line DATA");
  }

 private:
  [[noreturn]] void Fail(const std::string& problem) const {
    throw Error(ErrorKind::kDamaged, path_, Concat("line ", line_), problem);
  }
  std::uint64_t Whole(std::string_view word) const {
    const auto number = ParseNumber<std::uint64_t>(word);
    if (!number) Fail(Concat("expected a whole number, found ", Excerpt(word)));
    return *number;
  }
  static std::vector<std::string_view> Words(std::string_view line) {
    std::vector<std::string_view> words;
    for (std::string_view word = TakeWord(line, kBlanks); !word.empty(); word = TakeWord(line, kBlanks))
      words.push_back(word);
    return words;
  }
  void ReadLine(std::string_view key, std::string_view line) {
    if (key == "FIELDS" || key == "COLUMNS")
      names_ = Words(line);
    else if (key == "SIZE")
      sizes_ = Words(line);
    else if (key == "TYPE")
      types_ = Words(line);
    else if (key == "COUNT")
      counts_ = Words(line);
    else if (key == "WIDTH")
      width_ = Whole(Trimmed(line));
    else if (key == "HEIGHT")
      height_ = Whole(Trimmed(line));
    else if (key == "POINTS")
      points_ = Whole(Trimmed(line));
    else if (key == "VERSION")
      RequireVersion(Trimmed(line));
    else if (key == "VIEWPOINT")
      viewpoint_ = Trimmed(line);
    else
      Fail(Concat("expected a line of a header, found ", Excerpt(key)));
  }
  void RequireVersion(std::string_view version) const {
    const std::string_view minor = version.substr(version.starts_with('0') ? 1 : 0);
    if (minor == ".5" || minor == ".6" || minor == ".7") return;
    throw Error(ErrorKind::kUnsupported, path_, Concat("line ", line_),
                Concat("PCD of version ", Excerpt(version), "; 0.5 to 0.7 are read"));
  }
  Header Finish(std::string_view data) {
    Header header;
    constexpr std::array<std::string_view, 3> kNames{"ascii", "binary", "binary_compressed"};
    const auto found = std::ranges::find(kNames, data);
    if (found == kNames.end()) Fail(Concat("expected ascii, binary or binary_compressed, found ", Excerpt(data)));
    header.data = static_cast<Data>(found - kNames.begin());
    if (names_.empty() || sizes_.size() != names_.size() || types_.size() != names_.size() ||
        (!counts_.empty() && counts_.size() != names_.size()))
      Fail("FIELDS, SIZE, TYPE and COUNT are to have as many words each");
    for (std::size_t i = 0; i < names_.size(); ++i) header.fields.push_back(FieldAt(i));
    if (header.numbers() > kMostNumbers) Fail(Concat("points of ", header.numbers(), " numbers each"));
    header.points = PointCount();
    if (viewpoint_ != kUsualViewpoint) header.viewpoint = viewpoint_;
    return header;
  }
  Field FieldAt(std::size_t i) const {
    Field field;
    const auto type = TypeOf(types_[i], Whole(sizes_[i]));
    if (!type) Fail(Concat("there is no type ", Excerpt(types_[i]), " of ", sizes_[i], " bytes"));
    field.count = counts_.empty() ? 1 : std::min(Whole(counts_[i]), kMostNumbers + 1);
    field.column = {*type, field.count == 1 ? FieldByName(names_[i]) : PointField::kUnknown, std::string(names_[i])};
    if (names_[i] == kPadding) field.column.field = PointField::kPadding;
    return field;
  }
  std::uint64_t PointCount() const {
    const bool overflows = width_ != 0 && height_ > std::numeric_limits<std::uint64_t>::max() / width_;
    if (overflows || (points_ && (width_ != 0 || height_ != 0) && *points_ != width_ * height_))
      Fail("POINTS is not WIDTH times HEIGHT");
    return points_.value_or(width_ * height_);
  }

  const std::string& path_;
  std::uint64_t line_ = 0, width_ = 0, height_ = 0;
  std::optional<std::uint64_t> points_;
  std::string_view viewpoint_ = kUsualViewpoint;
  std::vector<std::string_view> names_, sizes_, types_, counts_;
};

PointSet Points(const std::string& path, const Header& header) {
  std::vector<CloudColumn> columns;
  for (const Field& field : header.fields) columns.push_back(field.column);
  PointSet points(path, columns);
  points.Reserve(header.points);
  return points;
}

PointSet ReadAscii(const std::string& path, const Header& header, std::string_view text) {
  RequireRoom(path, header.points, 2 * header.numbers(), text.size() + 1);
  PointSet points = Points(path, header);
  for (std::uint64_t row = 0; row < header.points; ++row) {
    points.BeginPoint();
    for (const Field& field : header.fields)
      for (std::uint64_t i = 0; i < field.count; ++i) {
        const std::string_view word = TakeWord(text, kSpaces);
        if (word.empty() || (field.count == 1 && !points.Set(field.column, word)))
          throw Error(ErrorKind::kDamaged, path, Concat("point ", row),
                      word.empty() ? "the file ends here"
                                   : Concat("expected a number for ", field.column.name, ", found ", Excerpt(word)));
      }
    points.EndPoint();
  }
  return points;
}

// Where the numbers of a column are: the first, and how far it is from one point to the next.
struct Place {
  const CloudColumn* column;
  std::uint64_t first, step;
};

// Point after point, or `by_field` all numbers of a field behind those of the one before, as PCL compresses them.
std::vector<Place> PlacesOf(const Header& header, bool by_field) {
  std::vector<Place> places;
  std::uint64_t before = 0;  // bytes of a point in the fields before
  for (const Field& field : header.fields) {
    if (field.count == 1)
      places.push_back(by_field ? Place{&field.column, before * header.points, field.bytes()}
                                : Place{&field.column, before, header.row_bytes()});
    before += field.bytes();
  }
  return places;
}

PointSet ReadBinary(const std::string& path, const Header& header, std::string_view bytes, bool by_field) {
  RequireRoom(path, header.points, header.row_bytes(), bytes.size());
  PointSet points = Points(path, header);
  const std::vector<Place> places = PlacesOf(header, by_field);
  const auto* data = reinterpret_cast<const std::byte*>(bytes.data());
  for (std::uint64_t row = 0; row < header.points; ++row) {
    points.BeginPoint();
    for (const Place& place : places)
      points.Set(*place.column, data + place.first + row * place.step, /*swapped=*/false);
    points.EndPoint();
  }
  return points;
}

PointSet ReadCompressed(const std::string& path, const Header& header, std::string_view bytes) {
  std::array<std::uint32_t, 2> sizes{};  // compressed, uncompressed
  if (bytes.size() < sizeof sizes) throw Error(ErrorKind::kDamaged, path, "", "the file ends behind its header");
  std::memcpy(sizes.data(), bytes.data(), sizeof sizes);
  bytes.remove_prefix(sizeof sizes);
  if (sizes[0] > bytes.size())
    throw Error(ErrorKind::kDamaged, path, "",
                Concat("claims ", sizes[0], " compressed bytes, but ", bytes.size(), " follow; the file is cut off"));
  RequireRoom(path, header.points, header.row_bytes(), sizes[1]);
  const auto data = DecompressLzf(bytes.substr(0, sizes[0]), sizes[1]);
  if (!data) throw Error(ErrorKind::kDamaged, path, "", "its compressed points cannot be decompressed");
  return ReadBinary(path, header, *data, /*by_field=*/true);
}

PointSet ReadPoints(const std::string& path, const Header& header, std::string_view body) {
  if (header.points == 0) return Points(path, header);
  if (header.data == Data::kAscii) return ReadAscii(path, header, body);
  if (header.data == Data::kBinary) return ReadBinary(path, header, body, /*by_field=*/false);
  return ReadCompressed(path, header, body);
}

}  // namespace

Atlas ReadPcd(const Source& source, const ReadOptions& options, Notices& notices) {
  const WholeFile file(source);
  std::string_view text = file.text();
  const Header header = HeaderReader(file.path()).Read(text);
  if (header.data == Data::kAscii) WarnOfOpenEnd(file.text(), file.path(), notices);
  Atlas atlas = ReadPoints(file.path(), header, text).Finish(options.selection, notices);
  if (!header.viewpoint.empty())
    notices.Lose(Concat("the viewpoint ", Excerpt(header.viewpoint),
                        " of the cloud is left out; the points stay where they are"));
  return atlas;
}

}  // namespace slamdb::detail
