// SPDX-License-Identifier: BSD-3-Clause
// What is said of a damaged file does not depend on how many threads read it.
#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <random>
#include <utility>

#include "slamdb/base/error.h"
#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/model/digest.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

// The error; of what can be read, its hash.
std::string Told(const Source& source, int threads) {
  Notices notices;
  ReadOptions options{.threads = threads};
  options.of<Orbslam3ReadOptions>().layout = "v1.0";
  try {
    return std::to_string(HashOf(ReadOrbslam3(source, options, notices), 1));
  } catch (const Error& error) {
    return error.what();
  }
}

void ExpectToldAlike(const std::string& bytes, const std::string& how) {
  const Source source(std::as_bytes(std::span(bytes)), "damaged.osa");
  EXPECT_EQ(Told(source, 2), Told(source, 1)) << how;
}

class DamagePlace : public testing::TestWithParam<bool> {
 protected:
  // Large enough for a second thread.
  std::string Whole() const {
    Atlas atlas = SynthesizeAtlas({.keyframes = 8, .points = 2000, .features = 1200});
    atlas.encoding.text = GetParam();
    return EncodeOrbslam3(atlas);
  }
};

TEST_P(DamagePlace, IsTheSameWhereverItIs) {
  const std::string whole = Whole();
  ASSERT_GT(whole.size(), std::size_t{1} << 20);
  std::mt19937 random(1);
  for (int i = 0; i < 40; ++i) {
    std::string damaged = whole;
    const std::size_t at = random() % whole.size();
    damaged[at] = " 9x-\0\xff"[random() % 6];
    ExpectToldAlike(damaged, "changed at " + std::to_string(at));
    ExpectToldAlike(whole.substr(0, at), "cut at " + std::to_string(at));
    ExpectToldAlike(whole.substr(0, at) + whole.substr(at + 1), "without " + std::to_string(at));
  }
}

// Of a file, what has not been read yet cannot be looked at.
TEST_P(DamagePlace, LongStretchesOfAFileAreNoTokens) {
  const std::string whole = Whole();
  const TemporaryFolder folder;
  const std::string path = folder.Path("damaged.osa");
  for (const char filler : {'\0', '7'}) {
    for (std::size_t bytes = 100'000; bytes < whole.size(); bytes *= 2) {
      for (std::size_t at = 10'000; at + bytes < whole.size(); at += whole.size() / 5) {
        std::string damaged = whole;
        std::fill_n(damaged.begin() + static_cast<std::ptrdiff_t>(at), bytes, filler);
        std::ofstream(path, std::ios::binary | std::ios::trunc) << damaged;
        EXPECT_THAT(Told(path, 2), testing::HasSubstr("damaged.osa: byte ")) << bytes << " bytes at " << at;
      }
    }
  }
}

// A file that is being written is truncated, whatever it has become when it is read once more.
TEST_P(DamagePlace, AFileThatGrowsIsNotReadInAnotherWay) {
  const std::string whole = Whole();
  const TemporaryFolder folder;
  const std::string path = folder.Path("growing.osa");
  const std::size_t first = whole.size() - 200'000;
  for (const int threads : {1, 2}) {
    std::ofstream(path, std::ios::binary | std::ios::trunc) << whole.substr(0, first);
    bool grown = false;
    ReadOptions options{.threads = threads};
    options.of<Orbslam3ReadOptions>().layout = "v1.0";
    options.progress = [&](std::string_view, double) {
      if (!std::exchange(grown, true)) std::ofstream(path, std::ios::binary | std::ios::app) << whole.substr(first);
    };
    Notices notices;
    const Error error = ErrorOf([&] { static_cast<void>(ReadOrbslam3(path, options, notices)); });
    EXPECT_THAT(error.what(), testing::HasSubstr("truncated"));
  }
}

INSTANTIATE_TEST_SUITE_P(Encodings, DamagePlace, testing::Bool(),
                         [](const auto& encoding) { return encoding.param ? "Text" : "Binary"; });

}  // namespace
}  // namespace slamdb
