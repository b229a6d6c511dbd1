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
    record.reference = KeyFrameId(point.mBackupRefKFId);
    record.replaced_by = MapPointId(static_cast<std::uint64_t>(point.mBackupReplacedId));
    boost_archive::Pair(Rows(point.mBackupObservationsId1), Rows(point.mBackupObservationsId2), record.observations);
    const std::scoped_lock lock(point.mutex_position_, point.mutex_features_);
    point.WriteValues(record);
    return record;
  }

  // What no archive holds, counters and origin, is then as of a point that was loaded without them: not recorded.
  static void FromRecord(const slamdb::MapPoint& record, MapPoint& point) {
    point.mnId = record.id.value();
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
    point.ReadValues(record);
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
