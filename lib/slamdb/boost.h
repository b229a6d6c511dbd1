// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/serialization/level.hpp>
#include <boost/serialization/string.hpp>
#include <boost/serialization/tracking.hpp>
#include <utility>

#include "slamdb/boost/objects.h"

// `archive & x` of the model in archives of stock Boost.Serialization, as ORB-SLAM3 v1.0 archives its own classes: a
// program's boost::archive::binary_oarchive and text_oarchive write what ORB-SLAM3 and slamdb read, byte for byte, and
// its iarchives read what they write. Header-only; link slamdb::boost, which brings Boost.Serialization (1.58 or
// newer).
//
//   boost::archive::binary_oarchive archive(stream);
//   archive << atlas;                                   // a whole .osa file
//
// What stands in the archive for
//
//   Atlas              vocabulary name, checksum, Atlas*: all that an .osa file holds.
//   Map                class Map. It counts as map 0 of repeated_keyframes and repeated_points.
//   KeyFrame           class KeyFrame.
//   MapPoint           class MapPoint.
//   Camera             GeometricCamera*, which says whether it leads to a Pinhole or a KannalaBrandt8.
//   ImuBias, ImuPreintegration, ImuMeasurement, ImuCalibration
//                      classes Bias, Preintegrated, integrable, Calib, never tracked.
//   Rigid3f, Matrix    what ORB-SLAM3 writes for Sophus::SE3f and cv::Mat: members without class information.
//   Flag, Id           a byte; an unsigned long.
//
// Objects by value and `MapPoint*`, `KeyFrame*`, `Map*` follow Boost's rules for any class: a program that archives
// pointers to one, tracks its values too, by address. Lists within an atlas or a map track what they list by
// themselves.
//
// Not in ORB-SLAM3's layout, and therefore neither saved nor changed by loading: Atlas::encoding. Map::landmarks are
// not saved, and empty after loading.
//
// Saving throws Error: kNotPossible for a camera id that needs more than 32 bits, kUsage for a RepeatedEntry that
// refers to nothing before it.
//
// Loading throws boost::archive::archive_exception, Error (kDamaged, kUnsupported) or another std::exception.
// An atlas stays as it was then; of another object parts may be read.
//
// Stock archives believe what they read: a damaged count allocates what it says, a class id out of range is followed
// blindly, nan in text cannot be read. Files of strangers are for slamdb::ReadAtlas, which checks all of that.
namespace slamdb {

template <class Archive, class Entity>
void serialize(Archive& archive, Id<Entity>& id, const unsigned int /*version*/) {
  detail::AsNumber<unsigned long>(archive, id);
}

template <class Archive>
void serialize(Archive& archive, ImuBias& bias, const unsigned int version) {
  detail::RequireVersion(version);
  detail::Members(archive, bias);
}

template <class Archive>
void serialize(Archive& archive, ImuCalibration& calibration, const unsigned int version) {
  detail::RequireVersion(version);
  detail::Members(archive, calibration);
}

template <class Archive>
void serialize(Archive& archive, ImuMeasurement& measurement, const unsigned int version) {
  detail::RequireVersion(version);
  detail::Members(archive, measurement);
}

template <class Archive>
void serialize(Archive& archive, ImuPreintegration& imu, const unsigned int version) {
  detail::RequireVersion(version);
  detail::Members(archive, imu);
}

template <class Archive>
void serialize(Archive& archive, MapPoint& point, const unsigned int version) {
  detail::RequireVersion(version);
  detail::Members(archive, point);
}

template <class Archive>
void serialize(Archive& archive, KeyFrame& keyframe, const unsigned int version) {
  detail::RequireVersion(version);
  detail::Members(archive, keyframe);
}

template <class Archive>
void serialize(Archive& archive, Map& map, const unsigned int version) {
  detail::RequireVersion(version);
  if constexpr (Archive::is_loading::value) map = Map();
  detail::MapMembers(archive, map, detail::ObjectsOf(archive).Begin());
}

template <class Archive>
void serialize(Archive& archive, Camera& camera, const unsigned int /*version*/) {
  detail::Objects& objects = detail::ObjectsOf(archive);
  detail::RegisterCameras(archive);
  detail::CameraEntry* entry = nullptr;
  if constexpr (Archive::is_saving::value) entry = objects.Add(camera);
  archive& entry;
  if constexpr (Archive::is_loading::value) camera = objects.Loaded(entry);
}

template <class Archive>
void serialize(Archive& archive, Atlas& atlas, const unsigned int /*version*/) {
  detail::AtlasEntries& entries = detail::ObjectsOf(archive).Begin();
  detail::Entry<Atlas>* entry = nullptr;
  if constexpr (Archive::is_saving::value) {
    entry = detail::ObjectsOf(archive).Add(atlas);
    archive& atlas.vocabulary.name& atlas.vocabulary.checksum& entry;
  } else {
    Atlas loaded;
    loaded.encoding = atlas.encoding;
    entries.target = &loaded;
    archive& loaded.vocabulary.name& loaded.vocabulary.checksum& entry;
    entries.target = nullptr;
    if (entry == nullptr || entry != entries.atlas) detail::FailLoading("no atlas where one belongs");
    atlas = std::move(loaded);
  }
}

}  // namespace slamdb

// Without class information, and the ones that Boost knows by class, but never by address.
BOOST_CLASS_IMPLEMENTATION(slamdb::Atlas, boost::serialization::object_serializable)
BOOST_CLASS_TRACKING(slamdb::Atlas, boost::serialization::track_never)
BOOST_CLASS_IMPLEMENTATION(slamdb::Camera, boost::serialization::object_serializable)
BOOST_CLASS_TRACKING(slamdb::Camera, boost::serialization::track_never)
BOOST_CLASS_IMPLEMENTATION(slamdb::Rigid3f, boost::serialization::object_serializable)
BOOST_CLASS_TRACKING(slamdb::Rigid3f, boost::serialization::track_never)
BOOST_CLASS_IMPLEMENTATION(slamdb::Matrix, boost::serialization::object_serializable)
BOOST_CLASS_TRACKING(slamdb::Matrix, boost::serialization::track_never)
BOOST_CLASS_IMPLEMENTATION(slamdb::Flag, boost::serialization::object_serializable)
BOOST_CLASS_TRACKING(slamdb::Flag, boost::serialization::track_never)
BOOST_CLASS_TRACKING(slamdb::ImuBias, boost::serialization::track_never)
BOOST_CLASS_TRACKING(slamdb::ImuCalibration, boost::serialization::track_never)
BOOST_CLASS_TRACKING(slamdb::ImuMeasurement, boost::serialization::track_never)
BOOST_CLASS_TRACKING(slamdb::ImuPreintegration, boost::serialization::track_never)

namespace boost::serialization {
template <class Entity>
struct implementation_level<slamdb::Id<Entity>> : mpl::int_<object_serializable> {
  using type = mpl::int_<object_serializable>;
};
template <class Entity>
struct tracking_level<slamdb::Id<Entity>> : mpl::int_<track_never> {
  using type = mpl::int_<track_never>;
};
}  // namespace boost::serialization
