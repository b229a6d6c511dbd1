// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam2/detail/members.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>

#include "slamdb/formats/import/detail/possible.h"
#include "slamdb/model/detail/matrix_types.h"

namespace slamdb::orbslam2 {
namespace {

// Whether the rows of a matrix are descriptors as ORB has them.
bool IsOrb(const Matrix& matrix) {
  return matrix.type == detail::kCv8U && matrix.columns == static_cast<std::int32_t>(sizeof(Descriptor));
}

// Nothing where it is empty, or zeros: a matrix that was never set.
std::optional<Rigid3f> TakePose(Archive& archive, const char* field) {
  using Matrix4 = Eigen::Matrix<float, 4, 4, Eigen::RowMajor>;
  Matrix4 pose = Matrix4::Zero();
  archive.TakeFloats(field, pose.data(), 4, 4);
  if (pose.isZero(0)) return std::nullopt;
  const Eigen::Matrix3d rotation = pose.topLeftCorner<3, 3>().cast<double>();
  const Eigen::Vector3d translation = pose.topRightCorner<3, 1>().cast<double>();
  archive.Require(detail::WhyNoPose(rotation, translation));
  return detail::PoseOf(rotation, translation);
}

void RequireCamera(const Archive& archive, double fx, double fy, double cx, double cy) {
  archive.Require(detail::WhyNoCameraOrNone(fx, fy, std::array{cx, cy}));
}

void TakeIntrinsics(Archive& archive, Intrinsics& intrinsics) {
  intrinsics.fx = archive.Take<float>("fx");
  intrinsics.fy = archive.Take<float>("fy");
  intrinsics.cx = archive.Take<float>("cx");
  intrinsics.cy = archive.Take<float>("cy");
  RequireCamera(archive, intrinsics.fx, intrinsics.fy, intrinsics.cx, intrinsics.cy);
  intrinsics.inverse_fx = archive.Take<float>("invfx");
  intrinsics.inverse_fy = archive.Take<float>("invfy");
  intrinsics.baseline_fx = archive.Take<float>("mbf");
  intrinsics.baseline = archive.Take<float>("mb");
  intrinsics.depth_threshold = archive.Take<float>("mThDepth");
}

}  // namespace

void TakePointHead(Archive& archive, MapPoint& point, std::uint64_t& next_id) {
  point.id = MapPointId(archive.Take<std::uint64_t>("mnId"));
  archive.place().id = point.id.value();
  next_id = std::max(next_id, archive.Take<std::uint64_t>("nNextId"));
  point.first_keyframe = archive.Take<std::int64_t>("mnFirstKFid");
  point.first_frame = archive.Take<std::int64_t>("mnFirstFrame");
  point.observation_count = archive.Take<std::int32_t>("nObs");
  archive.Skip<float>("mTrackProjX", 3);
  archive.Skip<std::uint8_t>("mbTrackInView", 1);
  archive.Skip<std::int32_t>("mnTrackScaleLevel", 1);
  archive.Skip<float>("mTrackViewCos", 1);
  archive.Skip<std::uint64_t>("mnTrackReferenceForFrame", 7);
  archive.SkipMatrix("mPosGBA");
  archive.Skip<std::uint64_t>("mnBAGlobalForKF", 1);
  archive.TakeFloats("mWorldPos", point.position.data(), 3, 1);
  archive.Require(detail::WhyNoPosition(point.position.cast<double>()));
}

void TakePointMatrices(Archive& archive, MapPoint& point) {
  archive.TakeFloats("mNormalVector", point.normal.data(), 3, 1);
  Matrix descriptor = archive.TakeMatrix("mDescriptor");
  if (IsOrb(descriptor) && descriptor.rows == 1) {
    std::memcpy(point.descriptor.data(), descriptor.data.data(), sizeof(Descriptor));
    return;
  }
  point.descriptor_form = MatrixForm::kEmpty;
  if (!descriptor.data.empty()) point.carried.Make().descriptors = std::move(descriptor);
}

void TakeKeyFrameHead(Archive& archive, KeyFrame& keyframe, std::uint64_t& next_id) {
  next_id = std::max(next_id, archive.Take<std::uint64_t>("nNextId"));
  keyframe.id = KeyFrameId(archive.Take<std::uint64_t>("mnId"));
  archive.place().id = keyframe.id.value();
  keyframe.frame_id = archive.Take<std::uint64_t>("mnFrameId");
  keyframe.timestamp = archive.Take<double>("mTimeStamp");
  ImageBounds& bounds = keyframe.bounds;
  bounds.grid_columns = archive.Take<std::int32_t>("mnGridCols");
  bounds.grid_rows = archive.Take<std::int32_t>("mnGridRows");
  bounds.inverse_cell_width = archive.Take<float>("mfGridElementWidthInv");
  bounds.inverse_cell_height = archive.Take<float>("mfGridElementHeightInv");
  archive.Skip<std::uint64_t>("mnTrackReferenceForFrame", 4);
  for (const char* query : {"mnLoopQuery", "mnRelocQuery"}) {
    archive.Skip<std::uint64_t>(query, 1);
    archive.Skip<std::int32_t>(query, 1);
    archive.Skip<float>(query, 1);
  }
  archive.SkipMatrix("mTcwGBA");
  archive.SkipMatrix("mTcwBefGBA");
  archive.Skip<std::uint64_t>("mnBAGlobalForKF", 1);
  TakeIntrinsics(archive, keyframe.intrinsics);
}

void TakeFeatures(Archive& archive, KeyFrame& keyframe) {
  Features& features = keyframe.features;
  features.count = archive.Take<std::int32_t>("N");
  archive.TakeKeypoints("mvKeys", features.keypoints);
  archive.TakeKeypoints("mvKeysUn", features.undistorted);
  archive.TakeNumbers("mvuRight", WireClass::kFloats, features.right_x);
  archive.TakeNumbers("mvDepth", WireClass::kFloats, features.depth);
  Matrix descriptors = archive.TakeMatrix("mDescriptors");
  if (IsOrb(descriptors)) {
    features.descriptors.resize(static_cast<std::size_t>(descriptors.rows));
    if (!descriptors.data.empty())
      std::memcpy(features.descriptors.data(), descriptors.data.data(), descriptors.data.size());
  } else if (!descriptors.data.empty()) {
    keyframe.carried.Make().descriptors = std::move(descriptors);
  }
  archive.TakeBagOfWords(features.bag_of_words);
  archive.TakeFeatureVector(features.feature_vector);
}

bool TakePoses(Archive& archive, KeyFrame& keyframe) {
  keyframe.camera_from_parent = TakePose(archive, "mTcp").value_or(Rigid3f());
  ScalePyramid& pyramid = keyframe.pyramid;
  pyramid.levels = archive.Take<std::int32_t>("mnScaleLevels");
  pyramid.factor = archive.Take<float>("mfScaleFactor");
  pyramid.log_factor = archive.Take<float>("mfLogScaleFactor");
  archive.TakeNumbers("mvScaleFactors", WireClass::kFloats, pyramid.factors);
  archive.TakeNumbers("mvLevelSigma2", WireClass::kFloats, pyramid.sigma2);
  archive.TakeNumbers("mvInvLevelSigma2", WireClass::kFloats, pyramid.inverse_sigma2);
  ImageBounds& bounds = keyframe.bounds;
  bounds.min_x = archive.Take<std::int32_t>("mnMinX");
  bounds.min_y = archive.Take<std::int32_t>("mnMinY");
  bounds.max_x = archive.Take<std::int32_t>("mnMaxX");
  bounds.max_y = archive.Take<std::int32_t>("mnMaxY");
  Eigen::Matrix<float, 3, 3, Eigen::RowMajor> calibration = Eigen::Matrix3f::Identity();
  archive.TakeFloats("mK", calibration.data(), 3, 3);
  RequireCamera(archive, calibration(0, 0), calibration(1, 1), calibration(0, 2), calibration(1, 2));
  keyframe.calibration_matrix = calibration;
  const std::optional<Rigid3f> camera_from_world = TakePose(archive, "Tcw");
  keyframe.camera_from_world = camera_from_world.value_or(Rigid3f());
  for (const char* derived : {"Twc", "Ow", "Cw"}) archive.SkipMatrix(derived);
  return camera_from_world.has_value();
}

void TakeKeyFrameTail(Archive& archive, KeyFrame& keyframe) {
  keyframe.not_erase = archive.TakeFlag("mbNotErase");
  keyframe.to_be_erased = archive.TakeFlag("mbToBeErased");
  keyframe.bad = archive.TakeFlag("mbBad");
  keyframe.half_baseline = archive.Take<float>("mHalfBaseline");
}

}  // namespace slamdb::orbslam2
