// SPDX-License-Identifier: BSD-3-Clause
// Real files cut at every kilobyte, and stores cut at every page: an error that says so, or all that was saved.
#include <gmock/gmock.h>

#include <filesystem>

#include "slamdb/base/error.h"
#include "slamdb/checks/check.h"
#include "slamdb/edit/repair/recover.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/salvage.h"
#include "slamdb/model/digest.h"
#include "tests/formats/orbslam3/real_atlases.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

constexpr std::size_t kKilobyte = 1024;

ReadOptions OneThread() {
  ReadOptions options;
  options.threads = 1;
  return options;
}

std::string RealFile() { return ReadWhole(RealAtlas("session_small_a")); }

TEST(CutAtEveryKilobyte, AnAtlasIsDamagedWhereItEnds) {
  const std::string whole = RealFile();
  for (std::size_t cut = kKilobyte; cut < whole.size(); cut += kKilobyte) {
    try {
      const Atlas atlas = DecodeAtlas(std::string_view(whole).substr(0, cut), OneThread());
      ADD_FAILURE() << "cut at byte " << cut << " is read";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kDamaged) << cut << ": " << error.what();
      EXPECT_FALSE(error.place().empty()) << cut << ": " << error.what();
    }
  }
}

// Every sixteenth, as each takes as long as a read, a check and a repair.
TEST(CutAtEveryKilobyte, WhatIsRecoveredIsSoundOrNothingIsWhole) {
  const std::string whole = RealFile();
  std::uint64_t keyframes = 0;
  for (std::size_t cut = kKilobyte; cut < whole.size(); cut += 16 * kKilobyte) {
    SCOPED_TRACE(cut);
    try {
      Salvage salvage = SalvageBytes(std::as_bytes(std::span(whole)).first(cut), OneThread());
      RecoverSalvage(salvage, {.threads = 1});
      CheckOptions check;
      check.ignore = {"atlas-not-empty"};  // keyframes of which all points were behind the cut
      check.threads = 1;
      EXPECT_TRUE(CheckAtlas(salvage.atlas, check).ok());
      std::uint64_t now = 0;
      for (const Map& map : salvage.atlas.maps) now += map.keyframes.size();
      EXPECT_GE(now, keyframes) << "a longer file gives no less";
      keyframes = now;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kDamaged) << error.what();
      EXPECT_EQ(keyframes, 0u);
    }
  }
  EXPECT_EQ(keyframes, 14u);
}

TEST(CutAtEveryPage, AStoreIsRefusedOrWhole) {
  const TemporaryFolder folder;
  const Atlas atlas = DecodeAtlas(RealFile(), OneThread());
  WriteAtlas(atlas, folder / "whole.db#a");
  const std::string whole = ReadFile(folder / "whole.db");
  constexpr std::size_t kPage = 8192;
  for (std::size_t cut = kPage; cut < whole.size(); cut += kPage) {
    folder.Make("cut.db", std::string_view(whole).substr(0, cut));
    try {
      EXPECT_EQ(HashOf(ReadAtlas(folder / "cut.db#a", OneThread()), 1), HashOf(atlas, 1)) << cut;
    } catch (const Error& error) {
      EXPECT_THAT(error.kind(), ::testing::AnyOf(ErrorKind::kDamaged, ErrorKind::kUnsupported)) << error.what();
    }
  }
}

}  // namespace
}  // namespace slamdb
