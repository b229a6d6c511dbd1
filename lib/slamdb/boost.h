// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/serialization/level.hpp>
#include <boost/serialization/string.hpp>
#include <boost/serialization/tracking.hpp>
#include <utility>

#include "slamdb/boost/objects.h"

// `archive & x` of the model in archives of stock Boost.Serialization, as ORB-SLAM3 v1.0 archives its own classes.
//
// A program's binary_oarchive and text_oarchive write what ORB-SLAM3 and slamdb read, byte for byte.
// Its iarchives read what they write.
// Header-only; link slamdb::boost, which brings Boost.Serialization, 1.58 or newer.
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
// Lists within an atlas or a map track what they list, repeated and null pointers too.
// Objects by value, and `MapPoint*`, `KeyFrame*`, `Map*`, follow Boost's rules for any class: a program that archives
// pointers to a class tracks its values too, by address.
//
// Not in ORB-SLAM3's layout, and not archived: Atlas::encoding, which loading leaves alone; Map::landmarks, which are
// empty after loading.
//
// Saving throws Error: kNotPossible for a camera id that needs more than 32 bits, kUsage for a RepeatedEntry that
// refers to nothing before it.
//
// Loading throws boost::archive::archive_exception, Error (kDamaged, kUnsupported) or another std::exception.
// An atlas then stays as it was; of other objects, parts may have been read.
//
// Stock archives believe what they read: a damaged count allocates what it says, a class id that no class has is
// followed, nan in text is not read. Files of strangers are for slamdb::ReadAtlas, which checks all of that.
//
// One archive at a time is one thread's; different archives are independent.
namespace slamdb {

template <class Archive, class Entity>
void serialize(Archive& archive, Id<Entity>& id, const unsigned int /*version*/) {
  boost_archive::AsNumber<unsigned long>(archive, id);
}

template <class Archive>
void serialize(Archive& archive, ImuBias& bias, const unsigned int version) {
  boost_archive::RequireVersion(version);
  boost_archive::Members(archive, bias);
}

template <class Archive>
void serialize(Archive& archive, ImuCalibration& calibration, const unsigned int version) {
  boost_archive::RequireVersion(version);
  boost_archive::Members(archive, calibration);
}

template <class Archive>
void serialize(Archive& archive, ImuMeasurement& measurement, const unsigned int version) {
  boost_archive::RequireVersion(version);
  boost_archive::Members(archive, measurement);
}

template <class Archive>
void serialize(Archive& archive, ImuPreintegration& imu, const unsigned int version) {
  boost_archive::RequireVersion(version);
  boost_archive::Members(archive, imu);
}

template <class Archive>
void serialize(Archive& archive, MapPoint& point, const unsigned int version) {
  boost_archive::RequireVersion(version);
  boost_archive::Members(archive, point);
}

template <class Archive>
void serialize(Archive& archive, KeyFrame& keyframe, const unsigned int version) {
  boost_archive::RequireVersion(version);
  boost_archive::Members(archive, keyframe);
}

template <class Archive>
void serialize(Archive& archive, Map& map, const unsigned int version) {
  boost_archive::RequireVersion(version);
  if constexpr (Archive::is_loading::value) map = Map();
  boost_archive::MapMembers(archive, map, boost_archive::ObjectsOf(archive).Begin());
}

template <class Archive>
void serialize(Archive& archive, Camera& camera, const unsigned int /*version*/) {
  boost_archive::Objects& objects = boost_archive::ObjectsOf(archive);
  boost_archive::RegisterCameras(archive);
  boost_archive::CameraEntry* entry = nullptr;
  if constexpr (Archive::is_saving::value) entry = objects.Add(camera);
  archive& entry;
  if constexpr (Archive::is_loading::value) camera = objects.Loaded(entry);
}

template <class Archive>
void serialize(Archive& archive, Atlas& atlas, const unsigned int /*version*/) {
  boost_archive::AtlasEntries& entries = boost_archive::ObjectsOf(archive).Begin();
  boost_archive::Entry<Atlas>* entry = nullptr;
  if constexpr (Archive::is_saving::value) {
    entry = boost_archive::ObjectsOf(archive).Add(atlas);
    archive& atlas.vocabulary.name& atlas.vocabulary.checksum& entry;
  } else {
    Atlas loaded;
    loaded.encoding = atlas.encoding;
    entries.target = &loaded;
    archive& loaded.vocabulary.name& loaded.vocabulary.checksum& entry;
    entries.target = nullptr;
    if (entry == nullptr || entry != entries.atlas) boost_archive::FailLoading("no atlas where one belongs");
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
