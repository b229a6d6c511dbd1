// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/recognize.h"
#include "slamdb/formats/rtabmap/detail/assemble.h"
#include "slamdb/formats/rtabmap/detail/rtabmap.h"
#include "slamdb/formats/sqlite/detail/foreign.h"

namespace slamdb::detail {
namespace {

bool Sniff(const Probe& probe) {
  if (!IsSqlite(probe.head)) return false;
  const auto recognized = Recognize(probe);
  return recognized && recognized->id == "rtabmap";
}

Atlas Read(const Source& source, const ReadOptions& options, Notices& notices) {
  sqlite::Database database = sqlite::OpenForeign(source);
  return rtabmap::ReadAtlas(database, options, notices);
}

Atlas ReadTruth(const Source& source, const ReadOptions& options, Notices& notices) {
  sqlite::Database database = sqlite::OpenForeign(source);
  return rtabmap::ReadTruth(database, options, notices);
}

}  // namespace

const Format kRtabmapFormat = {.id = "rtabmap",
                               .title = "RTAB-Map database (SQLite)",
                               .suffixes = {},
                               .kind = FileKind::kBinary,
                               .reads = Content::kPoses | Content::kPoints | Content::kNormals |
                                        Content::kObservations | Content::kKeypoints | Content::kDescriptors |
                                        Content::kGraph | Content::kCameras | Content::kMaps | Content::kIdentity,
                               .sniff = Sniff,
                               .read = Read};

const Format kRtabmapTruthFormat = {.id = "rtabmap-truth",
                                    .title = "ground truth in an RTAB-Map database",
                                    .suffixes = {},
                                    .kind = FileKind::kBinary,
                                    .reads = Content::kPoses,
                                    .read = ReadTruth};

}  // namespace slamdb::detail
