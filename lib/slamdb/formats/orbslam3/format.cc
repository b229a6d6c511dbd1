// SPDX-License-Identifier: BSD-3-Clause
#include <array>

#include "slamdb/formats/orbslam3/detail/archive_header.h"
#include "slamdb/formats/orbslam3/detail/fork_losses.h"
#include "slamdb/formats/orbslam3/detail/salvage.h"
#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/orbslam3/orbslam3.h"

namespace slamdb {
namespace {

constexpr std::array<std::string_view, 1> kSuffixes{".osa"};
constexpr std::array<std::string_view, 1> kTextSuffixes{".osa.txt"};

Content Holds(const Atlas& atlas, const WriteOptions& options) {
  return orbslam3::HeldBy(atlas, options.of<Orbslam3WriteOptions>().layout.value_or(atlas.layout));
}

bool SniffBinary(const Probe& probe) { return orbslam3::SniffArchive(probe.head) == false; }
bool SniffText(const Probe& probe) { return orbslam3::SniffArchive(probe.head) == true; }

void Write(const Atlas& atlas, bool text, const Target& target, const WriteOptions& options, Notices& notices) {
  if (atlas.encoding.text == text) return WriteOrbslam3(atlas, target, options, notices);
  Atlas other = atlas;
  other.encoding.text = text;
  WriteOrbslam3(other, target, options, notices);
}
void WriteBinary(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  Write(atlas, false, target, options, notices);
}
void WriteText(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  Write(atlas, true, target, options, notices);
}

}  // namespace

const Format kOrbslam3Format{.id = "orbslam3",
                             .title = "ORB-SLAM3 atlas, binary Boost archive",
                             .suffixes = kSuffixes,
                             .kind = FileKind::kBinary,
                             .keeps_encoding = true,
                             .reads = Content::kAtlas,
                             .writes = Content::kAtlas,
                             .holds = Holds,
                             .sniff = SniffBinary,
                             .read = ReadOrbslam3,
                             .write = WriteBinary,
                             .salvage = detail::SalvageOrbslam3};

const Format kOrbslam3TextFormat{.id = "orbslam3-text",
                                 .title = "ORB-SLAM3 atlas, text Boost archive",
                                 .suffixes = kTextSuffixes,
                                 .keeps_encoding = true,
                                 .reads = Content::kAtlas,
                                 .writes = Content::kAtlas,
                                 .holds = Holds,
                                 .sniff = SniffText,
                                 .read = ReadOrbslam3,
                                 .write = WriteText,
                                 .salvage = detail::SalvageOrbslam3};

}  // namespace slamdb
