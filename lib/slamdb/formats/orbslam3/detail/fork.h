// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

#include "slamdb/base/detail/file_stream.h"
#include "slamdb/formats/format.h"
#include "slamdb/formats/orbslam3/detail/archive_header.h"
#include "slamdb/formats/orbslam3/detail/decoder.h"
#include "slamdb/formats/orbslam3/detail/fork_program.h"

// Reading and writing archives of forks.
namespace slamdb::orbslam3 {

struct ForkReading {
  Atlas atlas;
  std::size_t left = 0;           // bytes behind its end
  std::uint64_t implausible = 0;  // keyframes of which a converted member makes no sense
  PartBytes part_bytes{};
  std::vector<std::string> derived;  // what the layout lacks and was derived from the rest
  // Keys of camera classes that nobody registered, by the class, as the file has them.
  std::map<std::string, std::string> exported;
};

// Reads an archive, whose header was read, on the calling thread. atlas.layout stays empty.
//
// Throws Error as ReadOrbslam3 does: what is no archive of that layout is kDamaged.
ForkReading ReadFork(detail::FileStream& file, const ArchiveHeader& header, const ForkProgram& program,
                     const ReadOptions& options);

// Fills what a layout lacks of a keyframe and its keypoints and map tell.
void DeriveLacking(const ForkProgram& program, const Map& map, FeatureColumns columns, KeyFrame& keyframe);

// Where the members of a keyframe or map point stand.
struct RecordPlace {
  std::size_t begin = 0;
  std::size_t end = 0;  // 0: unknown
};
struct MapPlaces {
  std::vector<RecordPlace> keyframes, points;
};
// What records are read for.
enum class RecordUse {
  kAtlas,
  kMeaning,  // without grids and bags of words, which MeaningOf asks nothing about
};
struct ForkRecords {
  Atlas atlas;
  std::vector<MapPlaces> readable;  // those that were read, and those whose end is unknown
};
// Reads records of a damaged binary archive, each by itself; those that do not end where they must are left out. Maps
// are numbered.
ForkRecords ReadForkRecords(detail::FileStream& file, const ArchiveHeader& header, const ForkProgram& program,
                            std::span<const MapPlaces> maps, RecordUse use);

// What of an atlas is no part of a layout.
struct ForkWriting {
  std::uint64_t filled_keyframes = 0, filled_points = 0, filled_others = 0;  // entities without members of the fork
  std::uint64_t encoded_anew = 0;  // converted members that changed since they were read
  std::uint64_t dropped_pointers = 0;
};

// Hands the bytes of the atlas, header included, to `write`, in the layout of the program. `carried_fits`: its carried
// members are of it.
//
// Throws Error: kDamaged where carried members are not of the layout, kNotPossible where it cannot hold a camera or an
// id.
ForkWriting WriteFork(const Atlas& atlas, const ArchiveEncoding& encoding, const ForkProgram& program,
                      bool carried_fits, const Target::Sink& write);

}  // namespace slamdb::orbslam3
