// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "slamdb/base/error.h"
#include "slamdb/base/file.h"
#include "slamdb/base/notices.h"
#include "slamdb/base/progress.h"
#include "slamdb/export.h"
#include "slamdb/formats/format_options.h"
#include "slamdb/formats/location.h"
#include "slamdb/model/atlas.h"

namespace slamdb {

struct Format;
struct Salvage;

// What a format can hold, or an atlas has: a set, combined with | & ~.
enum class Content : std::uint32_t {
  kNothing = 0,
  kPoses = 1U << 0,         // keyframe poses with timestamps
  kPoints = 1U << 1,        // map point positions
  kNormals = 1U << 2,       // normals and distance ranges of points
  kObservations = 1U << 3,  // which keyframe sees which point
  kKeypoints = 1U << 4,
  kDescriptors = 1U << 5,
  kBagOfWords = 1U << 6,
  kGraph = 1U << 7,  // covisibility, spanning tree, loop and merge edges
  kInertial = 1U << 8,
  kCameras = 1U << 9,
  kMaps = 1U << 10,         // several maps in one file
  kIdentity = 1U << 11,     // ids, counters, vocabulary, flags
  kAtlas = (1U << 12) - 1,  // all of the above: what an .osa file holds
  kLandmarks = 1U << 12,    // MRPT's, with their covariances
  kTracking = 1U << 13,     // of points: origin maps, visible and found counts
  kCarried = 1U << 14,      // members of a fork's classes
  kEverything = kAtlas | kLandmarks | kTracking | kCarried,
};
constexpr Content operator|(Content a, Content b) {
  return static_cast<Content>(static_cast<std::uint32_t>(a) | static_cast<std::uint32_t>(b));
}
constexpr Content operator&(Content a, Content b) {
  return static_cast<Content>(static_cast<std::uint32_t>(a) & static_cast<std::uint32_t>(b));
}
// Everything else.
constexpr Content operator~(Content a) {
  return static_cast<Content>(~static_cast<std::uint32_t>(a) & static_cast<std::uint32_t>(Content::kEverything));
}
constexpr Content& operator|=(Content& a, Content b) { return a = a | b; }
constexpr Content& operator&=(Content& a, Content b) { return a = a & b; }
// Whether `content` holds some of `parts`, or all of them.
constexpr bool HasAny(Content content, Content parts) { return (content & parts) != Content::kNothing; }
constexpr bool HasAll(Content content, Content parts) { return (content & parts) == parts; }

// Which part of an atlas to read. Default: all.
// Keyframes outside the ranges are left out, and so are points outside the box.
// References to what was left out stay as they are: a partial atlas is for looking at, not for saving as whole.
struct SLAMDB_EXPORT Selection {
  std::optional<MapId> map;
  std::uint64_t first_keyframe = 0, last_keyframe = std::numeric_limits<std::uint64_t>::max();  // ids, inclusive
  double begin_time = -std::numeric_limits<double>::infinity();                                 // seconds, inclusive
  double end_time = std::numeric_limits<double>::infinity();
  std::optional<Eigen::AlignedBox3f> box;  // points, world coordinates

  bool everything() const;
  bool has_keyframe_range() const;  // by ids or times
  bool Has(const KeyFrame& keyframe) const;
  bool Has(const MapPoint& point) const;
};

// How many bytes of a file each kind of data takes, e.g. {"descriptors", 1234}.
struct PartSize {
  std::string part;
  std::uint64_t bytes = 0;
};

// Which columns of the features to read.
// A reader may read more than was asked for.
enum class FeatureColumns {
  kAll,
  kGeometry,  // keypoints, stereo and depth, matches; no descriptors, grids and bags of words: for statistics
  kNone,
};

struct ReadOptions : WithFormatOptions<ReadOptions> {
  std::string format;                     // id of one of Formats(); empty: told by the content, then by the suffix
  const Format* custom_format = nullptr;  // one of your own instead
  Content needs = Content::kNothing;      // Error when the format of the input can hold nothing of this; none: never
  FeatureColumns features = FeatureColumns::kAll;
  Selection selection;
  std::vector<PartSize>* part_sizes = nullptr;  // filled where the format can tell
  int threads = 0;                              // 0: every core
  Progress progress;                            // may be empty
};

struct WriteOptions : WithFormatOptions<WriteOptions> {
  std::string format;                     // id of one of Formats(); empty: told by the suffix
  const Format* custom_format = nullptr;  // one of your own instead
  bool strict = false;                    // Error, and nothing written, where the target cannot hold all of the atlas,
                                          // exports of points and poses too
  bool overwrite = false;                 // replace what is there; otherwise Error
  bool sync = true;  // wait for the disk; false is faster and safe against everything but power loss
  // Called when all is written, right before it appears under its name; see AtomicFileOptions. May be empty.
  std::function<void()> before_commit;
  int threads = 0;    // 0: every core
  Progress progress;  // may be empty
};

// Whether the bytes of a format are for people, or would garble a terminal.
enum class FileKind {
  kText,
  kBinary,
  kBinaryOrText,  // as options say
};

// A file format.
// One folder each; formats.cc lists them all.
// Functions are null where the format cannot do it.
// Readers are strict about bytes and lenient about content: everything decodable loads, dangling ids included.
// Notices receive what a successful run has to tell.
//
// All throw Error: kDamaged where bytes are wrong, kUnsupported where they are sound but of another version.
struct Format {
  std::string_view id;                         // for ReadOptions::format and WriteOptions::format
  std::string_view title;                      // for people
  std::span<const std::string_view> suffixes;  // `.osa`
  FileKind kind = FileKind::kText;
  bool is_folder = false;       // a folder of files
  bool needs_path = false;      // several files, or a database: neither standard input or output nor memory
  bool named = false;           // a file holds several atlases, each under a name
  bool chooses_maps = false;    // writes the map of ExportOptions::map alone; others write all maps whatever it says
  bool keeps_encoding = false;  // reads and keeps ArchiveEncoding
  bool has_colors = false;      // of points, as PointCloudOptions::color has them
  bool is_on_globe = false;     // lays maps onto the earth, from GeographicOptions::origin on
  bool is_export = false;       // claims to hold points or poses, and no atlas: what it leaves out is no loss
  Content reads = Content::kNothing, writes = Content::kNothing;
  // What it can hold of this atlas, where that depends on more than the format; null: `writes`.
  Content (*holds)(const Atlas&, const WriteOptions&) = nullptr;
  bool (*sniff)(const Probe&) = nullptr;  // by first bytes; null: by suffix only
  Atlas (*read)(const Source&, const ReadOptions&, Notices&) = nullptr;
  void (*write)(const Atlas&, const Target&, const WriteOptions&, Notices&) = nullptr;
  Salvage (*salvage)(const Source&, const ReadOptions&) = nullptr;  // what can be read of a damaged file
};

}  // namespace slamdb
