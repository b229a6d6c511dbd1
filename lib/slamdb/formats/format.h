// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/file.h"
#include "slamdb/base/notices.h"
#include "slamdb/base/progress.h"
#include "slamdb/model/atlas.h"

namespace slamdb {

// Where an atlas is: a file, or one atlas of several in a store (`store.db#name`). `-` is standard input or output.
struct Location {
  std::string path;
  std::string name;  // in a store; empty: the only one

  // Splits at the last `#` of the last path component, unless a file of the whole name exists.
  static Location Parse(std::string_view text);
  std::string ToString() const { return name.empty() ? path : path + "#" + name; }
  friend bool operator==(const Location&, const Location&) = default;
};

// What a format can hold. Flags.
enum Content : std::uint32_t {
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
  kEverything = kAtlas | kLandmarks | kTracking,
};
inline Content operator|(Content a, Content b) {
  return static_cast<Content>(static_cast<std::uint32_t>(a) | static_cast<std::uint32_t>(b));
}

// Which part of an atlas to read. Default: all. Keyframes outside the ranges are left out, and so are points outside
// the box; references to what was left out stay as they are, so a partial atlas is for looking at, not for saving as
// whole.
struct Selection {
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

// Which columns of the features to read. A reader may read more than was asked for.
enum class FeatureColumns {
  kAll,
  kGeometry,  // keypoints, stereo and depth, matches; no descriptors, grids and bags of words: for statistics
  kNone,
};

struct ReadOptions {
  int threads = 0;  // 0: every core
  FeatureColumns features = FeatureColumns::kAll;
  Selection selection;
  Progress progress;                            // may be empty
  double lock_timeout = 5;                      // seconds to wait for another process that holds a store
  std::vector<PartSize>* part_sizes = nullptr;  // filled where the format can tell
};

// In which frame a trajectory is written.
enum class PoseFrame { kCamera, kBody };

struct WriteOptions {
  bool overwrite = false;
  bool sync = true;  // fsync before the rename; false is faster and safe against everything but power loss
  int threads = 0;
  Progress progress;
  double lock_timeout = 5;

  // orbslam3
  std::optional<std::uint32_t> boost_version;  // default: as read
  std::optional<int> long_bytes;               // 8, or 4 for a writer with sizeof(long) == 4; default: as read
  bool sanitize = false;                       // write what ORB-SLAM3 itself reads safely, see sanitize.h

  // stores
  std::string provenance;  // one line for the history: what made this atlas (`convert session_a.osa`)

  // mrpt
  bool mrpt_own_slots = false;  // ORB descriptors where MRPT 2 itself writes them, which then reads them as BLD

  // point clouds and trajectories
  bool binary = true;        // PLY and PCD; false: ascii
  std::optional<MapId> map;  // only this map; otherwise all of them
  PoseFrame pose_frame = PoseFrame::kCamera;
};

// A file format. One folder each; formats.cc lists them all. Functions are null where the format cannot do it.
// Readers are strict about bytes and lenient about content: everything decodable loads, dangling ids included.
// All throw Error; `notices` receives what a successful run has to tell.
struct Format {
  std::string_view id;                         // as --from and --to take it
  std::string_view title;                      // for people
  std::span<const std::string_view> suffixes;  // `.osa`
  Content reads = kNothing, writes = kNothing;
  bool (*sniff)(const Probe&) = nullptr;  // by first bytes; null: by suffix only
  Atlas (*read)(const Location&, const ReadOptions&, Notices&) = nullptr;
  void (*write)(const Atlas&, const Location&, const WriteOptions&, Notices&) = nullptr;
};

}  // namespace slamdb
