// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "slamdb/export.h"
#include "slamdb/formats/layouts/layout.h"

namespace slamdb {

struct SLAMDB_EXPORT InferOptions {
  // Of several layouts that fit, 1 being the one against which least speaks; InferredLayout::alternatives are the
  // others in their order.
  std::size_t choice = 1;
};

struct SLAMDB_EXPORT InferredLayout {
  Layout layout;
  bool known = false;                       // one of KnownLayouts()
  std::vector<std::string> differences;     // from v1.0: `KeyFrame: unknown1, 4 bytes, between mnId and mnFrameId`
  std::vector<std::string> alternatives;    // changes of layouts that fit as well
  std::vector<std::string> doubts;          // members that are unlike those of ORB-SLAM3, or mean what cannot be
  std::uint64_t keyframes = 0, points = 0;  // that were found
  bool same_bytes = false;                  // InferLayout: the file that was read in it was written again

  bool sure() const { return alternatives.empty() && doubts.empty(); }
};

}  // namespace slamdb
