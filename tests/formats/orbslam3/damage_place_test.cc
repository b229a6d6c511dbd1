// SPDX-License-Identifier: BSD-3-Clause
// What is said of a damaged file does not depend on how many threads read it.
#include <gtest/gtest.h>

#include <random>

#include "slamdb/base/error.h"
#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/model/digest.h"
#include "slamdb/synthetic/synthesize.h"

namespace slamdb {
namespace {

// The error; of what can be read, its hash.
std::string Told(const std::string& bytes, int threads) {
  Notices notices;
  ReadOptions options{.threads = threads};
  options.of<Orbslam3ReadOptions>().layout = "v1.0";
  try {
    return std::to_string(HashOf(ReadOrbslam3({std::as_bytes(std::span(bytes)), "damaged.osa"}, options, notices), 1));
  } catch (const Error& error) {
    return error.what();
  }
}

void ExpectToldAlike(const std::string& bytes, const std::string& how) {
  EXPECT_EQ(Told(bytes, 2), Told(bytes, 1)) << how;
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
  for (int i = 0; i < 150; ++i) {
    std::string damaged = whole;
    const std::size_t at = random() % whole.size();
    damaged[at] = " 9x-\0\xff"[random() % 6];
    ExpectToldAlike(damaged, "changed at " + std::to_string(at));
    ExpectToldAlike(whole.substr(0, at), "cut at " + std::to_string(at));
    ExpectToldAlike(whole.substr(0, at) + whole.substr(at + 1), "without " + std::to_string(at));
  }
}

INSTANTIATE_TEST_SUITE_P(Encodings, DamagePlace, testing::Bool(),
                         [](const auto& encoding) { return encoding.param ? "Text" : "Binary"; });

}  // namespace
}  // namespace slamdb
