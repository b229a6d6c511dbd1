// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "slamdb/base/detail/pieces.h"
#include "slamdb/formats/orbslam3/detail/class_table.h"

namespace slamdb::orbslam3 {

// A stretch of a list of pointers: `count` new objects, rows and object ids ascending, or one pointer to an object that
// is already stored, or a null pointer.
struct PointerRun {
  enum class Kind { kNew, kAgain, kNull } kind = Kind::kNew;
  std::uint64_t row = 0;  // of the first new object
  std::uint64_t count = 1;
  std::uint32_t object = 0;  // id of the first
};

// A piece of the archive that can be encoded on its own, with the class table that it starts from.
struct Segment {
  enum class Kind { kHead, kMapPointer, kMapHead, kKeyFrames, kPoints, kMapTail, kTail } kind = Kind::kHead;
  ClassTable classes;
  std::size_t map = 0;       // row; of all but kHead and kTail
  bool begins_list = false;  // kKeyFrames, kPoints: the list's header stands in front
  std::uint64_t list_size = 0;
  std::vector<PointerRun> pointers = {};
};

// An archive cut into segments, so that threads can encode them. Holds a reference to the atlas.
class ArchivePlan {
 public:
  // Throws Error when a repeated entry refers to nothing that stands before it.
  ArchivePlan(const Atlas& atlas, const ArchiveEncoding& encoding);

  std::size_t size() const { return segments_.size(); }
  // How many threads of those asked for pay: one where no list is longer than a segment.
  int ThreadsThatPay(int requested) const;
  // Appends segment `i` to the buffer, which may refer to the atlas. Returns false when it is text with `nan` or `inf`,
  // which Boost does not read. Thread-safe. Throws Error when an id does not fit the encoding.
  bool Encode(std::size_t i, detail::Pieces& buffer) const;

 private:
  struct MapObjects {
    std::uint32_t map = 0, first_keyframe = 0, first_point = 0, end = 0;  // object ids
  };

  void PlanMap(std::size_t row, ClassTable& classes);
  void AddList(Segment::Kind kind, std::size_t map, const std::vector<PointerRun>& runs, std::size_t segment_size,
               ClassTable& classes);
  void Add(Segment segment, ClassTable& classes);
  std::vector<PointerRun> Runs(std::uint64_t rows, std::uint32_t first_object,
                               const std::vector<RepeatedEntry>& repeated, std::uint32_t MapObjects::*first_of) const;

  const Atlas& atlas_;
  const ArchiveEncoding encoding_;
  std::vector<Segment> segments_;
  std::vector<MapObjects> objects_;  // of the maps planned so far
  std::uint32_t next_object_ = 1;    // 0 is the atlas
};

}  // namespace slamdb::orbslam3
