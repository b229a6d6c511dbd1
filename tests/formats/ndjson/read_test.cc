// SPDX-License-Identifier: BSD-3-Clause
// What ndjson is read back as: files of slamdb's, of scripts, and wrong ones.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "slamdb/base/error.h"
#include "slamdb/formats/ndjson/detail/json_scanner.h"
#include "slamdb/formats/ndjson/detail/ndjson.h"
#include "slamdb/model/digest.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/formats/formats/in_memory.h"
#include "tests/formats/formats/small_atlas.h"
#include "tests/support/equals_atlas.h"

namespace slamdb {
namespace {

using ::testing::AnyOf;
using ::testing::ContainsRegex;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string Text(const Atlas& atlas) { return Encoded(detail::kNdjsonFormat, atlas); }
Atlas Read(std::string_view text, const ReadOptions& options = {}) {
  return Decoded(detail::kNdjsonFormat, text, options);
}

// `text` with the first `from` behind `behind` made `to`.
std::string Replaced(std::string text, std::string_view from, std::string_view to, std::string_view behind = {}) {
  const std::size_t begin = text.find(from, text.find(behind));
  if (begin == std::string::npos) throw Error(ErrorKind::kInternal, "the test replaces what is not there");
  return text.replace(begin, from.size(), to);
}

Error ErrorOf(const std::string& text) {
  try {
    (void)Read(text);
  } catch (const Error& error) {
    return error;
  }
  return {ErrorKind::kInternal, "was read"};
}

TEST(NdjsonReader, ReadsWhatIsWritten) {
  const Atlas synthetic =
      SynthesizeAtlas({.sensor = Sensor::kFisheyeStereo, .inertial = true, .maps = 2, .keyframes = 8, .points = 300});
  for (const Atlas& atlas : {SmallAtlas(), LandmarkAtlas(), InertialAtlas(), synthetic}) {
    const Atlas back = Read(Text(atlas));
    EXPECT_THAT(back, EqualsAtlas(atlas));
    EXPECT_EQ(HashOf(back), HashOf(atlas));
    EXPECT_EQ(back.encoding, atlas.encoding);
  }
}

TEST(NdjsonReader, ReadsWhatJsonHasNoWordFor) {
  Atlas atlas = OneMapAtlas();
  MapPoint& point = atlas.maps[0].points[0];
  point.position = {std::nanf(""), HUGE_VALF, -HUGE_VALF};
  point.normal = {std::numeric_limits<float>::denorm_min(), -std::numeric_limits<float>::max(), -0.0F};
  point.id = MapPointId(18446744073709551614U);
  point.first_keyframe = -1;
  point.bad.recorded = 7;
  point.observations[0].right = Observation::kAbsent;
  atlas.vocabulary.name = "a\"b\\c\n\xc3\xa4";
  const Atlas back = Read(Text(atlas));
  EXPECT_EQ(HashOf(back), HashOf(atlas));
  EXPECT_EQ(back.vocabulary.name, atlas.vocabulary.name);
}

Boxed<Carried> SomethingCarried(std::size_t bytes, std::int32_t rows) {
  Boxed<Carried> carried;
  for (std::size_t i = 0; i < bytes; ++i) carried.Make().members.push_back(static_cast<std::byte>(37 * i));
  Matrix& descriptors = carried.Make().descriptors;
  descriptors.rows = rows;
  descriptors.columns = 256;
  descriptors.type = 5;  // CV_32F, as SuperPoint's
  descriptors.continuous = true;
  for (std::int32_t i = 0; i < rows * 256; ++i) {
    const auto value = static_cast<float>(i) / 7;
    const auto bytes_of = std::as_bytes(std::span(&value, 1));
    descriptors.data.insert(descriptors.data.end(), bytes_of.begin(), bytes_of.end());
  }
  return carried;
}

// What forks have and the model does not know, in every kind of entity, and descriptors of floats.
TEST(NdjsonReader, ReadsWhatForksCarry) {
  Atlas atlas = OneMapAtlas();
  atlas.layout = "some-fork";
  atlas.carried = SomethingCarried(5, 0);
  atlas.carried.Make().descriptors = {};
  atlas.cameras[0].carried = SomethingCarried(1, 0);
  atlas.maps[0].carried = SomethingCarried(300, 0);
  atlas.maps[0].keyframes[1].carried = SomethingCarried(17, 3);
  atlas.maps[0].points[0].carried = SomethingCarried(0, 1);
  atlas.maps[0].points[2].carried.Make();  // nothing in it, which is not the same as none
  const Atlas back = Read(Text(atlas));
  EXPECT_EQ(HashOf(back), HashOf(atlas));
  EXPECT_EQ(back.layout, atlas.layout);
  EXPECT_EQ(back.maps[0].keyframes[1].carried, atlas.maps[0].keyframes[1].carried);
  EXPECT_EQ(back.maps[0].points[2].carried, atlas.maps[0].points[2].carried);
  const std::string text = Text(atlas);
  const Error error = ErrorOf(Replaced(text, "\"columns\":256", "\"columns\":255", "\"rows\":3"));
  EXPECT_EQ(error.place(), "line 5: carried.descriptors");
  EXPECT_THAT(error.problem(), HasSubstr("a matrix of 3 x 255, type 5, does not have 3072 bytes"));
}

TEST(NdjsonReader, TakesBlanksEmptyLinesAndMembersInAnyOrder) {
  const std::string text =
      "\xef\xbb\xbf\r\n { \"encoding\" : {\"long_bytes\": 4}, \"vocabulary\": {\"name\":\"\\u00e4\"},\"type\" : "
      "\"atlas\"}\r\n"
      "\n"
      "{\"id\": 3, \"parameters\": [ 1, 2e0, 3.5 , 4 ], \"type\":\"camera\", \"model\":\"pinhole\"}\n"
      "{\"id\":7,\"type\":\"map\"}";
  const Atlas atlas = Read(text);
  EXPECT_EQ(atlas.vocabulary.name, "\xc3\xa4");
  EXPECT_EQ(atlas.encoding.long_bytes, 4);
  ASSERT_EQ(atlas.cameras.size(), 1U);
  EXPECT_THAT(atlas.cameras[0].parameters, ElementsAre(1, 2, 3.5F, 4));
  ASSERT_EQ(atlas.maps.size(), 1U);
  EXPECT_EQ(atlas.maps[0].id, MapId(7));
}

TEST(NdjsonReader, IsChosenByTheTypeOfTheFirstLineWhereverItStands) {
  const auto sniffs = [](const std::string& head) { return detail::kNdjsonFormat.sniff({.path = "", .head = head}); };
  EXPECT_TRUE(sniffs("{\"type\":\"atlas\"}"));
  EXPECT_TRUE(sniffs("\n{ \"cameras\" : [], \"type\" : \"atlas\" }\n"));
  EXPECT_FALSE(sniffs("{\"type\":\"map\"}\n{\"type\":\"atlas\"}"));
  EXPECT_FALSE(sniffs("{\"type\":\"atlases\"}"));
  EXPECT_FALSE(sniffs("type,atlas"));
}

// A map that a script made: what it left out is derived, or has a value that follows.
TEST(NdjsonReader, FillsInWhatAScriptLeavesOut) {
  const Atlas atlas = Read(
      "{\"type\":\"atlas\"}\n"
      "{\"type\":\"camera\",\"id\":0,\"model\":\"kannala_brandt_8\",\"parameters\":[100,101,64,48,0,0,0,0]}\n"
      "{\"type\":\"map\",\"id\":2}\n"
      "{\"type\":\"keyframe\",\"id\":5,\"timestamp\":1.5,\"camera\":0,\"camera_from_world\":"
      "{\"rotation_xyzw\":[0,0,0,1],\"translation\":[0,0,1]},\"distortion\":{\"values\":[0.5,0,0,0]},"
      "\"features\":{\"keypoints\":{\"x\":[10,20],\"y\":[30,40]},\"map_points\":[9,null]},"
      "\"intrinsics\":{\"fx\":99}}\n"
      "{\"type\":\"map_point\",\"id\":9,\"position\":[1,2,3]}\n"
      "{\"type\":\"landmark\",\"mean\":[1,2,3]}\n");
  EXPECT_EQ(atlas.cameras[0].recorded_type, 1U);
  const KeyFrame& keyframe = atlas.maps[0].keyframes[0];
  EXPECT_EQ(keyframe.intrinsics.fx, 99);
  EXPECT_EQ(keyframe.intrinsics.fy, 101);
  EXPECT_EQ(keyframe.intrinsics.cx, 64);
  EXPECT_EQ(keyframe.origin_map, 2U);
  EXPECT_EQ(keyframe.distortion.rows, 4);
  EXPECT_EQ(keyframe.distortion.columns, 1);
  EXPECT_EQ(keyframe.distortion.type, 5);
  EXPECT_EQ(keyframe.features.keypoints[1].size, 31);
  EXPECT_EQ(keyframe.features.keypoints[1].y, 40);
  EXPECT_EQ(keyframe.features.descriptors_form, MatrixForm::kEmpty);
  EXPECT_EQ(keyframe.features.undistorted.size(), 2U);
  EXPECT_EQ(keyframe.features.count, 2);
  EXPECT_EQ(keyframe.pyramid.levels, 8);
  const MapPoint& point = atlas.maps[0].points[0];
  EXPECT_FALSE(point.has_descriptor());
  EXPECT_THAT(point.observations, ElementsAre(Observation{KeyFrameId(5), 0, -1}));
  EXPECT_EQ(point.reference, KeyFrameId(5));
  EXPECT_EQ(atlas.maps[0].lowest_keyframe, KeyFrameId(5));
  EXPECT_EQ(atlas.next_ids.keyframe, 6U);
  EXPECT_GE(atlas.next_ids.map_point, 10U);
  EXPECT_FALSE(atlas.maps[0].landmarks[0].id);
}

// What a line has stays as it is, also where it is empty and could be derived.
TEST(NdjsonReader, LeavesAloneWhatIsThere) {
  Atlas atlas = SynthesizeAtlas({.keyframes = 4, .points = 60, .features = 100});
  atlas.maps[0].keyframes[0].connections.clear();
  atlas.maps[0].points[0].normal.setZero();
  const std::string text = Text(atlas);
  const std::size_t begin = text.find("\"next_ids\"");  // what is missing, so that something is derived
  Atlas read = Read(text.substr(0, begin) + text.substr(text.find("\"encoding\"")));
  EXPECT_EQ(read.next_ids.keyframe, 4U);
  read.next_ids = atlas.next_ids;
  EXPECT_EQ(HashOf(read), HashOf(atlas));
}

// A point of which the observations are left out, among others that have theirs.
TEST(NdjsonReader, DerivesWhatSomeLinesLack) {
  const Atlas atlas = SynthesizeAtlas({.keyframes = 4, .points = 60, .features = 100});
  std::string text = Text(atlas);
  const std::size_t point = text.find("{\"type\":\"map_point\"");
  for (const std::string name : {"\"observations\"", "\"observation_count\""}) {
    const std::size_t begin = text.find(name, point);
    text.erase(begin,
               text.find(name == "\"observations\"" ? ']' : ',', begin) + (name == "\"observations\"" ? 2 : 1) - begin);
  }
  const Atlas read = Read(text);
  EXPECT_EQ(read.maps[0].points[0].observations, atlas.maps[0].points[0].observations);
  EXPECT_EQ(HashOf(read), HashOf(atlas));
}

TEST(NdjsonReader, ReadsAPartOfIt) {
  ReadOptions options;
  options.selection.map = MapId(1);
  EXPECT_EQ(Read(Text(SmallAtlas()), options).maps.size(), 1U);
  options = {};
  options.selection.first_keyframe = options.selection.last_keyframe = 3;
  const Atlas atlas = Read(Text(OneMapAtlas()), options);
  ASSERT_EQ(atlas.maps[0].keyframes.size(), 1U);
  EXPECT_EQ(atlas.maps[0].keyframes[0].id, KeyFrameId(3));
}

TEST(NdjsonReader, LinesThatAreMissingAreALoss) {
  const auto notices_of = [](const std::string& text) {
    Notices notices;
    (void)detail::kNdjsonFormat.read({std::as_bytes(std::span(text)), "x"}, {}, notices);
    std::string all;
    for (const Notice& notice : notices.items())
      if (notice.kind == Notice::Kind::kLoss) all += notice.text + "\n";
    return all;
  };
  const std::string text = Text(SmallAtlas());
  EXPECT_EQ(notices_of(text), "");
  EXPECT_THAT(notices_of(text.substr(0, text.rfind("{\"type\":\"map_point\""))),
              ContainsRegex("line [0-9]+, of a map, counts 1 map point, but 0 follow"));
  EXPECT_THAT(notices_of(text.substr(0, text.rfind("{\"type\":\"map\""))),
              HasSubstr("the first line lists 2 maps, but lines of 1 follow"));
  // Of every file that ends with any of its lines but the last; one more line is no loss.
  for (std::size_t end = text.find('\n'); end + 1 < text.size(); end = text.find('\n', end + 1))
    EXPECT_NE(notices_of(text.substr(0, end + 1)), "") << end;
  EXPECT_EQ(notices_of(text + text.substr(text.rfind("{\"type\":\"map_point\""))), "");
}

TEST(NdjsonReader, DoesNotDependOnThreads) {
  const Atlas atlas = SynthesizeAtlas({.keyframes = 30, .points = 1000, .features = 300});
  const std::string text = Text(atlas);
  for (const int threads : {1, 3}) EXPECT_EQ(HashOf(Read(text, {.threads = threads})), HashOf(atlas));
  // Of two wrong lines the first is told.
  std::string wrong = text;
  wrong[wrong.rfind("\"position\":[") + 12] = 'x';
  wrong = Replaced(wrong, "\"timestamp\":", "\"timestamp\":y", "\"type\":\"keyframe\"");
  for (const int threads : {1, 3}) {
    try {
      (void)Read(wrong, {.threads = threads});
      FAIL() << "was read";
    } catch (const Error& error) {
      EXPECT_THAT(error.place(), HasSubstr("timestamp"));
    }
  }
}

// ---- wrong files

struct Wrong {
  std::string_view name, from, to, behind, place, problem;
  friend void PrintTo(const Wrong& wrong, std::ostream* out) { *out << wrong.name; }
};

class NdjsonErrors : public ::testing::TestWithParam<Wrong> {};

TEST_P(NdjsonErrors, SayLineAndPath) {
  const auto& [name, from, to, behind, place, problem] = GetParam();
  const Error error = ErrorOf(Replaced(Text(OneMapAtlas()), from, to, behind));
  EXPECT_EQ(error.kind(), ErrorKind::kDamaged) << error.what();
  EXPECT_EQ(error.place(), place) << error.what();
  EXPECT_THAT(error.problem(), HasSubstr(problem));
}

// Lines: 1 atlas, 2 camera, 3 map, 4 and 5 keyframes, 6 to 8 map points.
constexpr Wrong kWrong[] = {
    {"Number", "\"x\":[17", "\"x\":[no", "\"keypoints\"", "line 4: features.keypoints.x[0]",
     "expected a number, found `no]"},
    {"LeadingZero", "\"x\":[17", "\"x\":[017", "\"keypoints\"", "line 4: features.keypoints.x[0]",
     "expected a number without zeros in front"},
    {"TooLarge", "\"x\":[17", "\"x\":[1e39", "\"keypoints\"", "line 4: features.keypoints.x[0]", "32-bit floats"},
    {"NumberAsText", "\"x\":[17", "\"x\":[\"17\"", "\"keypoints\"", "line 4: features.keypoints.x[0]",
     "expected a number"},
    {"Whole", "\"octave\":[1", "\"octave\":[1.5", "", "line 4: features.keypoints.octave[0]",
     "expected a whole number"},
    {"WholeTooLarge", "\"octave\":[1", "\"octave\":[2147483648", "", "line 4: features.keypoints.octave[0]",
     "from -2147483648 to 2147483647"},
    {"Unsigned", "\"frame_id\":", "\"frame_id\":-", "", "line 4: frame_id", "expected a whole number from 0"},
    {"Id", "\"id\":10", "\"id\":18446744073709551615", "", "line 6: id", "is no id"},
    {"IdAsText", "\"id\":10", "\"id\":\"10\"", "", "line 6: id", "expected a number"},
    {"Flag", "\"bad\":false", "\"bad\":\"no\"", "\"type\":\"map_point\"", "line 6: bad", "expected a number"},
    {"Bool", "\"text\":false", "\"text\":0", "", "line 1: encoding.text", "expected true or false"},
    {"UnknownMember", "\"frame_id\":", "\"frameid\":", "", "line 4: frameid", "there is no such member"},
    {"UnknownInner", "\"count\":", "\"counts\":", "\"features\"", "line 4: features.counts", "there is no such member"},
    {"UnknownOfObservation", "\"left\":0", "\"lefty\":0", "\"type\":\"map_point\"", "line 6: observations[0].lefty",
     "there is no such member"},
    {"Twice", "\"frame_id\":", "\"frame_id\":1,\"frame_id\":", "", "line 4: frame_id", "stands there twice"},
    {"ObjectTwice", "\"features\":", "\"features\":{},\"features\":", "", "line 4: features", "stands there twice"},
    {"Missing", "\"timestamp\":1.5,", "", "", "line 4", "the member `timestamp` is missing"},
    {"MissingInner", "\"keyframe\":1,\"weight\":1", "\"keyframe\":1", "\"connections\"", "line 4: connections[0]",
     "the member `weight` is missing"},
    {"TooFew", "\"position\":[0,0,2]", "\"position\":[0,0]", "", "line 6: position", "expected 3 elements, found 2"},
    {"TooMany", "\"position\":[0,0,2]", "\"position\":[0,0,2,3]", "", "line 6: position[3]", "more elements than 3"},
    {"ColumnsDiffer", "\"y\":[52]", "\"y\":[]", "\"keypoints\"", "line 4: features.keypoints.y",
     "expected 1 elements, as the column before has, found 0"},
    {"ColumnsDifferMore", "\"y\":[52]", "\"y\":[52,53]", "\"keypoints\"", "line 4: features.keypoints.y[1]",
     "more elements than the column before"},
    {"Hex", "\"03ab", "\"03xb", "", "line 4: features.descriptors[0]", "is not 64 hex digits"},
    {"HexLength", "\"03ab", "\"ab", "", "line 4: features.descriptors[0]", "is not 64 hex digits"},
    {"Enumerator", "\"usual\"", "\"unusual\"", "", "line 4: features.descriptors_form", "is none of usual,"},
    {"Model", "\"pinhole\"", "\"fisheye\"", "", "line 2: model", "is none of pinhole, kannala_brandt_8"},
    {"ObjectForArray", "\"position\":[0,0,2]", "\"position\":{}", "", "line 6: position", "expected an array"},
    {"ArrayForObject", "\"features\":", "\"features\":[],\"x\":", "", "line 4: features", "expected an object"},
    {"Type", "\"map_point\"", "\"mappoint\"", "\"type\":\"map_point\"", "line 6: type", "is none of atlas, camera"},
    {"NoType", "\"type\":\"map_point\",", "", "", "line 6", "the member `type` is missing"},
    {"OtherMap", "\"map\":0", "\"map\":1", "\"type\":\"map_point\"", "line 6: map",
     "is not the id of the map above, 0"},
    {"Behind", "\"max_distance\":4}", "\"max_distance\":4}}", "", "line 6", "expected the end of the line"},
    {"Comma", "\"max_distance\":4}", "\"max_distance\":4", "", "line 6",
     "expected `,` or `}`, found the end of the line"},
    {"String", "\"ORBvoc.txt\"", "\"ORBvoc\\x.txt\"", "", "line 1: vocabulary.name", "is no string of JSON"},
    {"Utf8", "\"ORBvoc.txt\"", "\"ORBvoc\xff\"", "", "line 1: vocabulary.name", "is no string of JSON"},
    {"Encoding", "\"long_bytes\":8", "\"long_bytes\":7", "", "line 1", "encoding: long_bytes"},
    {"Grid", "\"cell_sizes\":[]", "\"cell_sizes\":[7]", "", "line 4", "features.grid: column_sizes add up to"},
    {"Words", "\"words\":[]", "\"words\":[7]", "", "line 4", "features.bag_of_words: "},
    {"Nodes", "\"nodes\":[]", "\"nodes\":[7]", "", "line 4", "features.feature_vector: "},
    {"Form", "\"usual\"", "\"empty\"", "", "line 4", "features.descriptors_form: is empty"},
    {"Matrix", "\"distortion\":{", "\"distortion\":{\"values\":[1],\"x\":{", "", "line 4: distortion.x",
     "no such member"},
    {"Repeated", "\"repeated_maps\":[]", "\"repeated_maps\":[{\"position\":9,\"owner_map\":0,\"row\":1}]", "",
     "repeated_maps[0]", "is no entry of the list"},
};

INSTANTIATE_TEST_SUITE_P(Ndjson, NdjsonErrors, ::testing::ValuesIn(kWrong),
                         [](const auto& instance) { return std::string(instance.param.name); });

TEST(NdjsonReader, RefusesLinesInAnotherOrder) {
  const std::string atlas = "{\"type\":\"atlas\"}\n", map = "{\"type\":\"map\",\"id\":0}\n";
  const std::string camera = "{\"type\":\"camera\",\"id\":0,\"model\":\"pinhole\",\"parameters\":[]}\n";
  const std::string point = "{\"type\":\"map_point\",\"id\":0,\"position\":[0,0,0]}\n";
  const std::string keyframe =
      "{\"type\":\"keyframe\",\"id\":0,\"timestamp\":0,\"camera_from_world\":{\"rotation_xyzw\":[0,0,0,1],"
      "\"translation\":[0,0,0]}}\n";
  EXPECT_NO_THROW((void)Read(atlas + camera + map + keyframe + point + map + keyframe + point));
  EXPECT_THAT(ErrorOf(map).what(), HasSubstr("line 1: a line of type map in the wrong place: the first line is to be"));
  EXPECT_THAT(ErrorOf(atlas + atlas).what(), HasSubstr("line 2: a line of type atlas"));
  EXPECT_THAT(ErrorOf(atlas + keyframe).what(), HasSubstr("no map is before it"));
  EXPECT_THAT(ErrorOf(atlas + map + camera).what(), HasSubstr("stands behind a map"));
  EXPECT_THAT(ErrorOf(atlas + map + point + keyframe).what(), HasSubstr("stands behind a map_point"));
  EXPECT_THAT(ErrorOf("\n \n").what(), HasSubstr("has no lines"));
}

TEST(NdjsonReader, IsCutOffInALine) {
  const std::string text = Text(OneMapAtlas());
  for (std::size_t size = 1; size + 1 < text.size(); ++size) {
    if (text[size] == '\n' || text[size - 1] == '\n') continue;
    EXPECT_EQ(ErrorOf(text.substr(0, size)).kind(), ErrorKind::kDamaged) << size;
  }
}

// Depth costs no stack, and what is short no memory.
TEST(NdjsonReader, BearsHostileLines) {
  const std::string deep(1 << 20, '[');
  EXPECT_EQ(ErrorOf("{\"x\":" + deep).kind(), ErrorKind::kDamaged);
  EXPECT_EQ(ErrorOf("{\"type\":\"atlas\"}\n{\"type\":\"map\",\"id\":" + deep).kind(), ErrorKind::kDamaged);
  std::string keyframes = "{\"type\":\"atlas\"}\n{\"type\":\"map\",\"id\":0}\n";
  for (int i = 0; i < 100'000; ++i) keyframes += "{\"type\":\"keyframe\"}\n";
  EXPECT_THAT(ErrorOf(keyframes).what(), HasSubstr("line 3: "));
}

TEST(NdjsonReader, BearsNumbersThatAreTooLong) {
  const std::string head = "{\"type\":\"atlas\"}\n{\"type\":\"map\",\"id\":";
  const std::string digits(100'000, '9');
  for (const std::string& number :
       {digits, "-" + digits, "1e" + digits, "0." + digits, std::string("-0"), std::string("+1"), std::string("0x10"),
        std::string("1_000"), std::string("NaN"), std::string(".5")}) {
    const Error error = ErrorOf(head + number + "}\n");
    if (number == "-0") continue;  // is 0, or none; both are fine
    EXPECT_EQ(error.kind(), ErrorKind::kDamaged) << number.substr(0, 9);
    EXPECT_THAT(error.place(), AnyOf("line 2", "line 2: id")) << number.substr(0, 9);
    EXPECT_LT(error.problem().size(), 300U);
  }
  const std::string point = head + "0}\n{\"type\":\"map_point\",\"id\":0,\"position\":[0,0,";
  EXPECT_EQ(Read(point + "0." + digits + "]}\n").maps[0].points[0].position.z(), 1);
  EXPECT_THAT(ErrorOf(point + "1e" + digits + "]}\n").problem(), HasSubstr("32-bit floats"));
  EXPECT_EQ(Read(point + "1e-" + digits + "]}\n").maps[0].points[0].position.z(), 0);
}

// Who is meant by an id that two have is the checker's matter.
TEST(NdjsonReader, LoadsIdsThatComeTwice) {
  const std::string map = "{\"type\":\"map\",\"id\":0}\n";
  const std::string keyframe =
      "{\"type\":\"keyframe\",\"id\":0,\"timestamp\":0,\"camera_from_world\":{\"rotation_xyzw\":[0,0,0,1],"
      "\"translation\":[0,0,0]},\"features\":{\"keypoints\":{\"x\":[1],\"y\":[2]},\"map_points\":[0]}}\n";
  const std::string point = "{\"type\":\"map_point\",\"id\":0,\"position\":[0,0,0]}\n";
  const std::string camera = "{\"type\":\"camera\",\"id\":0,\"model\":\"pinhole\",\"parameters\":[1,1,1,1]}\n";
  const Atlas atlas = Read("{\"type\":\"atlas\"}\n" + camera + camera + map + keyframe + keyframe + point + point +
                           map + keyframe + point);
  ASSERT_EQ(atlas.maps.size(), 2U);
  EXPECT_EQ(atlas.cameras.size(), 2U);
  EXPECT_EQ(atlas.maps[0].keyframes.size(), 2U);
  EXPECT_EQ(atlas.maps[0].points.size(), 2U);
}

// One line of many megabytes is read as fast as many lines.
TEST(NdjsonReader, ReadsALineOfAnyLength) {
  std::string columns[2];
  for (int i = 0; i < 400'000; ++i)
    for (std::string& column : columns) column += (i == 0 ? "" : ",") + std::to_string(i % 640);
  const Atlas atlas = Read(
      "{\"type\":\"atlas\"}\n{\"type\":\"map\",\"id\":0}\n{\"type\":\"keyframe\",\"id\":0,\"timestamp\":0,"
      "\"camera_from_world\":{\"rotation_xyzw\":[0,0,0,1],\"translation\":[0,0,0]},\"features\":{\"keypoints\":{\"x\":"
      "[" +
      columns[0] + "],\"y\":[" + columns[1] + "]}}}\n");
  EXPECT_EQ(atlas.maps[0].keyframes[0].features.keypoints.size(), 400'000U);
  const std::string endless(10'000'000, ' ');
  EXPECT_THAT(ErrorOf(endless).what(), HasSubstr("has no lines"));
  EXPECT_THAT(ErrorOf("{\"type\":\"atlas\"," + endless).what(), HasSubstr("line 1"));
  EXPECT_THAT(ErrorOf("{\"type\":\"atlas\",\"vocabulary\":{\"name\":\"" + endless).what(), HasSubstr("line 1"));
}

// ---- what real files have

TEST(JsonScanner, RoundsToTheNearestAndToZero) {
  const auto read = [](std::string_view text) { return detail::JsonScanner(text).Float(); };
  EXPECT_EQ(read("0.1"), 0.1F);
  EXPECT_EQ(read("1e-60"), 0);
  EXPECT_EQ(read("1e-400"), 0);
  EXPECT_TRUE(std::signbit(read("-1e-400")));
  EXPECT_EQ(read("1.17549435e-38"), std::numeric_limits<float>::min());
}

TEST(JsonScanner, SkipsAnyValue) {
  for (const char* text : {"1", "-1.5e3", "null", "true", "\"a]}\\\"b\"", "[]", "{}", "[1,[2,{\"a\":[\"]\"]}],null]"}) {
    detail::JsonScanner json(text);
    json.Skip();
    EXPECT_NO_THROW(json.RequireEnd()) << text;
  }
}

}  // namespace
}  // namespace slamdb
