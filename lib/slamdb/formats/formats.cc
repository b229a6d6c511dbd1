// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/formats.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/opened_input.h"
#include "slamdb/base/detail/server.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/colmap/detail/colmap.h"
#include "slamdb/formats/csv/detail/csv.h"
#include "slamdb/formats/detail/choose.h"
#include "slamdb/formats/detail/recognize.h"
#include "slamdb/formats/g2o/detail/g2o.h"
#include "slamdb/formats/geographic/detail/geographic.h"
#include "slamdb/formats/gltf/detail/gltf.h"
#include "slamdb/formats/las/detail/las.h"
#include "slamdb/formats/mcap/detail/mcap.h"
#include "slamdb/formats/mrpt/detail/mrpt.h"
#include "slamdb/formats/ndjson/detail/ndjson.h"
#include "slamdb/formats/orbslam2/detail/orbslam2.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/formats/osmap/detail/osmap.h"
#include "slamdb/formats/pcd/detail/pcd.h"
#include "slamdb/formats/ply/detail/ply.h"
#include "slamdb/formats/rtabmap/detail/rtabmap.h"
#include "slamdb/formats/splats/detail/splats.h"
#include "slamdb/formats/stella/detail/stella.h"
#include "slamdb/formats/store/detail/store_format.h"
#include "slamdb/formats/trajectory/detail/trajectory.h"
#include "slamdb/formats/vins/detail/vins.h"
#include "slamdb/formats/xyz/detail/xyz.h"

namespace slamdb {

// In the order in which sniffers are asked: formats with a signature before those that are only lines of numbers.
std::span<const Format> Formats() {
  static const std::array kFormats = {
      kOrbslam3Format,
      kOrbslam3TextFormat,
      detail::kOrbslam2Format,
      detail::kOsmapFormat,
      detail::kStoreFormat,
      detail::kStellaFormat,
      detail::kStellaDatabaseFormat,
      detail::kRtabmapFormat,
      detail::kRtabmapTruthFormat,
      detail::kColmapFormat,
      detail::kColmapTextFormat,
      detail::kColmapDatabaseFormat,
      detail::kG2oFormat,
      detail::kVinsFormat,
      detail::kMrptFormat,
      detail::kMrpt3Format,
      detail::kMrptTextFormat,
      detail::kPlyFormat,
      detail::kPcdFormat,
      detail::kLasFormat,
      detail::kGltfFormat,
      detail::kMcapFormat,
      detail::kKmlFormat,
      detail::kGeojsonFormat,
      detail::kNerfFormat,
      detail::kGaussianFormat,
      detail::kNdjsonFormat,
      detail::kCsvFormat,
      detail::kCsvKeyFramesFormat,
      detail::kCsvObservationsFormat,
      detail::kEurocFormat,
      detail::kTumFormat,
      detail::kKittiFormat,
      detail::kXyzFormat,
  };
  return kFormats;
}

namespace {

using detail::Concat;
using detail::FormatBySuffix;

std::string Lower(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

bool CanRead(const Format& format) { return format.read != nullptr; }
bool CanWrite(const Format& format) { return format.write != nullptr; }

// `orbslam3, store, tum` of those that can.
std::string Ids(bool (*has)(const Format&)) {
  std::string list;
  for (const Format& format : Formats())
    if (has(format)) list.append(list.empty() ? "" : ", ").append(format.id);
  return list;
}

// Suffixes that people try, and the nearest that a format has. One that misleads is that of another format, by which
// programs would take the file for what it is not.
struct KindredSuffix {
  std::string_view tried, nearest;
  bool misleads = false;
};
constexpr KindredSuffix kKindred[] = {
    {".gltf", ".glb", true}, {".kmz", ".kml", true}, {".obj", ".ply", true}, {".stl", ".ply", true},
    {".bag", ".mcap", true}, {".db3", ".mcap"},      {".json", ".ndjson"},   {".tsv", ".csv"},
    {".gz", ".mrpt.gz"},     {".bin", ".osa"},       {".laz", ".las", true}, {".asc", ".xyz"},
    {".pts", ".xyz"},
};

// The format that is probably meant by a name that has the suffix of none; empty: any.
std::string_view FormatMeant(const std::string& path) {
  const std::filesystem::path name(path);
  const std::string file = Lower(name.filename().string());
  if (!name.has_extension()) return "colmap";  // a folder
  if (file == "transforms.json") return "nerf";
  return file == "map.bin" || file.ends_with(".osmap") ? "osmap" : "";
}

// `transforms.json` is in a folder that is to be named.
bool IsFileOfFolder(std::string_view format, const std::string& path) {
  return FormatById(format).is_folder && std::filesystem::path(path).has_extension();
}

const KindredSuffix* FindKindred(const std::string& path) {
  const auto kindred =
      std::ranges::find(kKindred, Lower(std::filesystem::path(path).extension().string()), &KindredSuffix::tried);
  return kindred == std::end(kKindred) ? nullptr : kindred;
}

// `slamdb convert a.osa b.gltf --to gltf`: other programs would not read it by that name.
void RefuseMisleadingSuffix(const Format& format, const Target& target) {
  const KindredSuffix* kindred =
      target.is_file() && !detail::IsServer(target.path) ? FindKindred(target.path) : nullptr;
  if (kindred == nullptr || !kindred->misleads) return;
  const std::string named = std::filesystem::path(target.path)
                                .replace_extension(format.suffixes.empty() ? kindred->nearest : format.suffixes.front())
                                .string();
  throw Error(ErrorKind::kUsage, target.path, "",
              Concat("a ", kindred->tried, " is something else than a ", format.title, "; name it ", named));
}

// `slamdb convert a.osa transforms.json --to nerf` would make a folder that other programs take for a file.
void RefuseFileName(const Format& format, const Target& target) {
  std::error_code missing;
  if (!format.is_folder || !target.is_file() || std::filesystem::is_directory(target.path, missing)) return;
  const auto is_file = [](const Format& known) { return CanWrite(known) && !known.is_folder; };
  if (detail::FormatBySuffix(target.path, is_file) == nullptr && FindKindred(target.path) == nullptr) return;
  throw Error(ErrorKind::kUsage, target.path, "",
              Concat("has the suffix of a file, and a ", format.title, " is a folder of files; name it ",
                     std::filesystem::path(target.path).replace_extension().string()));
}

void RequireReadable(const Format& format, const std::string& path) {
  if (CanRead(format)) return;
  throw Error(ErrorKind::kUnsupported, path, "",
              Concat("is a ", format.title,
                     ", which slamdb writes but does not read, since it holds only a part of an atlas; give the file "
                     "it was made from (readable: ",
                     Ids(CanRead), ")"));
}

// A trajectory has no points, and landmarks no keyframes.
void RequireContent(const Format& format, Content needs, const std::string& path) {
  if (needs == Content::kNothing || HasAny(format.reads, needs)) return;
  throw Error(ErrorKind::kUnsupported, path, "",
              Concat("is a ", format.title, "; an atlas is needed, such as the .osa file that ORB-SLAM3 saved"));
}

void RequireWritable(const Format& format, const std::string& path) {
  if (CanWrite(format)) return;
  throw Error(ErrorKind::kUsage, path, "",
              Concat("format `", format.id, "` can only be read; writable are ", Ids(CanWrite)));
}

// Where one stream of bytes is not enough.
void RequirePath(const Format& format, const std::string& path, bool is_path) {
  if (is_path || !(format.is_folder || format.needs_path)) return;
  throw Error(ErrorKind::kUsage, path, "",
              Concat("is one stream of bytes, and a ", format.title,
                     format.is_folder ? " is a folder of files" : " is no stream", "; give a path"));
}

// `file#name` is for stores.
void RequirePlain(const Format& format, const std::string& path, const std::string& name) {
  if (name.empty() || format.named) return;
  throw Error(
      ErrorKind::kUsage, path, "",
      Concat("`#", name, "` names one atlas of a store, but ", format.title,
             " files hold one atlas without a name; a `#` in the name of a file needs the file's suffix behind it"));
}

// A format of folders may be told by its main file, too.
bool Sniffs(const Format& format, const Probe& probe) {
  return format.sniff != nullptr && (format.is_folder || !probe.is_directory) && format.sniff(probe);
}

// What a file is: of a format, or something else that is known, or neither.
struct Detected {
  const Format* format = nullptr;
  std::optional<detail::ForeignFile> foreign;
};

Detected Detect(const Probe& probe) {
  for (const Format& format : Formats())
    if (Sniffs(format, probe)) return {.format = &format};
  if (auto foreign = detail::RecognizeOther(probe)) return {.foreign = std::move(foreign)};
  return {.format = FormatBySuffix(probe.path, CanRead)};
}

[[noreturn]] void RefuseForeign(const detail::ForeignFile& foreign, const std::string& path) {
  throw Error(foreign.kind, path, "", foreign.sentence);
}

const Format& DetectFormat(const Probe& probe) {
  const Detected detected = Detect(probe);
  if (detected.format != nullptr) return *detected.format;
  if (detected.foreign) RefuseForeign(*detected.foreign, probe.path);
  throw Error(ErrorKind::kDamaged, probe.path, "", detail::DescribeUnknown(probe));
}

// A format that was asked for is not what the file has where the file is known to be something else; what reads it may
// go by several names, as of text and binary archives. One that is only asked for, without a signature and a suffix, is
// another view of files that are known.
void RefuseOther(const Format& format, const Probe& probe) {
  if (format.sniff == nullptr && format.suffixes.empty()) return;
  for (const Format& known : Formats())
    if (known.read == format.read && Sniffs(known, probe)) return;
  if (const auto foreign = detail::RecognizeOther(probe)) RefuseForeign(*foreign, probe.path);
}

// A database of a server is a store, without a look at it; `asked`: the format that it is said to have, or empty.
const Format& FormatOfServer(const std::string& path, const std::string& asked) {
  const Format& format = FormatById(asked.empty() ? "store" : asked);
  if (format.named) return format;
  throw Error(ErrorKind::kUsage, path, "", Concat("is a database of a server, which is a store and no ", format.title));
}

// By the options, or by content, then by suffix.
const Format& FormatOf(const Probe& probe, const ReadOptions& options) {
  if (options.format.empty()) return DetectFormat(probe);
  const Format& format = FormatById(options.format);
  if (CanRead(format)) RefuseOther(format, probe);
  return format;
}

const Format& FormatOf(const Source& source, const ReadOptions& options) {
  if (source.is_file() && detail::IsServer(source.path)) return FormatOfServer(source.path, options.format);
  return FormatOf(Probe::Of(source), options);
}

const Format* FindReadable(const Source& source) {
  if (source.is_file() && detail::IsServer(source.path)) return &FormatOfServer(source.path, {});
  const Format* format = Detect(Probe::Of(source)).format;
  return format != nullptr && CanRead(*format) ? format : nullptr;
}

// `maps.db#a/b` and `maps.db#a#b` look like the name of an atlas that none can have.
void RefuseImpossibleName(const std::string& path) {
  const std::size_t hash = path.find('#');
  if (hash == std::string::npos) return;
  const Format* format = FormatBySuffix(path.substr(0, hash), CanWrite);
  if (format == nullptr || !format->named) return;
  throw Error(ErrorKind::kUsage, path, "",
              Concat("names no atlas of ", path.substr(0, hash), ": the name of an atlas holds no `#` and no `/`"));
}

const Format& FormatOfSuffix(const Target& target) {
  if (!target.is_file())
    throw Error(ErrorKind::kUsage, target.path, "",
                Concat(target.sink ? "" : "standard output ",
                       "has no suffix to tell the format by; WriteOptions::format names it (", Ids(CanWrite), ")"));
  if (const Format* format = FormatBySuffix(target.path, CanWrite)) return *format;
  RefuseImpossibleName(target.path);
  if (const std::string_view meant = FormatMeant(target.path); !meant.empty() && target.name.empty())
    throw Error(
        ErrorKind::kUsage, target.path, "",
        Concat("its suffix tells no format; perhaps ", IsFileOfFolder(meant, target.path) ? "a folder with " : "",
               "WriteOptions::format ", meant, " is meant; `Formats` lists all"));
  const KindredSuffix* kindred = FindKindred(target.path);
  throw Error(ErrorKind::kUsage, target.path, "",
              Concat(target.name.empty() ? "" : "`#" + target.name + "` names an atlas of a store of this name, but ",
                     "its suffix tells no format; ",
                     kindred == nullptr ? "others do, such as .osa, .db, .ply, .tum, .csv"
                                        : Concat("the nearest is ", kindred->nearest),
                     "; `Formats` lists all, and WriteOptions::format names one"));
}

}  // namespace

const Format* detail::FormatBySuffix(std::string_view path, bool (*has)(const Format&)) {
  const std::string lower = Lower(path);
  const Format* best = nullptr;
  std::size_t longest = 0;
  for (const Format& format : Formats()) {
    if (!has(format)) continue;
    for (const std::string_view suffix : format.suffixes) {
      if (suffix.size() <= longest || !lower.ends_with(suffix)) continue;
      best = &format;
      longest = suffix.size();
    }
  }
  return best;
}

HeldSource detail::Hold(const Source& source, const ReadOptions& options) {
  if (source.is_file()) RefuseMistypedServer(source.path);
  if (options.custom_format != nullptr) return HeldSource(source);
  return HeldSource(source, [&options](const Probe& beginning) { FormatOf(beginning, options); });
}

const Format& detail::FormatToRead(const Source& source, const ReadOptions& options) {
  const Format& format = options.custom_format != nullptr ? *options.custom_format : FormatOf(source, options);
  if (!options.format.empty() && !CanRead(format))
    throw Error(ErrorKind::kUsage, source.path, "",
                Concat("format `", format.id, "` can only be written; readable are ", Ids(CanRead)));
  RequireReadable(format, source.path);
  RequirePath(format, source.path, source.is_file());
  RequireContent(format, options.needs, source.path);
  RequirePlain(format, source.path, source.name);
  return format;
}

const Format& detail::FormatToWrite(const Target& target, const WriteOptions& options) {
  const bool is_server = target.is_file() && IsServer(target.path);
  const Format* format = options.custom_format;
  if (target.is_file()) RefuseMistypedServer(target.path);
  if (format == nullptr && is_server) format = &FormatOfServer(target.path, options.format);
  if (format == nullptr) format = options.format.empty() ? &FormatOfSuffix(target) : &FormatById(options.format);
  RequireWritable(*format, target.path);
  RequirePath(*format, target.path, target.is_file());
  RequirePlain(*format, target.path, target.name);
  if (options.custom_format == nullptr) RefuseMisleadingSuffix(*format, target);
  RefuseFileName(*format, target);
  return *format;
}

const Format& FormatById(std::string_view id) {
  const auto formats = Formats();
  const auto found =
      std::find_if(formats.begin(), formats.end(), [id](const Format& format) { return format.id == id; });
  if (found == formats.end())
    throw Error(ErrorKind::kUsage,
                Concat("unknown format `", id, "`; known are ", Ids([](const Format&) { return true; })));
  return *found;
}

const Format& FormatOfInput(const Location& location, std::string_view id) {
  const ReadOptions options{.format = std::string(id)};
  return detail::FormatToRead(detail::Hold({location.path, location.name}, options).source(), options);
}

const Format* FindFormatOfInput(const Location& location) {
  return detail::IsStream(location.path) ? nullptr : FindReadable(Source(location.path));
}

const Format* FindFormatOfInput(const HeldSource& held) { return FindReadable(held.source()); }

// A server holds nothing else. What is there tells by its content; what is not yet, by its suffix, which stores share
// with databases of others.
bool HoldsNamedAtlases(const std::string& path) {
  if (detail::IsServer(path)) return true;
  const bool by_suffix = FormatBySuffix(path, [](const Format& format) { return format.named; }) != nullptr;
  std::error_code missing;
  if (!std::filesystem::is_regular_file(path, missing)) return by_suffix;
  try {
    const Probe probe = Probe::Of(path);
    for (const Format& format : Formats())
      if (format.sniff != nullptr && format.sniff(probe)) return format.named;
  } catch (const Error&) {
    return by_suffix;  // whoever reads it will say why it cannot be read
  }
  return by_suffix;
}

const Format& FormatOfOutput(const Location& location, std::string_view id) {
  return detail::FormatToWrite({location.path, location.name}, {.format = std::string(id)});
}

}  // namespace slamdb
