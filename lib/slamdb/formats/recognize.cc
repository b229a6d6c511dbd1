// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/detail/recognize.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <vector>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"

namespace slamdb::detail {
namespace {

using std::string_view_literals::operator""sv;

// A file that begins with `signature` at `offset`, and what to say of it.
struct Signature {
  std::size_t offset;
  std::string_view signature;
  std::string_view sentence;
};

constexpr std::array kSignatures = {
    Signature{0, "\x1f\x8b"sv,
              "not an atlas: this is gzip-compressed, and what is in it, or left of it, does not begin like a "
              "landmarks map of MRPT, the only kind that slamdb reads so; if it is an atlas, unpack it first (gunzip)"},
    Signature{0, "\xfd\x37zXZ\x00"sv, "not an atlas: this is xz-compressed; unpack it first (unxz)"},
    Signature{0, "\x28\xb5\x2f\xfd"sv, "not an atlas: this is zstd-compressed; unpack it first (unzstd)"},
    Signature{0, "BZh"sv, "not an atlas: this is bzip2-compressed; unpack it first (bunzip2)"},
    Signature{0, "PK\x03\x04"sv, "not an atlas: this is a zip archive; unpack it and give the atlas file in it"},
    Signature{0, "7z\xbc\xaf\x27\x1c"sv, "not an atlas: this is a 7z archive; unpack it and give the atlas file in it"},
    Signature{257, "ustar"sv, "not an atlas: this is a tar archive; unpack it and give the atlas file in it"},
    Signature{0, "\x89PNG\r\n\x1a\n"sv, "not an atlas: this is a PNG image"},
    Signature{0, "\xff\xd8\xff"sv, "not an atlas: this is a JPEG image"},
    Signature{0, "%PDF-"sv, "not an atlas: this is a PDF document"},
    Signature{0,
              "\x7f"
              "ELF"sv,
              "not an atlas: this is a program or library (ELF)"},
    Signature{0, "#ROSBAG V"sv,
              "not an atlas: this is a ROS bag, the recording a map is made from; run a SLAM system on it and give the "
              "atlas that it saves"},
    Signature{
        0, "\x89MCAP"sv,
        "not an atlas: this is an MCAP recording (ROS 2), which a map is made from; run a SLAM system on it and give "
        "the atlas that it saves"},
    Signature{0, "\x89HDF\r\n\x1a\n"sv, "not an atlas: this is an HDF5 file"},
    Signature{0, "version https://git-lfs.github.com/spec/"sv,
              "not an atlas: this is a Git LFS pointer that stands for the file; fetch the file itself (git lfs pull)"},
    Signature{0, "<?xml"sv, "not an atlas: this is an XML file; ORB-SLAM3 saves binary or text archives"},
    Signature{0, "<!DOCTYPE"sv,
              "not an atlas: this is a web page; was it saved in place of the file that was to be downloaded?"},
    Signature{0, "<html"sv,
              "not an atlas: this is a web page; was it saved in place of the file that was to be downloaded?"},
};

// MRPT writes `0x80 | length` before the class name of an object, behind it a version and, in a map, a count.
constexpr std::string_view kMrptLandmarksClass = "mrpt::maps::CLandmarksMap";
constexpr std::string_view kMrptLandmarks =
    "not an atlas: this is a file of MRPT objects (%); of those slamdb reads landmarks maps of MRPT 2 and 3";

bool HasAt(std::string_view text, std::size_t offset, std::string_view part) {
  return text.size() >= offset + part.size() && text.compare(offset, part.size(), part) == 0;
}

// SQLite keeps the text of its CREATE TABLE statements in the first page, and in further ones when there are many.
std::string DescribeSqlite(const Probe& probe) {
  const MappedFile file(probe.memory ? Source(*probe.memory, probe.path) : Source(probe.path));
  const std::string_view text = file.text().substr(0, std::size_t{1} << 20);
  const auto has = [text](std::string_view part) { return text.find(part) != std::string_view::npos; };
  if (has("two_view_geometries") && has("keypoints"))
    return "not an atlas: this is a COLMAP database (features and matches, no map)";
  if (has("TABLE Node") && has("TABLE Link") && has("TABLE Admin"))
    return "not an atlas: this is an RTAB-Map database, which slamdb does not read";
  if (has("undist_keypts") && has("associations"))
    return "not an atlas: this is a stella_vslam map database, which slamdb does not read";
  if (has("serialized_data") || (has("TABLE topics") && has("TABLE messages")))
    return "not an atlas: this is a ROS 2 bag, the recording a map is made from; run a SLAM system on it and give the "
           "atlas that it saves";
  return "not an atlas: this is an SQLite database, but not a slamdb store";
}

ForeignFile DescribeDirectory(const std::string& path) {
  std::vector<std::string> names;
  std::error_code failed;
  for (std::filesystem::directory_iterator entry(path, failed), end; !failed && entry != end; entry.increment(failed))
    names.push_back(entry->path().filename().string());
  std::sort(names.begin(), names.end());
  const auto has = [&names](std::string_view name) { return std::binary_search(names.begin(), names.end(), name); };
  if ((has("images.bin") && has("points3D.bin")) || (has("images.txt") && has("points3D.txt")))
    return {ErrorKind::kUnsupported, "not an atlas: this folder is a COLMAP model, which slamdb does not read"};
  if (has("metadata.yaml"))
    return {ErrorKind::kUnsupported,
            "not an atlas: this folder is a ROS 2 bag; run a SLAM system on it and give the atlas that it saves"};
  const auto atlas =
      std::find_if(names.begin(), names.end(), [](const std::string& name) { return name.ends_with(".osa"); });
  std::string problem = "is a directory, expected an atlas file";
  if (atlas != names.end()) problem += "; did you mean " + (std::filesystem::path(path) / *atlas).string() + "?";
  return {ErrorKind::kUsage, std::move(problem)};
}

// The first line of a DBoW2 vocabulary as text: branching factor, depth, scoring and weighting.
bool IsVocabulary(std::string_view head) {
  if (IsUtf16(head)) return false;
  head = WithoutMark(head);
  std::string_view line = TakeLine(head);
  std::vector<int> numbers;
  for (auto word = TakeWord(line, kBlanks); !word.empty(); word = TakeWord(line, kBlanks)) {
    const auto number = ParseNumber<int>(word);
    if (!number) return false;
    numbers.push_back(*number);
  }
  const auto within = [](int value, int low, int high) { return value >= low && value <= high; };
  return numbers.size() == 4 && within(numbers[0], 2, 20) && within(numbers[1], 1, 10) && within(numbers[2], 0, 5) &&
         within(numbers[3], 0, 3);
}

std::optional<std::string> RecognizeText(std::string_view head) {
  if (IsVocabulary(head))
    return "not an atlas: this is a DBoW2 vocabulary as ORB-SLAM3 uses it; ReadVocabularyFile tells its name and MD5";
  if (head.starts_with("%YAML"))
    return head.find("mappointsFile") != std::string_view::npos
               ? "not an atlas: this is the header of an osmap map (ORB-SLAM2), which slamdb does not read"
               : "not an atlas: this is a YAML file of OpenCV, such as the settings of ORB-SLAM3; the atlas is the "
                 ".osa "
                 "file that System.SaveAtlasToFile names in it";
  return std::nullopt;
}

std::optional<ForeignFile> RecognizeObjects(std::string_view head) {
  if (head.substr(0, 64).find("serialization::archive") != std::string_view::npos)
    return ForeignFile{
        ErrorKind::kUnsupported,
        "not an atlas: this is an archive of Boost.Serialization, but what it holds is not an ORB-SLAM3 v1.0 atlas"};
  // A MessagePack map whose first key, in byte order, is `cameras`.
  const auto first = head.empty() ? 0U : static_cast<unsigned char>(head[0]);
  const std::size_t key = first >= 0x80 && first <= 0x8f ? 1 : first == 0xde ? 3 : 0;
  if (key > 0 && HasAt(head, key,
                       "\xa7"
                       "cameras"))
    return ForeignFile{ErrorKind::kUnsupported,
                       "not an atlas: this is a stella_vslam map (MessagePack), which slamdb does not read"};
  const std::string_view name = head.substr(std::min<std::size_t>(1, head.size()), first & 0x7fU);
  if (first > 0x80 && kMrptLandmarksClass.starts_with(name) && head.size() < kMrptLandmarksClass.size() + 6)
    return ForeignFile{ErrorKind::kDamaged, "ends in the header of a landmarks map of MRPT: the file is truncated"};
  if (first > 0x80 && (name.starts_with("mrpt::") || name.starts_with("CLandmark"))) {
    std::string what(name);
    if (head.size() > 1 + name.size())
      what += " of version " + std::to_string(static_cast<unsigned char>(head[1 + name.size()]));
    return ForeignFile{ErrorKind::kUnsupported, std::string(kMrptLandmarks).replace(kMrptLandmarks.find('%'), 1, what)};
  }
  return std::nullopt;
}

}  // namespace

std::optional<ForeignFile> RecognizeOther(const Probe& probe) {
  if (probe.is_directory) return DescribeDirectory(probe.path);
  if (probe.size == 0)
    return ForeignFile{ErrorKind::kDamaged, "is empty; was the program that saved it stopped before it could?"};
  const std::string_view head = probe.head;
  if (std::all_of(head.begin(), head.end(), [](char byte) { return byte == 0; }))
    return ForeignFile{
        ErrorKind::kDamaged,
        Concat("begins with ", head.size(),
               " zero bytes and holds no atlas there; was the disk full or the power cut while it was saved? "
               "SalvageAtlas looks for what stands behind them")};
  if (head.starts_with("SQLite format 3\0"sv)) return ForeignFile{ErrorKind::kUnsupported, DescribeSqlite(probe)};
  for (const Signature& known : kSignatures)
    if (HasAt(head, known.offset, known.signature))
      return ForeignFile{ErrorKind::kUnsupported, std::string(known.sentence)};
  if (auto objects = RecognizeObjects(head)) return objects;
  if (auto text = RecognizeText(head)) return ForeignFile{ErrorKind::kUnsupported, *std::move(text)};
  return std::nullopt;
}

std::string DescribeUnknown(const Probe& probe) {
  const bool text = std::all_of(probe.head.begin(), probe.head.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte >= 0x20 ? byte != 0x7f : byte == '\n' || byte == '\r' || byte == '\t' || byte == '\f';
  });
  if (text) return "not an atlas: this looks like a text file, of no kind that slamdb reads";
  return "not an atlas: neither its first bytes nor its suffix are of a kind that slamdb reads";
}

}  // namespace slamdb::detail
