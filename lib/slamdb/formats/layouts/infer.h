// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/file.h"
#include "slamdb/export.h"
#include "slamdb/formats/layouts/layout.h"
#include "slamdb/model/atlas.h"

namespace slamdb {

struct SLAMDB_EXPORT InferOptions {
  // Of several layouts that fit, 1 being the one against which least speaks; InferredLayout::alternatives are the
  // others in their order.
  std::size_t choice = 1;
};

struct SLAMDB_EXPORT InferredLayout {
  Layout layout;
  bool known = false;                     // one of KnownLayouts()
  std::vector<std::string> differences;   // from the known layout that it is most like: `KeyFrame: 4 bytes behind mnId`
  std::vector<std::string> alternatives;  // changes of layouts that fit as well
  std::vector<std::string> doubts;        // members whose values are unlike those of ORB-SLAM3
  std::uint64_t keyframes = 0, points = 0;  // that were found
  bool same_bytes = false;                  // InferLayout: the file that was read in it was written again

  bool sure() const { return alternatives.empty() && doubts.empty(); }
};

// Finds the layout of an atlas file: a known one, when it comes to the last byte and what it reads is like what
// ORB-SLAM3 writes; or else the smallest change of one, members more or less in KeyFrame, MapPoint, Map and Atlas.
// Members that are new are called unknown1, unknown2, ..., with a type that has their bytes. Of several places that fit
// as well, the one counts against which least speaks, in a sound file few points being bad, replaced or unseen; then
// the last one.
//
// `encoding`: of a binary archive; `begin`: behind its header. Where longs have 4 bytes, of known layouts alone.
// Tries are bounded: seconds. Deterministic. Thread-safe.
// Throws Error: kNotPossible when no layout was found, saying how far it came; kUsage for a choice that is not there.
// InferLayout in orbslam3/infer_layout.h takes files.
[[nodiscard]] SLAMDB_EXPORT InferredLayout InferLayoutOf(Bytes archive, const ArchiveEncoding& encoding,
                                                         std::uint64_t begin, const InferOptions& options = {});

}  // namespace slamdb
