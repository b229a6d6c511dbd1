// SPDX-License-Identifier: BSD-3-Clause
#include <array>

#include "slamdb/formats/orbslam3/detail/archive_header.h"
#include "slamdb/formats/orbslam3/orbslam3.h"

namespace slamdb {
namespace {

constexpr std::array<std::string_view, 1> kSuffixes{".osa"};
constexpr std::array<std::string_view, 1> kTextSuffixes{".osa.txt"};

bool SniffBinary(const Probe& probe) { return orbslam3::SniffArchive(probe.head) == false; }
bool SniffText(const Probe& probe) { return orbslam3::SniffArchive(probe.head) == true; }

Atlas Read(const Location& location, const ReadOptions& options, Notices& notices) {
  return ReadOrbslam3(location.path, options, notices);
}

void Write(const Atlas& atlas, bool text, const Location& location, const WriteOptions& options, Notices& notices) {
  if (atlas.encoding.text == text) return WriteOrbslam3(atlas, location.path, options, notices);
  Atlas other = atlas;
  other.encoding.text = text;
  WriteOrbslam3(other, location.path, options, notices);
}
void WriteBinary(const Atlas& atlas, const Location& location, const WriteOptions& options, Notices& notices) {
  Write(atlas, false, location, options, notices);
}
void WriteText(const Atlas& atlas, const Location& location, const WriteOptions& options, Notices& notices) {
  Write(atlas, true, location, options, notices);
}

}  // namespace

const Format kOrbslam3Format{.id = "orbslam3",
                             .title = "ORB-SLAM3 atlas, binary Boost archive",
                             .suffixes = kSuffixes,
                             .reads = kAtlas,
                             .writes = kAtlas,
                             .sniff = SniffBinary,
                             .read = Read,
                             .write = WriteBinary};

const Format kOrbslam3TextFormat{.id = "orbslam3-text",
                                 .title = "ORB-SLAM3 atlas, text Boost archive",
                                 .suffixes = kTextSuffixes,
                                 .reads = kAtlas,
                                 .writes = kAtlas,
                                 .sniff = SniffText,
                                 .read = Read,
                                 .write = WriteText};

}  // namespace slamdb
