// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/recognize.h"

#include <algorithm>
#include <cctype>
#include <span>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/opened_input.h"
#include "slamdb/base/detail/run_files.h"
#include "slamdb/base/detail/slam_files.h"
#include "slamdb/base/detail/text.h"

namespace slamdb::detail {
namespace {

using std::string_view_literals::operator""sv;

bool HasAt(std::string_view text, std::size_t offset, std::string_view part) {
  return text.size() >= offset + part.size() && text.compare(offset, part.size(), part) == 0;
}

bool Has(std::string_view text, std::string_view part) { return text.find(part) != std::string_view::npos; }

// ---- zeros

constexpr std::size_t kZeroPage = 4096;  // as a disk leaves that was not written in time

std::size_t CountZeros(std::string_view head) { return std::min(head.find_first_not_of('\0'), head.size()); }

// ---- text

bool StartsWithIgnoringCase(std::string_view text, std::string_view lower) {
  return text.size() >= lower.size() && std::equal(lower.begin(), lower.end(), text.begin(), [](char a, char b) {
           return a == static_cast<char>(std::tolower(static_cast<unsigned char>(b)));
         });
}

// Without a byte order mark, blanks and line ends in front.
std::string_view Stripped(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  return text;
}

bool IsWebPage(const Probe& probe) {
  const std::string_view text = Stripped(probe.head);
  for (const std::string_view start : {"<!doctype html"sv, "<html"sv, "<head"sv, "<body"sv})
    if (StartsWithIgnoringCase(text, start)) return true;
  return text.starts_with("<!--") && (Has(text, "<html") || Has(text, "<!DOCTYPE html"));
}

bool IsXmlOf(const Probe& probe, std::string_view element) {
  const std::string_view text = Stripped(probe.head);
  return text.starts_with(element) || (text.starts_with("<?xml") && Has(text, element));
}
bool IsGpx(const Probe& probe) { return IsXmlOf(probe, "<gpx"); }
bool IsKml(const Probe& probe) { return IsXmlOf(probe, "<kml"); }

// What a report or another text of slamdb says that it is: `slamdb-check-2`.
std::string_view ReportName(std::string_view head) {
  const std::string_view text = Stripped(head);
  constexpr std::string_view kKey = "\"report\":";
  const std::size_t key = text.substr(0, 200).find(kKey);
  if (!text.starts_with('{') || key == std::string_view::npos) return {};
  std::string_view value = text.substr(key + kKey.size());
  value.remove_prefix(std::min(value.find_first_not_of(" \""), value.size()));
  value = value.substr(0, value.find('"'));
  return value.starts_with("slamdb-") ? value : ""sv;
}

bool IsBase64OfAtlas(const Probe& probe) {
  const std::string_view text = Stripped(probe.head);
  return text.starts_with("FgAAAAAAAABzZXJpYWxpemF0aW9u") || text.starts_with("FgAAAHNlcmlhbGl6YXRpb246") ||
         text.starts_with("U1FMaXRlIGZvcm1hdCAz");
}

// As xxd, hexdump, od and plain hexadecimal digits show the first bytes of an archive or an SQLite file.
bool IsHexDump(const Probe& probe) {
  std::string digits;
  std::string_view text = Stripped(probe.head).substr(0, 200);
  std::string_view line = TakeLine(text);
  const std::string_view first = line.substr(0, line.find(' '));
  const bool offset = first.find_first_not_of("0:") == std::string_view::npos && first.size() >= 6;
  if (offset) line.remove_prefix(first.size());
  for (const char c : line) {
    if (std::isxdigit(static_cast<unsigned char>(c)))
      digits += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    else if (c != ' ')
      break;
  }
  for (const std::string_view start : {"1600000000000000736572"sv, "00160000000000006573"sv, "16000000736572"sv,
                                       "53514c69746520"sv, "515369746c206566"sv})
    if (digits.starts_with(start)) return true;
  return false;
}

// ---- databases

// SQLite keeps the text of its CREATE TABLE statements in the first page, and in further ones when there are many.
std::string SqliteText(const Probe& probe) {
  constexpr std::size_t kEnough = std::size_t{1} << 20;
  if (probe.memory || IsStream(probe.path)) {
    const Bytes bytes = probe.memory.value_or(std::as_bytes(std::span(probe.head)));
    const Bytes first = bytes.first(std::min(bytes.size(), kEnough));
    return {reinterpret_cast<const char*>(first.data()), first.size()};
  }
  OpenedInput input(probe.path);
  std::string text(std::min<std::size_t>(kEnough, input.size()), '\0');
  text.resize(input.Read(text.data(), text.size()));
  return text;
}

constexpr std::string_view kConvert = "it is a map, which can be converted";
constexpr std::string_view kRecording = "run a SLAM system on it and give the atlas that it saves";

Recognized RecognizeSqlite(const Probe& probe) {
  const auto is = [](std::string_view id, std::string_view what, std::string_view next) {
    return Recognized{id, ErrorKind::kUnsupported, std::string(what), std::string(next)};
  };
  if (HasAt(probe.head, 68, "SLDB")) return is("store", "a slamdb store", "name the atlas in it as STORE.db#NAME");
  const std::string text = SqliteText(probe);
  const auto table = [&text](std::string_view name) {
    for (const std::string_view before : {"TABLE "sv, "TABLE IF NOT EXISTS "sv, "TABLE \""sv, "TABLE `"sv, "TABLE ["sv})
      if (Has(text, std::string(before) + std::string(name))) return true;
    return false;
  };
  if (Has(text, "keypoints") && (Has(text, "two_view_geometries") || Has(text, "inlier_matches")))
    return is("colmap-database", "a COLMAP database (features and matches, no map)",
              "the model that was made of it has the map: give its folder");
  if (table("Node") && table("Link") && table("Admin")) return is("rtabmap", "an RTAB-Map database", kConvert);
  if (Has(text, "associations") && (Has(text, "undist_keypts") || (table("keyframes") && table("landmarks"))))
    return is("stella-sqlite", "a stella_vslam map database", kConvert);
  if (Has(text, "serialized_data") || (table("topics") && table("messages")))
    return is("rosbag2", "a ROS 2 bag, the recording a map is made from", kRecording);
  return is("sqlite", "an SQLite database, but not a slamdb store", "");
}

// ---- the table

// A file that begins with `signature` at `offset`, or that `is` knows, and what to say of it.
struct Known {
  std::string_view id;
  std::size_t offset;
  std::string_view signature;
  std::string_view what;
  std::string_view next = "";
  bool (*is)(const Probe&) = nullptr;
};

constexpr std::string_view kWholeModel = "give the folder that it is in";
constexpr std::string_view kCloud = "writing it as csv makes a table of its points";
constexpr std::string_view kUnpack = "unpack it and give the file in it";
constexpr std::string_view kConvertTrack =
    "make a table of time, latitude, longitude and altitude of it (gpsbabel -o unicsv)";
constexpr std::string_view kSavedInstead = "was it saved in place of the file that was to be downloaded?";

bool IsCameraSettings(const Probe& probe) { return probe.head.starts_with("%YAML"); }
bool IsOsmapHeader(const Probe& probe) { return IsCameraSettings(probe) && Has(probe.head, "mappointsFile"); }
bool IsVocabularyYaml(const Probe& probe) {
  return IsCameraSettings(probe) && Has(probe.head, "vocabulary:") && Has(probe.head, "scoringType");
}
bool IsRosParameters(const Probe& probe) { return StartsWithIgnoringCase(Stripped(probe.head), "rosbag2_bagfile"); }
bool IsGitAnnex(const Probe& probe) {
  return probe.size < 1024 && Has(probe.head, "annex/objects/") && (probe.head[0] == '/' || probe.head[0] == '.');
}
bool IsDvc(const Probe& probe) {
  return probe.size < 4096 && probe.head.starts_with("outs:") && Has(probe.head, "path:");
}
bool IsMp4(const Probe& probe) { return HasAt(probe.head, 4, "ftyp"); }
bool IsStella(const Probe& probe) {
  // A MessagePack map whose first key, in byte order, is `cameras`.
  const auto first = probe.head.empty() ? 0U : static_cast<unsigned char>(probe.head[0]);
  const std::size_t key = first >= 0x80 && first <= 0x8f ? 1 : first == 0xde ? 3 : 0;
  return key > 0 && HasAt(probe.head, key,
                          "\xa7"
                          "cameras"sv);
}
bool IsArchive(const Probe& probe) { return Has(std::string_view(probe.head).substr(0, 64), "serialization::archive"); }
bool IsNerf(const Probe& probe) {
  return Stripped(probe.head).starts_with('{') && Has(probe.head, "\"transform_matrix\"");
}
bool IsSarif(const Probe& probe) {
  return Stripped(probe.head).starts_with('{') && Has(std::string_view(probe.head).substr(0, 500), "sarif");
}
bool IsErrorReply(const Probe& probe) {
  const std::string_view text = Stripped(probe.head);
  return probe.size < 4096 &&
         ((text.starts_with('{') && (Has(text, "\"message\"") || Has(text, "\"error\""))) || Has(text, "<Error>"));
}

// In the order in which they are asked.
constexpr Known kKnown[] = {
    {"gzip", 0, "\x1f\x8b"sv, "gzip-compressed", "unpack it first (gunzip; of a .tar.gz: tar -xzf)"},
    {"xz", 0, "\xfd\x37zXZ\x00"sv, "xz-compressed", "unpack it first (unxz)"},
    {"zstd", 0, "\x28\xb5\x2f\xfd"sv, "zstd-compressed", "unpack it first (unzstd)"},
    {"bzip2", 0, "BZh"sv, "bzip2-compressed", "unpack it first (bunzip2)"},
    {"lz4", 0, "\x04\x22\x4d\x18"sv, "lz4-compressed", "unpack it first (unlz4)"},
    {"compress", 0, "\x1f\x9d"sv, "compressed (.Z)", "unpack it first (uncompress)"},
    {"zip", 0, "PK\x03\x04"sv, "a zip archive", kUnpack},
    {"zip", 0, "PK\x05\x06"sv, "a zip archive with nothing in it"},
    {"7z", 0, "7z\xbc\xaf\x27\x1c"sv, "a 7z archive", kUnpack},
    {"rar", 0, "Rar!\x1a\x07"sv, "a rar archive", kUnpack},
    {"tar", 257, "ustar"sv, "a tar archive", kUnpack},
    {"ar", 0, "!<arch>\n"sv, "an ar archive (a static library, or a Debian package)"},
    {"png", 0, "\x89PNG\r\n\x1a\n"sv, "a PNG image"},
    {"jpeg", 0, "\xff\xd8\xff"sv, "a JPEG image"},
    {"gif", 0, "GIF8"sv, "a GIF image"},
    {"webp", 8, "WEBP"sv, "a WebP image"},
    {"avi", 8, "AVI "sv, "an AVI video, which a map may be made from", kRecording},
    {"tiff", 0, "II*\0"sv, "a TIFF image"},
    {"tiff", 0, "MM\0*"sv, "a TIFF image"},
    {"pnm", 0, "P5\n"sv, "a PGM image, such as the occupancy grid of a robot"},
    {"pnm", 0, "P6\n"sv, "a PPM image"},
    {"mp4", 0, "", "an MP4 video, which a map may be made from", kRecording, IsMp4},
    {"matroska", 0, "\x1a\x45\xdf\xa3"sv, "a Matroska or WebM video, which a map may be made from", kRecording},
    {"pdf", 0, "%PDF-"sv, "a PDF document"},
    {"elf", 0,
     "\x7f"
     "ELF"sv,
     "a program or library (ELF)"},
    {"script", 0, "#!"sv, "a script"},
    {"rosbag", 0, "#ROSBAG V"sv, "a ROS bag, the recording a map is made from", kRecording},
    {"mcap", 0, "\x89MCAP"sv, "an MCAP recording (ROS 2), which a map is made from", kRecording},
    {"rosbag2", 0, "", "the metadata of a ROS 2 bag, the recording a map is made from", kRecording, IsRosParameters},
    {"hdf5", 0, "\x89HDF\r\n\x1a\n"sv, "an HDF5 file"},
    {"numpy", 0, "\x93NUMPY"sv, "an array of NumPy"},
    {"las", 0, "LASF"sv, "a LAS point cloud"},
    {"e57", 0, "ASTM-E57"sv, "an E57 point cloud"},
    {"gltf", 0, "glTF"sv, "a glTF scene"},
    {"pgp", 0, "-----BEGIN PGP"sv, "encrypted or signed by PGP", "decrypt it first"},
    {"openssl", 0, "Salted__"sv, "encrypted by OpenSSL", "decrypt it first"},
    {"git-lfs", 0, "version https://git-lfs.github.com/spec/"sv, "a Git LFS pointer that stands for the file",
     "fetch the file itself (git lfs pull)"},
    {"git-annex", 0, "", "a pointer of git-annex that stands for the file", "fetch the file itself (git annex get)",
     IsGitAnnex},
    {"dvc", 0, "", "a pointer of DVC that stands for the file", "fetch the file itself (dvc pull)", IsDvc},
    {"web-page", 0, "", "a web page", kSavedInstead, IsWebPage},
    {"http", 0, "HTTP/"sv, "the answer of a web server, with its header", kSavedInstead},
    {"nerf", 0, "", "a scene for NeRFs, which slamdb writes but does not read",
     "give the map or the COLMAP model that it was made of", IsNerf},
    {"sarif", 0, "", "a SARIF report", "give the file that it tells of", IsSarif},
    {"error-reply", 0, "", "the error message of a server", kSavedInstead, IsErrorReply},
    {"gpx", 0, "", "a GPX track", kConvertTrack, IsGpx},
    {"kml", 0, "", "a KML track", kConvertTrack, IsKml},
    {"junit", 0, "<?xml"sv, "an XML file", "ORB-SLAM3 saves binary or text archives"},
    {"orbslam2", 0, "", "a map of ORB-SLAM2 (a Boost archive without a header)", kConvert, IsOrbslam2Map},
    {"stella", 0, "", "a stella_vslam map (MessagePack)", kConvert, IsStella},
    {"fbow", 0, "\xfc\xce\x53\x03\0\0\0\0"sv, "an FBoW vocabulary, whose words are numbered otherwise than DBoW2's"},
    {"dbow3", 0, "\x81\x3f\x86\xb1\x14\0\0\0"sv, "a DBoW3 vocabulary, which ORB-SLAM3 does not read"},
    {"vocabulary", 0, "", "a DBoW2 vocabulary as ORB-SLAM3 uses it", "ReadVocabularyFile tells its name and MD5",
     IsVocabulary},
    {"binary-vocabulary", 0, "", "a DBoW2 vocabulary in its binary form", "ReadVocabularyFile tells its name and MD5",
     IsBinaryVocabulary},
    {"vocabulary-yaml", 0, "", "a DBoW2 vocabulary as YAML, which ORB-SLAM3 does not read", "save it as text",
     IsVocabularyYaml},
    {"osmap", 0, "", "the header of an osmap map (ORB-SLAM2)", "", IsOsmapHeader},
    {"yaml", 0, "", "a YAML file of OpenCV, such as the settings of ORB-SLAM3",
     "the atlas is the .osa file that System.SaveAtlasToFile names in it", IsCameraSettings},
    {"colmap-points", 0, "# 3D point list with one line of data per point"sv, "points3D.txt of a COLMAP model",
     kWholeModel},
    {"colmap-rigs", 0, "# Rig calib list with one line"sv, "rigs.txt of a COLMAP model", kWholeModel},
    {"colmap-frames", 0, "# Frame list with one line"sv, "frames.txt of a COLMAP model", kWholeModel},
    {"colmap-cameras", 0, "", "cameras.txt of a COLMAP model", kWholeModel, IsColmapCamerasText},
    {"colmap-images", 0, "", "images.txt of a COLMAP model", kWholeModel, IsColmapImagesText},
    {"colmap-cameras", 0, "", "cameras.bin of a COLMAP model", kWholeModel, IsColmapCameras},
    {"colmap-images", 0, "", "images.bin of a COLMAP model", kWholeModel, IsColmapImages},
    {"colmap-frames", 0, "", "frames.bin of a COLMAP model", kWholeModel, IsColmapFrames},
    {"colmap-points", 0, "", "points3D.bin of a COLMAP model", kWholeModel, IsColmapPoints},
    {"ply", 0, "ply\n"sv, "a PLY point cloud", kCloud},
    {"ply", 0, "ply\r\n"sv, "a PLY point cloud", kCloud},
    {"pcd", 0, "# .PCD"sv, "a PCD point cloud", kCloud},
    {"dump", 0, "{\"type\":\"atlas\""sv, "a dump of slamdb (JSON lines)", "give the atlas that it was made from"},
    {"base64", 0, "", "an atlas or a store in base64", "decode it first (base64 -d)", IsBase64OfAtlas},
    {"uuencode", 0, "begin 644 "sv, "uuencoded", "decode it first (uudecode)"},
    {"hex-dump", 0, "", "an atlas or a store as hexadecimal digits", "decode it first (xxd -r)", IsHexDump},
};

Recognized Make(const Known& known) {
  return {known.id, ErrorKind::kUnsupported, std::string(known.what), std::string(known.next)};
}

std::optional<Recognized> RecognizeReport(std::string_view head) {
  const std::string_view report = ReportName(head);
  if (report.empty()) return std::nullopt;
  if (report.starts_with("slamdb-journal-"))
    return Recognized{"journal", ErrorKind::kUnsupported,
                      "a journal of `RepairAtlas`, which takes back what it changed", "give the atlas"};
  return Recognized{"report", ErrorKind::kUnsupported, Concat("a report of slamdb (", report, ")"),
                    "give the atlas that it tells of"};
}

}  // namespace

bool IsSqlite(std::string_view head) { return head.starts_with("SQLite format 3\0"sv); }

std::optional<Recognized> Recognize(const Probe& probe) {
  const std::string_view head = probe.head;
  if (probe.size == 0) return Recognized{"empty", ErrorKind::kDamaged, "", ""};
  if (const std::size_t zeros = CountZeros(head); zeros == head.size() || zeros >= kZeroPage)
    return Recognized{"zeros", ErrorKind::kDamaged, Concat(zeros, " zero bytes"), ""};
  if (IsSqlite(head)) return RecognizeSqlite(probe);
  if (auto report = RecognizeReport(head)) return report;
  for (const Known& known : kKnown)
    if (known.is != nullptr ? known.is(probe) : HasAt(head, known.offset, known.signature)) return Make(known);
  if (const std::string_view part = OsmapPart(probe); !part.empty())
    return Recognized{"osmap", ErrorKind::kUnsupported, Concat("the ", part, " of an osmap map (ORB-SLAM2)"),
                      "give its .yaml file"};
  if (auto mrpt = RecognizeMrpt(head)) return mrpt;
  if (IsArchive(probe))
    return Recognized{"archive", ErrorKind::kUnsupported, "an atlas of ORB-SLAM3, or another archive of Boost", ""};
  if (IsUtf16(head)) return Recognized{"utf-16", ErrorKind::kUnsupported, "text in UTF-16", "save it as UTF-8"};
  return std::nullopt;
}

Recognized RecognizedAs(std::string_view id) { return Make(*std::ranges::find(kKnown, id, &Known::id)); }

std::string SentenceOf(const Recognized& recognized, std::string_view wanted) {
  if (recognized.id == "empty") return "is empty; was the program that saved it stopped before it could?";
  if (recognized.id == "zeros")
    return Concat("begins with ", recognized.what, " and holds no ", wanted.substr(wanted.find(' ') + 1),
                  " there; was the disk full or the power cut while it was saved?", recognized.next);
  return Concat("not ", wanted, ": this is ", recognized.what, recognized.next.empty() ? "" : "; ", recognized.next);
}

void RefuseOther(const Probe& probe, std::string_view wanted, std::initializer_list<std::string_view> takes) {
  const auto recognized = Recognize(probe);
  if (!recognized || std::find(takes.begin(), takes.end(), recognized->id) != takes.end()) return;
  throw Error(recognized->kind, probe.path, "", SentenceOf(*recognized, wanted));
}

void RefuseReplacingMap(const std::string& path) {
  std::error_code missing;
  if (!std::filesystem::is_regular_file(path, missing)) return;
  const bool is_database = IsDatabase(path);
  const auto there = is_database ? std::nullopt : Recognize(Probe::Of(path));
  if (is_database || (there && there->id == "archive"))
    throw Error(ErrorKind::kAlreadyExists, path, "",
                Concat("is ", is_database ? "an SQLite database" : there->what,
                       ", which nothing replaces that is written along with another file; name another output, or "
                       "remove it first"));
}

}  // namespace slamdb::detail
