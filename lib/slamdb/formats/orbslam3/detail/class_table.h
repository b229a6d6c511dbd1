// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "slamdb/model/atlas.h"

namespace slamdb::orbslam3 {

// The C++ types that take part in Boost's class table, named after what they hold. See schema/orbslam3.md.
enum class WireClass : std::uint8_t {
  kAtlas,
  kPinhole,
  kKannalaBrandt8,
  kMapList,  // vector<Map*>
  kMap,
  kKeyFrameList,  // vector<KeyFrame*>
  kKeyFrame,
  kFloats,     // vector<float>
  kBowVector,  // BowVector, derived from ...
  kBowMap,     // ... map<unsigned, double>
  kBowPair,
  kFeatureVector,  // FeatureVector, derived from ...
  kFeatureMap,     // ... map<unsigned, vector<unsigned>>
  kFeaturePair,
  kUnsigneds,   // vector<unsigned>
  kLongLongs,   // vector<long long>
  kGrid,        // vector<vector<vector<size_t>>>
  kGridColumn,  // vector<vector<size_t>>
  kSizes,       // vector<size_t>
  kWeightMap,   // map<unsigned long, int>: covisibility and observations
  kWeightPair,
  kUnsignedLongs,  // vector<unsigned long>
  kInts,           // vector<int>
  kBias,
  kPreintegrated,
  kMeasurementList,  // vector<integrable>
  kMeasurement,
  kCalib,
  kMapPointList,  // vector<MapPoint*>
  kMapPoint,
  kCameraList,  // vector<GeometricCamera*>
  kGeometricCamera,
  kCount,
};

// Classes of a fork are numbered behind kCount, see fork_program.h.
inline constexpr std::size_t kMostWireClasses = 64;

// Boost's table of classes: a class gets the next id when it is first met, so ids depend on the data. Both sides of an
// archive keep one and must agree. A small value: each block of work that runs on its own starts from a copy.
class ClassTable {
 public:
  explicit ClassTable(const ArchiveEncoding& encoding) { Alias(encoding); }

  // Gives the class an id if it has none; returns the id.
  std::int16_t Register(WireClass wire_class) {
    std::int16_t& id = ids_[Slot(wire_class)];
    if (id < 0) id = next_++;
    return id;
  }

  // Registers the class and returns true the first time that its info (tracking, version) stands in the archive.
  bool FirstUse(WireClass wire_class) {
    Register(wire_class);
    const std::uint64_t bit = std::uint64_t{1} << Slot(wire_class);
    const bool first = ((used_ | met_) & bit) == 0;
    used_ |= bit;
    return first;
  }
  // Of the part of an archive that has all classes in front of it, but the one that is left out (kCount: none): their
  // infos are not looked for. Which numbers they have does not matter.
  void MeetAllBut(WireClass left_out) {
    for (std::size_t slot = 0; slot < kMostWireClasses; ++slot) {
      const auto wire_class = static_cast<WireClass>(slot);
      if (wire_class == WireClass::kCount || wire_class == left_out) continue;
      Register(wire_class);
      met_ |= std::uint64_t{1} << Slot(wire_class);
    }
  }
  // Whether FirstUse asked for it.
  bool Used(WireClass wire_class) const { return (used_ >> Slot(wire_class) & 1U) != 0; }

  bool Has(WireClass wire_class) const { return ids_[Slot(wire_class)] >= 0; }
  // The id that the next class gets.
  std::int16_t next() const { return next_; }

  // The class of that id, kCount when there is none.
  WireClass Find(std::int16_t id) const {
    for (std::size_t slot = 0; slot < ids_.size(); ++slot)
      if (ids_[slot] == id && id >= 0) return static_cast<WireClass>(slot);
    return WireClass::kCount;
  }

  friend bool operator==(const ClassTable&, const ClassTable&) = default;

 private:
  // vector<size_t> is the type vector<unsigned long> where both have 8 bytes, vector<unsigned> on 32-bit systems, and a
  // type of its own on 64-bit Windows.
  void Alias(const ArchiveEncoding& encoding) {
    ids_.fill(-1);
    if (encoding.size_bytes == 4)
      sizes_alias_ = WireClass::kUnsigneds;
    else if (encoding.long_bytes == 8)
      sizes_alias_ = WireClass::kUnsignedLongs;
  }
  std::size_t Slot(WireClass wire_class) const {
    return static_cast<std::size_t>(wire_class == WireClass::kSizes ? sizes_alias_ : wire_class);
  }

  std::array<std::int16_t, kMostWireClasses> ids_{};
  std::uint64_t used_ = 0, met_ = 0;
  std::int16_t next_ = 0;
  WireClass sizes_alias_ = WireClass::kSizes;
};

}  // namespace slamdb::orbslam3
