// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/export.h"

namespace slamdb {
struct VocabularyTree;
}

namespace slamdb::live {

class KeyFrame;

// The vocabulary that KeyFrame::ComputeBoW uses.
using ORBVocabulary = slamdb::VocabularyTree;

// What place recognition looks keyframes up in, with the names of ORB-SLAM3's class. The client derives its own from
// it: the live map only says which keyframes come and go.
class SLAMDB_EXPORT KeyFrameDatabase {
 public:
  virtual ~KeyFrameDatabase() = default;

  // A keyframe that Map::PostLoad found.
  virtual void add(KeyFrame* pKF) = 0;

  // A keyframe that goes bad. Called inside a Change and under no other lock of the live map.
  virtual void erase(KeyFrame* pKF) = 0;
};

}  // namespace slamdb::live
