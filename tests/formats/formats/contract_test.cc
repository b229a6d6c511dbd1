// SPDX-License-Identifier: BSD-3-Clause
// What every format promises, asked of every format.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <clocale>
#include <cstdlib>
#include <locale>
#include <set>

#include "slamdb/base/error.h"
#include "slamdb/formats/export/options.h"
#include "slamdb/formats/formats.h"
#include "tests/formats/formats/in_memory.h"
#include "tests/formats/formats/small_atlas.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string ProblemOf(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.problem();
  }
  return "";
}

std::string Written(const Format& format, const Atlas& atlas, WriteOptions options = {}) {
  const TemporaryFolder folder;
  Notices notices;
  options.sync = false;
  format.write(atlas, folder.Path("out"), ForAnyFormat(options), notices);
  return ReadFileOrFolder(folder.Path("out"));
}

const WriteOptions kAscii = WriteOptions{}.With(PointCloudOptions{.binary = false});

// LandmarkAtlas() with so many points, keyframes and landmarks that every format writes them in several blocks.
Atlas LongAtlas() {
  Atlas atlas = LandmarkAtlas();
  for (Map& map : atlas.maps) {
    map.landmarks.resize(3000, map.landmarks[0]);
    const MapPoint point = map.points[0];
    for (std::uint64_t i = 0; i < 20'000; ++i) {
      map.points.push_back(point);
      map.points.back().id = MapPointId(100'000 * (map.id.value() + 1) + i);
      map.points.back().position.x() = static_cast<float>(i) / 7;
    }
    const KeyFrame keyframe = map.keyframes[0];
    for (std::uint64_t i = 0; i < 600; ++i) {
      map.keyframes.push_back(keyframe);
      map.keyframes.back().id = KeyFrameId(1000 * (map.id.value() + 1) + i);
    }
  }
  return atlas;
}

// A comma for a point and a dot between thousands.
class CommaDecimal : public std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

class CommaDecimalLocale {
 public:
  CommaDecimalLocale() : before_(std::locale::global(std::locale(std::locale::classic(), new CommaDecimal))) {
    for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8"})
      if (std::setlocale(LC_ALL, name) != nullptr) break;
  }
  ~CommaDecimalLocale() {
    std::setlocale(LC_ALL, "C");
    std::locale::global(before_);
  }

 private:
  std::locale before_;
};

TEST(Formats, AreListedOnceWithTheirSuffixes) {
  std::set<std::string_view> ids;
  for (const Format& format : Formats()) {
    EXPECT_TRUE(ids.insert(format.id).second) << format.id;
    EXPECT_FALSE(format.title.empty()) << format.id;
    EXPECT_EQ(format.read != nullptr, format.reads != Content::kNothing) << format.id;
    EXPECT_EQ(format.write != nullptr, format.writes != Content::kNothing) << format.id;
    for (const std::string_view suffix : format.suffixes) {
      EXPECT_TRUE(suffix.starts_with('.')) << format.id;
      EXPECT_TRUE(std::none_of(suffix.begin(), suffix.end(), [](char c) { return c >= 'A' && c <= 'Z'; }));
    }
    EXPECT_EQ(&FormatById(format.id), &format);
  }
}

TEST(Formats, AreToldByTheLongestSuffix) {
  const auto id = [](const std::string& path) { return FormatOfOutput({path, ""}).id; };
  EXPECT_EQ(id("a.ply"), "ply");
  EXPECT_EQ(id("A.PLY"), "ply");
  EXPECT_EQ(id("a.csv"), "csv");
  EXPECT_EQ(id("a.euroc.csv"), "euroc");
  EXPECT_EQ(id("a.keyframes.csv"), "csv-keyframes");
  EXPECT_EQ(id("a.observations.csv"), "csv-observations");
  EXPECT_EQ(id("a.txt"), "tum");
  EXPECT_EQ(FormatOfOutput({"a.txt", ""}, "ply").id, "ply");
}

TEST(Formats, ThatAreUnknownAreAnsweredWithTheKnownOnes) {
  EXPECT_THAT(ProblemOf([] { FormatById("plyy"); }), HasSubstr("unknown format `plyy`; known are "));
  EXPECT_THAT(ProblemOf([] { FormatOfOutput({"a.xyzw", ""}); }), HasSubstr(".ply"));
  EXPECT_THAT(ProblemOf([] { FormatOfOutput({"-", ""}); }), HasSubstr("WriteOptions::format names it"));
  EXPECT_THAT(ProblemOf([] { FormatOfOutput({"a.ply", "office"}); }), HasSubstr("names one atlas of a store"));
}

class EveryFormat : public ::testing::TestWithParam<std::string> {
 protected:
  const Format& format() const { return FormatById(GetParam()); }
  bool is_store() const { return format().named; }  // updates files in place instead of replacing them
  bool is_stream() const { return !is_store() && !format().is_folder && !format().needs_path; }
};

TEST_P(EveryFormat, KnowsItsOwnFilesAndNoOthers) {
  const TemporaryFolder folder;
  Notices notices;
  format().write(LandmarkAtlas(), {folder.Path("out"), ""}, ForAnyFormat(), notices);
  const Probe probe = Probe::Of(folder.Path("out"));
  for (const Format& other : Formats())
    if (other.sniff != nullptr) {
      EXPECT_EQ(other.is_folder == probe.is_directory && other.sniff(probe), other.id == format().id) << other.id;
    }
}

TEST_P(EveryFormat, WritesAnEmptyAtlas) {
  const TemporaryFolder folder;
  Notices notices;
  format().write({}, {folder.Path("out"), ""}, ForAnyFormat(), notices);
  EXPECT_FALSE(notices.lossy());
  if (format().read == nullptr || ReadFileOrFolder(folder.Path("out")).empty())
    return;  // which no reader takes for an atlas
  const auto read = [&] { return format().read({folder.Path("out"), ""}, {}, notices); };
  // Where a cut file can look the same, the reader refuses it.
  constexpr std::array<std::string_view, 4> kRefused = {"tum", "euroc", "colmap", "colmap-text"};
  if (std::ranges::find(kRefused, format().id) != kRefused.end()) {
    EXPECT_THAT(ProblemOf(read), HasSubstr("holds no "));
    return;
  }
  const Atlas atlas = read();
  for (const Map& map : atlas.maps) EXPECT_TRUE(map.keyframes.empty() && map.points.empty());
}

TEST_P(EveryFormat, WritesToStandardOutput) {
  if (!is_stream()) GTEST_SKIP() << "a database or a folder is no stream";
  Notices notices;
  const std::string text = CaptureStandardOutput([&] {
    format().write(SmallAtlas(), {"-", ""}, ForAnyFormat(), notices);
  });
  EXPECT_EQ(text, Written(format(), SmallAtlas()));
}

TEST_P(EveryFormat, ReadsAndWritesMemory) {
  if (is_store()) {
    EXPECT_THAT(ProblemOf([&] { Encoded(format(), SmallAtlas(), ForAnyFormat()); }), HasSubstr("a store is a file"));
    EXPECT_THAT(ProblemOf([&] { Decoded(format(), "SQLite format 3"); }), HasSubstr("a store is a file"));
    return;
  }
  if (!is_stream()) {
    const auto written = [&] { WriteAtlas(SmallAtlas(), "-", ForAnyFormat({.format = std::string(format().id)})); };
    EXPECT_THAT(ProblemOf(written), HasSubstr("is one stream of bytes"));
    return;
  }
  const std::string bytes = Encoded(format(), LandmarkAtlas(), ForAnyFormat());
  EXPECT_EQ(bytes, Written(format(), LandmarkAtlas()));
  if (format().read == nullptr) return;
  const std::string again = Encoded(format(), Decoded(format(), bytes));
  EXPECT_TRUE(Encoded(format(), Decoded(format(), again)) == again);
  EXPECT_EQ(again == bytes, !TellsOfKeyFrames(format()));
}

TEST_P(EveryFormat, SaysWhetherItHasColorsAndAPlaceOnEarth) {
  if (is_store()) GTEST_SKIP() << "its bytes are never the same";
  const WriteOptions colored = WriteOptions{}.With(PointCloudOptions{.color = PointColor::kObservations});
  EXPECT_EQ(Written(format(), SmallAtlas(), colored) != Written(format(), SmallAtlas()), format().has_colors);
  const TemporaryFolder folder;
  Notices notices;
  const std::string nowhere = ProblemOf([&] { format().write(SmallAtlas(), folder.Path("out"), {}, notices); });
  EXPECT_EQ(nowhere.starts_with("places on earth need"), format().is_on_globe) << nowhere;
}

TEST_P(EveryFormat, OverwritesOnlyWhenTold) {
  if (is_store()) GTEST_SKIP() << "a store is added to";
  const TemporaryFolder folder;
  Notices notices;
  if (format().is_folder) {
    std::filesystem::create_directory(folder.Path("out"));
    folder.Make("out/mine", "mine");
  }
  const std::string path = format().is_folder ? folder.Path("out") : folder.Make("out", "mine");
  const std::string mine = ReadFileOrFolder(path);
  EXPECT_THAT(ProblemOf([&] {
                format().write(SmallAtlas(), {path, ""}, ForAnyFormat(), notices);
              }),
              HasSubstr("WriteOptions::overwrite replaces"));
  EXPECT_EQ(ReadFileOrFolder(path), mine);
  format().write(SmallAtlas(), {path, ""}, ForAnyFormat({.overwrite = true}), notices);
  if (format().is_folder) {
    EXPECT_EQ(ReadFile(path + "/mine"), "mine");
    std::filesystem::remove(path + "/mine");
  }
  EXPECT_EQ(ReadFileOrFolder(path), Written(format(), SmallAtlas()));
}

TEST_P(EveryFormat, LeavesNothingBehindWhenItFails) {
  const TemporaryFolder folder;
  Notices notices;
  EXPECT_NE(ProblemOf([&] {
              format().write(SmallAtlas(), {folder.Path("no/such/folder/out"), ""}, ForAnyFormat(), notices);
            }),
            "");
  if (is_store()) return;  // its transaction is undone, in a file that stays
  WriteOptions options = ForAnyFormat();
  options.progress = [](std::string_view, double) { throw Error(ErrorKind::kNotPossible, "stopped"); };
  try {
    format().write(SmallAtlas(), {folder.Path("out"), ""}, options, notices);
  } catch (const Error&) {
    EXPECT_THAT(folder.Names(), IsEmpty());
  }
}

TEST_P(EveryFormat, DoesNotDependOnThreads) {
  if (is_store()) GTEST_SKIP() << "a store records when it was written";
  const Atlas atlas = LongAtlas();
  const std::string alone = Written(format(), atlas, {.threads = 1});
  EXPECT_EQ(Written(format(), atlas, {.threads = 1}), alone);
  EXPECT_EQ(Written(format(), atlas, {.threads = 3}), alone);
}

TEST_P(EveryFormat, DoesNotDependOnTheLocale) {
  if (is_store()) GTEST_SKIP() << "a store records when it was written";
  const std::string text = Written(format(), SmallAtlas(), kAscii);
  const CommaDecimalLocale locale;
  EXPECT_EQ(Written(format(), SmallAtlas(), kAscii), text);
}

std::vector<std::string> WritableIds() {
  std::vector<std::string> ids;
  for (const Format& format : Formats())
    if (format.write != nullptr) ids.emplace_back(format.id);
  return ids;
}

std::string TestName(const ::testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Formats, EveryFormat, ::testing::ValuesIn(WritableIds()), TestName);

}  // namespace
}  // namespace slamdb
