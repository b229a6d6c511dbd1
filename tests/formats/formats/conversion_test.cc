// SPDX-License-Identifier: BSD-3-Clause
// From every format that can be read to every format that can be written.
#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "slamdb/formats/formats.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/formats/formats/in_memory.h"
#include "tests/formats/formats/small_atlas.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

// Everything that an atlas holds, as text, but for how its file was encoded: what is compared to tell that nothing is
// lost.
std::string Everything(Atlas atlas) {
  atlas.encoding = {};
  return EncodeAtlas(atlas, {.format = "ndjson"});
}

std::vector<double> Times(const Atlas& atlas) {
  std::vector<double> times;
  for (const Map& map : atlas.maps) {
    std::vector<double> of_map;
    for (const KeyFrame& keyframe : map.keyframes) of_map.push_back(keyframe.timestamp);
    std::sort(of_map.begin(), of_map.end());
    times.insert(times.end(), of_map.begin(), of_map.end());
  }
  return times;
}

// A file of MRPT 3 without landmarks is one of MRPT 2.
bool LooksLike(const Format& format, const Format& expected) {
  return format.id == expected.id || (expected.id == "mrpt3" && format.id == "mrpt");
}

Atlas ThroughFormat(const Atlas& atlas, const Format& format) {
  const TemporaryFolder folder;
  WriteAtlas(atlas, folder.Path("a"), {.format = std::string(format.id), .sync = false});
  EXPECT_TRUE(LooksLike(FormatOfInput(folder.Path("a")), format)) << format.id;
  return ReadAtlas(folder.Path("a"));
}

std::vector<std::string> Ids(bool both_ways) {
  std::vector<std::string> ids;
  for (const Format& format : Formats())
    if (format.write != nullptr && (format.read != nullptr || !both_ways)) ids.emplace_back(format.id);
  return ids;
}

class BothWays : public ::testing::TestWithParam<std::string> {};

TEST_P(BothWays, ReadsWhatItWrites) {
  const Format& format = FormatById(GetParam());
  const Atlas synthetic = SynthesizeAtlas(
      {.sensor = Sensor::kStereo, .inertial = true, .maps = 2, .keyframes = 8, .points = 300, .features = 300});
  for (const Atlas& atlas : {SmallAtlas(), LandmarkAtlas(), InertialAtlas(), synthetic}) {
    const Atlas back = ThroughFormat(atlas, format);
    if (HasAny(format.writes, Content::kPoses)) {
      EXPECT_EQ(Times(back), Times(atlas));
    }
    if (HasAny(format.writes, Content::kLandmarks)) {
      EXPECT_EQ(back.maps[0].landmarks.size(), atlas.maps[0].landmarks.size());
    }
    const Content all = atlas.maps[0].landmarks.empty() ? Content::kAtlas : Content::kEverything;
    if (!HasAll(format.reads & format.writes, all)) continue;
    EXPECT_EQ(Everything(back), Everything(atlas));
  }
}

using FromTo = std::tuple<std::string, std::string>;
class Conversion : public ::testing::TestWithParam<FromTo> {};

// Converting what was read gives what writing the original gives, as far as the first format holds it.
TEST_P(Conversion, GivesAFileOfThatFormat) {
  const auto& [from, to] = GetParam();
  const TemporaryFolder folder;
  const WriteOptions options = ForAnyFormat({.format = to, .sync = false});
  const Atlas atlas = ThroughFormat(SmallAtlas(), FormatById(from));
  WriteAtlas(atlas, folder.Path("b"), options);
  const Probe probe = Probe::Of(folder.Path("b"));
  const bool has_something = HasAny(FormatById(from).reads & FormatById(to).writes, ~Content::kMaps);
  EXPECT_TRUE(!has_something || FormatById(to).sniff == nullptr || FormatById(to).sniff(probe) ||
              (to == "mrpt3" && FormatById("mrpt").sniff(probe)));
  if (!HasAll(FormatById(from).reads, Content::kAtlas) || to == "store" || to == "ndjson") return;
  WriteAtlas(SmallAtlas(), folder.Path("c"), options);
  EXPECT_EQ(ReadFileOrFolder(folder.Path("b")), ReadFileOrFolder(folder.Path("c")));
}

std::string Name(std::string id) {
  std::replace(id.begin(), id.end(), '-', '_');
  return id;
}

INSTANTIATE_TEST_SUITE_P(Formats, BothWays, ::testing::ValuesIn(Ids(true)),
                         [](const auto& instance) { return Name(instance.param); });
INSTANTIATE_TEST_SUITE_P(Formats, Conversion,
                         ::testing::Combine(::testing::ValuesIn(Ids(true)), ::testing::ValuesIn(Ids(false))),
                         [](const auto& instance) {
                           return Name(std::get<0>(instance.param)) + "_to_" + Name(std::get<1>(instance.param));
                         });

}  // namespace
}  // namespace slamdb
