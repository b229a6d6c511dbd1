// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mutex>

#include "slamdb/boost.h"
#include "slamdb/live/map_point.h"

// `archive & point` of live map points in archives of stock Boost.Serialization, as ORB-SLAM3 does it: links go through
// the mBackup members. So call PreSave before saving, and PostLoad after loading, with what they may lead to.
//
//   point->PreSave(keyframes, points);
//   archive << *point;
//
// The archive holds what it holds for a slamdb::MapPoint, and either reads the other's.
namespace slamdb::live {

// Between a live point and its record, links as the mBackup members have them. Locks the point.
struct BoostAccess {
  static slamdb::MapPoint ToRecord(MapPoint& point) {
    slamdb::MapPoint record;
    record.id = MapPointId(point.mnId);
    record.first_keyframe = point.mnFirstKFid;
    record.first_frame = point.mnFirstFrame;
    record.observation_count = point.nObs;
    record.reference = KeyFrameId(point.mBackupRefKFId);
    record.replaced_by = MapPointId(static_cast<std::uint64_t>(point.mBackupReplacedId));
    boost_archive::Pair(Rows(point.mBackupObservationsId1), Rows(point.mBackupObservationsId2), record.observations);
    const std::scoped_lock lock(point.mutex_position_, point.mutex_features_);
    record.position = point.position_;
    record.normal = point.normal_;
    record.min_distance = point.min_distance_;
    record.max_distance = point.max_distance_;
    record.descriptor = point.descriptor_;
    record.descriptor_form = point.descriptor_form_;
    record.bad = point.bad_ == static_cast<bool>(point.recorded_bad_) ? point.recorded_bad_ : Flag(point.bad_);
    return record;
  }

  static void FromRecord(const slamdb::MapPoint& record, MapPoint& point) {
    point.mnId = record.id.value();
    point.mnFirstKFid = record.first_keyframe;
    point.mnFirstFrame = record.first_frame;
    point.nObs = record.observation_count;
    point.mBackupRefKFId = record.reference.value();
    point.mBackupReplacedId = static_cast<decltype(point.mBackupReplacedId)>(record.replaced_by.value());
    point.mBackupObservationsId1.clear();
    point.mBackupObservationsId2.clear();
    for (const Observation& observation : record.observations) {
      const unsigned long keyframe = observation.keyframe.value();
      if (observation.left != Observation::kAbsent) point.mBackupObservationsId1[keyframe] = observation.left;
      if (observation.right != Observation::kAbsent) point.mBackupObservationsId2[keyframe] = observation.right;
    }
    const std::scoped_lock lock(point.mutex_position_, point.mutex_features_);
    point.position_ = record.position;
    point.normal_ = record.normal;
    point.min_distance_ = record.min_distance;
    point.max_distance_ = record.max_distance;
    point.descriptor_ = record.descriptor;
    point.descriptor_form_ = record.descriptor_form;
    point.recorded_bad_ = record.bad;
    point.bad_ = record.bad;
    // No archive holds these: they are as of a point that was loaded without them, and so not recorded.
    point.visible_ = point.found_ = 1;
    point.has_visible_ = point.has_found_ = false;
    point.assumed_origin_ = point.mnOriginMapId;
  }

 private:
  static Column<Connection> Rows(const std::map<unsigned long, int>& backup) {
    Column<Connection> rows;
    rows.reserve(backup.size());
    for (const auto& [keyframe, row] : backup) rows.push_back({KeyFrameId(keyframe), row});
    return rows;
  }
};

template <class Archive>
void serialize(Archive& archive, MapPoint& point, const unsigned int version) {
  boost_archive::RequireVersion(version);
  slamdb::MapPoint record;
  if constexpr (Archive::is_saving::value) record = BoostAccess::ToRecord(point);
  boost_archive::Members(archive, record);
  if constexpr (Archive::is_loading::value) BoostAccess::FromRecord(record, point);
}

}  // namespace slamdb::live
