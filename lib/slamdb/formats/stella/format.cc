// SPDX-License-Identifier: BSD-3-Clause
#include <array>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/recognize.h"
#include "slamdb/formats/export/detail/maps.h"
#include "slamdb/formats/sqlite/detail/foreign.h"
#include "slamdb/formats/stella/detail/assemble.h"
#include "slamdb/formats/stella/detail/database_format.h"
#include "slamdb/formats/stella/detail/message_pack_format.h"
#include "slamdb/formats/stella/detail/outgoing.h"
#include "slamdb/formats/stella/detail/stella.h"

namespace slamdb::detail {
namespace {

// Maps lie in frames of their own, which spanning trees tell apart; normals, distance ranges and covisibility are
// derived from what is held.
constexpr Content kHeld = Content::kPoses | Content::kPoints | Content::kNormals | Content::kObservations |
                          Content::kKeypoints | Content::kDescriptors | Content::kGraph | Content::kCameras |
                          Content::kMaps | Content::kIdentity | Content::kTracking;

bool Is(const Probe& probe, std::string_view id) {
  const auto recognized = Recognize(probe);
  return recognized && recognized->id == id;
}

bool SniffMessagePack(const Probe& probe) {
  return !probe.head.empty() && !IsSqlite(probe.head) && Is(probe, "stella");
}
bool SniffDatabase(const Probe& probe) { return IsSqlite(probe.head) && Is(probe, "stella-sqlite"); }

Atlas ReadStella(const Source& source, const ReadOptions& options, Notices& notices) {
  stella::StoredMap map;
  {
    const WholeFile file(source);
    map = stella::DecodeMessagePack(file.text(), source.path, options);
  }
  return stella::Assemble(std::move(map), source.path, options, notices);
}

void WriteStella(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  const stella::Outgoing map(atlas, target, options, notices);
  if (const std::uint64_t shapes = stella::WriteMessagePack(map, target, options); shapes > 0)
    notices.Lose(Concat(Counted(shapes, "keypoint"),
                        " lose response and size: it has no place for them, and the size is read as that of the "
                        "octave"));
}

Atlas ReadStellaDatabase(const Source& source, const ReadOptions& options, Notices& notices) {
  sqlite::Database database = sqlite::OpenForeign(source);
  return stella::Assemble(stella::ReadDatabase(database, options), source.path, options, notices);
}

void WriteStellaDatabase(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices& notices) {
  const stella::Outgoing map(atlas, target, options, notices);
  stella::WriteDatabase(map, target, options);
}

constexpr std::array<std::string_view, 1> kSuffixes = {".msg"};
constexpr std::array<std::string_view, 1> kDatabaseSuffixes = {".stella.db"};

}  // namespace

const Format kStellaFormat = {.id = "stella",
                              .title = "stella_vslam map (MessagePack)",
                              .suffixes = kSuffixes,
                              .kind = FileKind::kBinary,
                              .chooses_maps = true,
                              .reads = kHeld,
                              .writes = kHeld,
                              .sniff = SniffMessagePack,
                              .read = ReadStella,
                              .write = WriteStella};

const Format kStellaDatabaseFormat = {.id = "stella-sqlite",
                                      .title = "stella_vslam map database (SQLite)",
                                      .suffixes = kDatabaseSuffixes,
                                      .kind = FileKind::kBinary,
                                      .chooses_maps = true,
                                      .reads = kHeld,
                                      .writes = kHeld,
                                      .sniff = SniffDatabase,
                                      .read = ReadStellaDatabase,
                                      .write = WriteStellaDatabase};

}  // namespace slamdb::detail
