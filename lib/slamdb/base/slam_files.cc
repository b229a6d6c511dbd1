// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/slam_files.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"

namespace slamdb::detail {
namespace {

using std::string_view_literals::operator""sv;

// ---- binary records, read one behind the other

// A cursor over the head of a file. What lies behind the head counts as fitting.
class Records {
 public:
  Records(std::string_view head, std::uint64_t size) : head_(head), size_(size) {}

  template <class Value>
  Value Take() {
    Value value{};
    if (at_ + sizeof value <= head_.size()) std::memcpy(&value, head_.data() + at_, sizeof value);
    Skip(sizeof value);
    return value;
  }
  template <std::size_t count>
  std::array<double, count> TakeDoubles() {
    std::array<double, count> values{};
    for (double& value : values) value = Take<double>();
    return values;
  }
  // Up to a zero byte. False when there is none soon, or the name is not printable.
  bool PassName() {
    constexpr std::size_t kLongest = 1024;
    const std::size_t end = head_.find('\0', std::min(at_, head_.size()));
    if (end == std::string_view::npos) return Behind() || head_.size() - at_ < kLongest;
    const std::string_view name = head_.substr(at_, end - at_);
    at_ = end + 1;
    return name.size() < kLongest && !name.empty() &&
           std::all_of(name.begin(), name.end(), [](char c) { return static_cast<unsigned char>(c) >= 0x20; });
  }
  void Skip(std::uint64_t bytes) {
    at_ = bytes > size_ - std::min<std::uint64_t>(at_, size_) ? size_ + 1 : at_ + static_cast<std::size_t>(bytes);
  }

  bool Behind() const { return at_ >= head_.size() && size_ > head_.size(); }  // of the bytes that are known
  bool AtEnd() const { return at_ == size_; }
  bool BeyondEnd() const { return at_ > size_; }

 private:
  std::string_view head_;
  std::uint64_t size_;
  std::size_t at_ = 0;
};

template <std::size_t count>
bool AreFinite(const std::array<double, count>& values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return std::abs(value) < 1e12; });
}

bool IsUnit(const std::array<double, 4>& quaternion) {
  double square = 0;
  for (const double value : quaternion) square += value * value;
  return std::abs(square - 1) < 1e-3;
}

// Whether a count and as many records as `pass` takes make the file, as far as its beginning is known.
template <class Pass>
bool IsListOf(const Probe& probe, const Pass& pass) {
  constexpr std::uint64_t kLeastRecord = 8;
  Records records(probe.head, probe.size);
  const auto count = records.Take<std::uint64_t>();
  if (count == 0 || count > probe.size / kLeastRecord) return false;
  for (std::uint64_t i = 0; i < count; ++i) {
    if (i > 0 && records.Behind()) return true;
    if (records.BeyondEnd() || !pass(records)) return false;
  }
  return records.AtEnd() || records.Behind();
}

// ---- Protocol Buffers

// The field `tag` of a length and as many bytes; nothing when another stands there.
std::optional<std::string_view> TakeField(std::string_view& message, char tag) {
  if (message.empty() || message[0] != tag) return std::nullopt;
  std::uint64_t length = 0;
  std::size_t at = 1;
  for (unsigned shift = 0; shift < 35; shift += 7, ++at) {
    if (at >= message.size()) return std::nullopt;
    const auto byte = static_cast<unsigned char>(message[at]);
    length |= std::uint64_t{byte & 0x7fU} << shift;
    if (byte < 0x80) break;
  }
  const std::string_view content = message.substr(std::min(at + 1, message.size()), length);
  message.remove_prefix(std::min<std::size_t>(message.size(), at + 1 + content.size()));
  return content;
}

// Takes the field `tag` of a number off a message where it stands there.
void SkipNumber(std::string_view& message, char tag) {
  if (!message.starts_with(tag)) return;
  message.remove_prefix(1);
  while (!message.empty() && (static_cast<unsigned char>(message[0]) & 0x80U) != 0) message.remove_prefix(1);
  message.remove_prefix(std::min<std::size_t>(1, message.size()));
}

// ---- text

std::string_view FirstLine(std::string_view text) { return TakeLine(text); }

std::vector<std::string_view> Words(std::string_view line) {
  std::vector<std::string_view> words;
  for (auto word = TakeWord(line, kBlanks); !word.empty(); word = TakeWord(line, kBlanks)) words.push_back(word);
  return words;
}

}  // namespace

// ---- COLMAP

constexpr std::array<std::uint8_t, 18> kColmapParameters = {3, 4, 4, 5, 8, 8, 12, 5, 4, 5, 12, 16, 4, 5, 3, 4, 6, 2};

bool IsColmapCameras(const Probe& probe) {
  return IsListOf(probe, [](Records& records) {
    records.Take<std::uint32_t>();
    const auto model = records.Take<std::int32_t>();
    const auto width = records.Take<std::uint64_t>(), height = records.Take<std::uint64_t>();
    if (model < 0 || model >= static_cast<int>(kColmapParameters.size())) return false;
    for (int i = 0; i < kColmapParameters[static_cast<std::size_t>(model)]; ++i)
      if (!AreFinite(records.TakeDoubles<1>())) return false;
    constexpr std::uint64_t kMostPixels = 1'000'000;
    return width > 0 && width < kMostPixels && height > 0 && height < kMostPixels;
  });
}

bool IsColmapImages(const Probe& probe) {
  return IsListOf(probe, [](Records& records) {
    records.Take<std::uint32_t>();
    const bool unit = IsUnit(records.TakeDoubles<4>());
    const bool finite = AreFinite(records.TakeDoubles<3>());
    records.Take<std::uint32_t>();
    const bool named = records.PassName();
    if (!unit || !finite || !named) return false;
    records.Skip(std::min(records.Take<std::uint64_t>(), std::uint64_t{1} << 40U) * 24);
    return true;
  });
}

bool IsColmapPoints(const Probe& probe) {
  return IsListOf(probe, [](Records& records) {
    records.Take<std::uint64_t>();
    const bool finite = AreFinite(records.TakeDoubles<3>());
    records.Skip(3);
    const double error = records.Take<double>();
    records.Skip(std::min(records.Take<std::uint64_t>(), std::uint64_t{1} << 40U) * 8);
    return finite && error >= -1 && error < 1e6;
  });
}

bool IsColmapFrames(const Probe& probe) {
  return IsListOf(probe, [](Records& records) {
    records.Skip(8);
    const bool unit = IsUnit(records.TakeDoubles<4>());
    const bool finite = AreFinite(records.TakeDoubles<3>());
    records.Skip(std::uint64_t{records.Take<std::uint32_t>()} * 16);
    return unit && finite;
  });
}

bool IsColmapCamerasText(const Probe& probe) {
  if (probe.head.starts_with("# Camera list with one line of data per camera")) return true;
  constexpr std::array kModels = {"SIMPLE_PINHOLE"sv, "PINHOLE"sv, "SIMPLE_RADIAL"sv,
                                  "RADIAL"sv,         "OPENCV"sv,  "OPENCV_FISHEYE"sv,
                                  "FULL_OPENCV"sv,    "FOV"sv,     "SIMPLE_RADIAL_FISHEYE"sv};
  const std::vector<std::string_view> words = Words(FirstLine(probe.head));
  return words.size() >= 7 && ParseNumber<std::uint32_t>(words[0]) &&
         std::find(kModels.begin(), kModels.end(), words[1]) != kModels.end();
}

// `1 qw qx qy qz tx ty tz 1 name.png`.
bool IsColmapImagesText(const Probe& probe) {
  if (probe.head.starts_with("# Image list with two lines of data per image")) return true;
  const std::vector<std::string_view> words = Words(FirstLine(probe.head));
  if (words.size() != 10 || !ParseNumber<std::uint32_t>(words[0]) || !ParseNumber<std::uint32_t>(words[8]))
    return false;
  std::array<double, 4> quaternion{};
  for (std::size_t i = 0; i < 4; ++i) quaternion[i] = ParseNumber<double>(words[i + 1]).value_or(0);
  return IsUnit(quaternion) && !ParseNumber<double>(words[9]);
}

// ---- ORB-SLAM2

// Pointers as Boost writes them without a header: a map of ORB-SLAM2 begins with its first class and a set of points.
bool IsOrbslam2Map(const Probe& probe) {
  constexpr std::string_view kStart = "\0\0\1\0\0\0\0\0\0\0\0\0\0\0\0\0"sv;
  if (!probe.head.starts_with(kStart)) return false;
  Records records(std::string_view(probe.head).substr(kStart.size()), probe.size - kStart.size());
  const auto points = records.Take<std::uint64_t>();
  return points > 0 && points < probe.size && records.Take<std::uint32_t>() == 0;
}

// An optional id, then a position of three floats or a pose of twelve; of features, their keyframe and slots.
std::string_view OsmapPart(const Probe& probe) {
  std::string_view head = probe.head;
  std::optional<std::string_view> first = TakeField(head, '\x0a');
  if (!first) return {};
  std::string_view entry = *first;
  SkipNumber(entry, '\x08');
  std::string_view inner = TakeField(entry, '\x12').value_or(""sv);
  if (inner.size() >= 5 && inner.size() <= 15 && inner.size() % 5 == 0 && (inner[0] & 7) == 5) return "map points";
  if (inner.size() == 50 && inner.starts_with("\x0a\x30"sv)) return "keyframes";
  SkipNumber(inner, '\x10');
  return inner.starts_with("\x1a\x14"sv) || inner.starts_with("\x1a\x0f"sv) ? "features"sv : ""sv;
}

// ---- vocabularies

// The first line of a DBoW2 vocabulary as text: branching factor, depth, scoring and weighting; a node behind it.
bool IsVocabulary(const Probe& probe) {
  if (IsUtf16(probe.head)) return false;
  std::string_view head = WithoutMark(probe.head);
  const std::vector<std::string_view> words = Words(TakeLine(head));
  if (words.size() != 4) return false;
  constexpr std::array<std::array<int, 2>, 4> kRanges = {{{2, 20}, {1, 10}, {0, 5}, {0, 3}}};
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto number = ParseNumber<int>(words[i]);
    if (!number || *number < kRanges[i][0] || *number > kRanges[i][1]) return false;
  }
  constexpr std::size_t kOfNode = 34;  // parent, whether it is a word, descriptor; and a weight
  const bool whole = head.find('\n') != head.npos;
  return head.empty() || !whole || Words(TakeLine(head)).size() >= kOfNode;
}

bool IsBinaryVocabulary(const Probe& probe) {
  constexpr std::uint32_t kRecord = 41;
  Records records(probe.head, probe.size);
  const auto nodes = records.Take<std::uint32_t>(), bytes = records.Take<std::uint32_t>();
  const auto branching = records.Take<std::uint32_t>(), depth = records.Take<std::uint32_t>();
  return bytes == kRecord && nodes > 1 && branching >= 2 && branching <= 64 && depth >= 1 && depth <= 20;
}

// ---- MRPT

// MRPT writes `0x80 | length` before the class name of an object, behind it a version and, in a map, a count.
std::optional<Recognized> RecognizeMrpt(std::string_view head) {
  constexpr std::string_view kLandmarksClass = "mrpt::maps::CLandmarksMap";
  const auto first = head.empty() ? 0U : static_cast<unsigned char>(head[0]);
  if (first <= 0x80) return std::nullopt;
  const std::string_view name = head.substr(1, first & 0x7fU);
  if (!name.empty() && kLandmarksClass.starts_with(name) && head.size() < kLandmarksClass.size() + 6)
    return Recognized{"mrpt", ErrorKind::kDamaged, "the beginning of a landmarks map of MRPT",
                      "it ends in its header: the file is truncated"};
  if (name == "CSimpleMap" || name == "mrpt::maps::CSimpleMap")
    return Recognized{"simplemap", ErrorKind::kUnsupported,
                      "a simplemap of MRPT (poses and observations of a robot, no visual map)",
                      "of MRPT's files slamdb reads landmarks maps"};
  if (!name.starts_with("mrpt::") && !name.starts_with("CLandmark")) return std::nullopt;
  std::string what(name);
  if (head.size() > 1 + name.size())
    what += " of version " + std::to_string(static_cast<unsigned char>(head[1 + name.size()]));
  return Recognized{"mrpt", ErrorKind::kUnsupported, Concat("a file of MRPT objects (", what, ")"),
                    "of those slamdb reads landmarks maps of MRPT 2 and 3"};
}

}  // namespace slamdb::detail
