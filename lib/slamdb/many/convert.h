// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "slamdb/base/notices.h"
#include "slamdb/edit/frame/georeference.h"
#include "slamdb/export.h"
#include "slamdb/formats/colmap/options.h"
#include "slamdb/formats/convert_report.h"
#include "slamdb/formats/format.h"
#include "slamdb/formats/location.h"

// An atlas from one format into another, with what goes with it.
namespace slamdb {

struct ConvertOptions {
  ReadOptions read;    // of the input
  WriteOptions write;  // `strict` refuses what the input loses on its way, too
  std::string onto;    // the atlas that the poses of the input are put into, which is what is written; empty: none
  ReadOptions read_onto;
  bool body = false;                  // trajectories are those of the IMU: written so, or read with `onto`
  bool sanitize = false;              // repair what ORB-SLAM3 refuses or crashes on
  std::optional<Georeference> where;  // on earth the maps are, for formats that ask for it; without maps: as asked for
  bool dry_run = false;               // write nothing, but say what would be
};

struct Converted {
  ConvertReport report;
  bool sound = true;  // false: `sanitize` has left errors, which are told
};

// Why the poses of the input cannot be put so; empty: they can, or are not to be.
[[nodiscard]] SLAMDB_EXPORT std::string WhyNotOnto(const HeldSource& input, const ConvertOptions& options);

// `name`: of the input, for messages. A trajectory becomes another one without passing through an atlas.
//
// Throws Error as ReadAtlas, WriteAtlas and PutPoses do; kNotPossible: the output would hold nothing of the atlas;
// kNotFound: nothing is in the part that was asked for; kUsage: `body` or `onto` make no sense here.
[[nodiscard]] SLAMDB_EXPORT Converted Convert(const HeldSource& input, const std::string& name, const Location& output,
                                              const ConvertOptions& options, Notices& notices);

// The same of an atlas in memory.
[[nodiscard]] SLAMDB_EXPORT Converted Convert(const Atlas& atlas, const Location& output, const ConvertOptions& options,
                                              Notices& notices);

// The picture files of a session: a folder of files named by their times, or a list.
//
// Throws Error as FindPictures does, and when it is not there.
[[nodiscard]] SLAMDB_EXPORT KeyFramePictures FindKeyFramePictures(const std::string& named);

// Where on earth the maps of the input are, for an output that asks for it: from `origin` on, or as TransformAtlas has
// found, which the command keeps beside the input. Nothing where nothing tells.
[[nodiscard]] SLAMDB_EXPORT std::optional<Georeference> WhereOnEarth(const std::string& origin,
                                                                     const std::string& input, const Format& output,
                                                                     Notices& notices);

}  // namespace slamdb
