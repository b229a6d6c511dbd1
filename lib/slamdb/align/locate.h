// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "slamdb/base/progress.h"
#include "slamdb/export.h"
#include "slamdb/model/atlas.h"
#include "slamdb/model/picture_features.h"
#include "slamdb/model/vocabulary_tree.h"

namespace slamdb {

enum class LocateVerdict {
  kFound,       // sure enough to act on
  kDoubtful,    // something agrees, but it could be a look-alike, or there is too little of it to tell
  kNotFound,    // nothing agrees, or what does is contradicted by the picture
  kUnreadable,  // of a file that is no picture, or of no camera that is known; no Locator says so
};

// `found`, `doubtful`, `not-found`, `unreadable`.
[[nodiscard]] SLAMDB_EXPORT std::string_view NameOf(LocateVerdict verdict);

struct LocatorOptions {
  // What the atlas's bags of words are of; it must outlive the locator. Null: a small one is trained on the maps, as it
  // is where bags are missing.
  const VocabularyTree* vocabulary = nullptr;
  // Places are known from elsewhere, as from a store: LocateAt alone is asked, and no vocabulary is trained.
  bool places_are_known = false;
  int threads = 0;    // 0: every core; of the preparation
  Progress progress;  // may be empty
};

// What the verdict rests on.
struct LocateEvidence {
  std::uint64_t features = 0;       // of the picture
  std::uint64_t candidates = 0;     // places that were compared
  std::uint64_t inliers = 0;        // keypoints that are points of the map
  std::uint64_t visible = 0;        // points that the picture must show
  double found_share = 0;           // of these
  double cell_share = 0;            // of the parts of the picture with enough of these, those in which some were found
  double front_share = 0;           // of these, those in front of what the picture shows
  double checked_share = 0;         // of the parts of the picture, those with enough of these
  double extent = 0;                // of what was found, across its second axis, in depths
  double spread = 0;                // of the inliers in the picture, across their second axis, in its smaller sides
  std::uint64_t contradicting = 0;  // inliers of the best other place of the map
  double rms = 0;                   // reprojection of the inliers, in sigmas of keypoints
  double focal_factor = 1;          // of the camera's focal length, the one that fits best, and
  double focal_deviation = 0;       // its standard deviation
};

// Where a picture was taken.
struct Localization {
  LocateVerdict verdict = LocateVerdict::kNotFound;
  std::string reason;  // one sentence: what decided
  // The best pose; none when nothing agreed. Of the camera in the map: world_from_camera.
  bool has_pose = false;
  MapId map;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  // Covariance of a small motion of the camera, in the world's axes and about its own centre: rotation vector
  // (radians), then translation (map units). Given the map as it is.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  KeyFrameId resembles;  // the keyframe that sees most of what was found
  LocateEvidence evidence;
};

// Standard deviations of a pose, given the map as it is.
struct PosePrecision {
  double rotation_degrees = 0;  // about the axis about which it is least known
  double position = 0;          // likewise; map units
};
[[nodiscard]] SLAMDB_EXPORT PosePrecision PrecisionOf(const Localization& localization);

// One of the keyframes of an atlas.
struct KeyFrameRef {
  std::size_t map = 0, keyframe = 0;  // rows
};

// Finds pictures in the maps of an atlas, by what they show, without a SLAM system.
// A place is recognised by bags of words, the picture's keypoints are matched with the points about it, the pose is
// solved for and refined over all points found near where it says they are, and then the picture is held against the
// map: what it must show and does not speaks against the pose, however many matches speak for it. Deterministic.
// Constant after construction: safe to use from many threads.
//
// After ORB-SLAM3's relocalisation (Campos et al., TRO 2021), with the verification that offline allows.
class SLAMDB_EXPORT Locator {
 public:
  // Refers to the atlas, which must outlive it and keep its lists as they are. Maps without keyframes are passed over.
  //
  // Throws Error (kNotPossible): no map has keyframes.
  // Cost: linear; training a vocabulary takes most of it.
  explicit Locator(const Atlas& atlas, const LocatorOptions& options = {});
  Locator(Locator&&) noexcept;
  ~Locator();

  // Cost: about that of comparing the picture with a few places, whatever the size of the map.
  // Not found where places are to be known from elsewhere.
  [[nodiscard]] Localization Locate(const PictureFeatures& picture) const;

  // The same at places that are known to look like the picture, the most alike first. Keyframes that are flagged bad,
  // or have no camera or no pose, are passed over.
  [[nodiscard]] Localization LocateAt(const PictureFeatures& picture, std::span<const KeyFrameRef> places) const;

  // Finds a keyframe by its recorded features as if the map had never had it: without the points that need it, and with
  // the descriptors of the other keyframes. Not found where it is flagged bad, has no camera or no pose.
  [[nodiscard]] Localization LocateLeftOut(const KeyFrameRef& keyframe) const;

 private:
  struct State;
  std::unique_ptr<const State> state_;
};

}  // namespace slamdb
