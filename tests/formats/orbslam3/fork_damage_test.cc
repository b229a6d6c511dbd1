// SPDX-License-Identifier: BSD-3-Clause
// Archives of forks that are cut, changed, or of layouts that mean harm: an Error, never more.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/formats/orbslam3/fork_files.h"
#include "tests/support/kind_of.h"
#include "tests/support/message_of.h"

namespace slamdb {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;

// A file of every kind of member.
std::string Layouts() {
  return Changed(
      R"({"class": "KeyFrame", "after": "mnFrameId", "add": [["xText", "string"], ["xList", "vec<string>"],
            ["xMap", "map<u64,vec<f32>>"], ["xSet", "set<u32>"], ["xMat", "mat"], ["xMat2", "mat2"], ["xKeys", "kps"],
            ["xThing", "ptr<Thing>"], ["xParent", "ptr<KeyFrame>"], ["xCamera", "ptr<GeometricCamera>"]]},
         {"class": "MapPoint", "after": "nObs", "add": [["xValue", "val<Thing2>"], ["xFlags", "vec<bool>"]]})",
      R"({"Thing": {"fields": [["a", "u32"], ["b", "list<u64>"]]}, "Thing2": {"fields": [["a", "arr<f64,3>"]]}})");
}

std::string SmallFile(bool text) {
  Atlas atlas = SynthesizeAtlas({.sensor = Sensor::kRgbd, .keyframes = 2, .points = 3, .features = 4, .threads = 1});
  for (KeyFrame& keyframe : atlas.maps[0].keyframes) keyframe.features.grid = {};
  atlas.encoding.text = text;
  return WriteFork(atlas, Layouts());
}

// Reads it, and writes what was read.
void ReadAndWrite(const std::string& bytes, const std::string& layout) {
  try {
    const Atlas atlas = ReadFork(bytes, layout);
    const std::string again = EncodeOrbslam3(atlas);
    EXPECT_TRUE(EncodeOrbslam3(ReadFork(again, layout)) == again);
  } catch (const Error& error) {
    EXPECT_NE(error.kind(), ErrorKind::kInternal) << error.what();
  }
}

class DamagedFork : public ::testing::TestWithParam<bool> {};

TEST_P(DamagedFork, CutAnywhereIsRefused) {
  const std::string bytes = SmallFile(GetParam()), layout = Layouts();
  ASSERT_NO_THROW((void)ReadFork(bytes, layout));
  const std::size_t whole = GetParam() ? bytes.size() - 2 : bytes.size();  // the last token of a text, and its end
  for (std::size_t size = 0; size < whole; size += size < 200 || size + 200 > whole ? 1 : 13) {
    const auto kind = KindOf([&] { (void)ReadFork(bytes.substr(0, size), layout); });
    ASSERT_TRUE(kind == ErrorKind::kDamaged || kind == ErrorKind::kUnsupported) << size << " of " << bytes.size();
  }
}

TEST_P(DamagedFork, ChangedAnywhereEndsInAnErrorOrAnAtlas) {
  const std::string bytes = SmallFile(GetParam()), layout = Layouts();
  std::mt19937_64 random(1);
  for (std::size_t i = 0; i < bytes.size(); i += 1 + random() % (bytes.size() / 300)) {
    std::string changed = bytes;
    changed[i] = static_cast<char>(changed[i] ^ (1 << (random() % 8)));
    ReadAndWrite(changed, layout);
    changed[i] = '\xff';
    ReadAndWrite(changed, layout);
  }
}

// Without a layout all known ones are tried.
TEST_P(DamagedFork, OfNoKnownLayoutIsRefused) {
  EXPECT_EQ(KindOf([&] { (void)ReadFork(SmallFile(GetParam()), ""); }), ErrorKind::kDamaged);
}

INSTANTIATE_TEST_SUITE_P(Encodings, DamagedFork, ::testing::Values(false, true),
                         [](const auto& test) { return test.param ? "text" : "binary"; });

TEST(DamagedForks, BytesBehindTheEndAreNamed) {
  Notices notices;
  (void)ReadFork(SmallFile(false) + "behind", Layouts(), &notices);
  EXPECT_TRUE(notices.lossy());
  EXPECT_THAT(TextOf(notices), HasSubstr("6 bytes behind the end"));
}

TEST(DamagedForks, TellWhereTheyAreDamaged) {
  const std::string bytes = SmallFile(false);
  const std::string message = MessageOf([&] { (void)ReadFork(bytes.substr(0, bytes.size() / 2), Layouts()); });
  EXPECT_THAT(message, AllOf(HasSubstr("fork.osa"), HasSubstr("byte "), HasSubstr("map 0, kf ")));
}

TEST(DamagedForks, CountsAreHeldAgainstTheBytesLeft) {
  Atlas atlas = ReadFork(SmallFile(false), Layouts());
  std::string bytes = EncodeOrbslam3(atlas);
  for (std::size_t i = 40; i + 8 < bytes.size(); i += 11) {  // any 8 bytes as a count that nothing could hold
    std::string changed = bytes;
    changed.replace(i, 8, std::string("\0\0\0\0\0\0\0\x20", 8));
    ReadAndWrite(changed, Layouts());
  }
}

// ---- layouts that mean harm: good JSON, of which no program can be made

std::string Refusal(const std::string& layout) {
  const std::string bytes = SmallFile(false);
  return MessageOf([&] { (void)ReadFork(bytes, layout); });
}

TEST(HostileLayout, ObjectsThatHoldEachOtherThroughPointers) {
  EXPECT_THAT(Refusal(Changed(R"({"class": "KeyFrame", "after": "", "add": [["x", "ptr<A>"]]})",
                              R"({"A": {"fields": [["b", "ptr<B>"]]}, "B": {"fields": [["a", "ptr<A>"]]}})")),
              HasSubstr("hold each other through pointers"));
}

TEST(HostileLayout, ClassesThatMultiplyThroughPointers) {
  std::string classes = "{";
  for (int i = 0; i < 20; ++i) {
    const std::string next = "ptr<C" + std::to_string(i + 1) + ">";
    classes += "\"C" + std::to_string(i) + R"(": {"fields": [)";
    for (int member = 0; member < 10; ++member)
      classes += (member == 0 ? "" : ",") + ("[\"m\", \"" + (i == 19 ? "u8" : next) + "\"]");
    classes += "]},";
  }
  classes.back() = '}';
  EXPECT_THAT(Refusal(Changed(R"({"class": "KeyFrame", "after": "", "add": [["x", "ptr<C0>"]]})", classes)),
              AnyOf(HasSubstr("members in each other"), HasSubstr("hold each other")));
}

TEST(HostileLayout, ArraysOfArrays) {
  EXPECT_THAT(
      Refusal(Changed(R"({"class": "KeyFrame", "after": "", "add": [["x", "arr<arr<arr<f64,65536>,65536>,65536>"]]})")),
      HasSubstr("has more than 1048576 bytes"));
}

TEST(HostileLayout, ContainersOfNothing) {
  for (const char* type : {"vec<val<Empty>>", "arr<raw<Empty>,65536>", "map<u8,raw<Empty>>", "list<raw<Hollow>>"})
    EXPECT_THAT(Refusal(Changed(std::string(R"({"class": "KeyFrame", "after": "", "add": [["x", ")") + type + "\"]]}",
                                R"({"Empty": {"fields": []}, "Hollow": {"fields": [["e", "raw<Empty>"]]}})")),
                HasSubstr("a container of what has no members"))
        << type;
}

TEST(HostileLayout, ClassesByValueAndBehindPointers) {
  EXPECT_THAT(Refusal(Changed(R"({"class": "KeyFrame", "after": "", "add": [["x", "ptr<A>"], ["y", "val<A>"]]})",
                              R"({"A": {"fields": [["a", "u8"]]}})")),
              HasSubstr("A stands there by value and behind pointers"));
}

TEST(HostileLayout, CamerasThatPointToCameras) {
  EXPECT_THAT(Refusal(Changed(R"({"class": "GeometricCamera", "after": "", "add": [["x", "ptr<GeometricCamera>"]]})")),
              HasSubstr("cameras that point to cameras"));
}

TEST(HostileLayout, NoAtlas) {
  EXPECT_THAT(Refusal(R"({"root": ["string"], "classes": {}})"), HasSubstr("so it is of no atlas"));
  EXPECT_THAT(Refusal(R"({"base": "v1.0", "root": ["string"]})"), HasSubstr("its root is no atlas"));
  EXPECT_THAT(Refusal(Changed(R"({"class": "Atlas", "replace": ["mvpBackupMaps"]})")), HasSubstr("mvpBackupMaps"));
  EXPECT_THAT(Refusal(Changed(R"({"class": "Map", "replace": ["mvpBackupKeyFrames"]})")),
              HasSubstr("Map has no vectors of keyframes"));
}

TEST(HostileLayout, AbstractEntities) {
  EXPECT_THAT(Refusal(R"({"base": "v1.0", "classes": {"MapPoint": {"abstract": true, "fields": [["mnId", "u64"]]}}})"),
              HasSubstr("its class MapPoint is abstract"));
  EXPECT_THAT(Refusal(Changed(R"({"class": "KeyFrame", "after": "", "add": [["x", "ptr<A>"]]})",
                              R"({"A": {"abstract": true, "fields": []}})")),
              HasSubstr("pointers to the abstract class A"));
}

TEST(HostileLayout, ListsOfAnotherKind) {
  EXPECT_THAT(
      Refusal(Changed(
          R"({"class": "Map", "replace": ["mvpBackupKeyFrames"], "add": [["mvpBackupKeyFrames", "set<ptr<KeyFrame>>"]]})")),
      HasSubstr("expected a vec"));
}

TEST(HostileLayout, MoreClassesThanThereAreNumbersFor) {
  std::string members;
  for (int i = 1; i < 60; ++i) members += (i == 1 ? "" : ",") + ("[\"x\", \"vec<arr<u8," + std::to_string(i) + ">>\"]");
  EXPECT_THAT(Refusal(Changed(R"({"class": "KeyFrame", "after": "", "add": [)" + members + "]}")),
              HasSubstr("classes that ORB-SLAM3 does not have"));
}

// What a layout lacks stays as it is for new entities; the checks have their say.
TEST(HostileLayout, WithoutMembersThatMapsNeed) {
  const std::string layout = Changed(R"({"class": "KeyFrame", "replace": ["mnId", "mTcw", "mvKeys"]},
                                        {"class": "MapPoint", "replace": ["mnId", "mWorldPos"]})");
  const std::string bytes = WriteFork(SmallWorld(), layout);
  const Atlas read = ReadFork(bytes, layout);
  EXPECT_EQ(read.maps[0].keyframes.size(), 4U);
  EXPECT_TRUE(EncodeOrbslam3(read) == bytes);
}

// ---- carried members that come from elsewhere than a file of the layout

class HostileMembers : public ::testing::Test {
 protected:
  // Writes a keyframe with one pointer whose packed bytes are these.
  static std::string Written(const std::string& type, const std::vector<int>& bytes) {
    const std::string layout = Changed(R"({"class": "KeyFrame", "after": "", "add": [["x", ")" + type + "\"]]}",
                                       R"({"Thing": {"fields": [["a", "u32"]]}})");
    Atlas atlas = SynthesizeAtlas({.keyframes = 2, .points = 3, .features = 4, .threads = 1});
    atlas.layout = layout;
    Column<std::byte>& members = atlas.maps[0].keyframes[0].carried.Make().members;
    for (const int byte : bytes) members.push_back(static_cast<std::byte>(byte));
    return MessageOf([&] {
      const std::string written = EncodeOrbslam3(atlas);
      EXPECT_TRUE(EncodeOrbslam3(ReadFork(written, layout)) == written);
    });
  }
};

TEST_F(HostileMembers, PointersOfAnotherKind) {
  EXPECT_THAT(Written("ptr<KeyFrame>", {1, 3, 0, 0, 0, 0, 0, 0, 0, 0}), HasSubstr("an entity of another kind"));
  EXPECT_THAT(Written("ptr<GeometricCamera>", {1, 1, 0, 0, 0, 0, 0, 0, 0, 0}), HasSubstr("an entity of another kind"));
  EXPECT_THAT(Written("ptr<Thing>", {1, 1, 0, 0, 0, 0, 0, 0, 0, 0}), HasSubstr("an entity of another kind"));
  EXPECT_THAT(Written("ptr<Map>", {2, 0, 0, 0, 0, 0}), HasSubstr("an object of another kind"));
  EXPECT_THAT(Written("ptr<Thing>", {9}), HasSubstr("an object of another kind"));
}

TEST_F(HostileMembers, PointersToWhatIsGoneBecomeNull) {
  EXPECT_EQ(Written("ptr<KeyFrame>", {1, 1, 99, 99, 0, 0, 0, 0, 0, 0}), "no error");
  EXPECT_EQ(Written("ptr<Thing>", {2, 5, 0, 0, 0, 0}), "no error");
}

TEST_F(HostileMembers, CountsThatDoNotFit) {
  EXPECT_THAT(Written("vec<f64>", {2, 0, 0, 0, 0, 0, 0, 0, 1, 1}), HasSubstr("a count of 2 does not fit"));
  EXPECT_THAT(Written("string", {255, 255, 255, 255, 255, 255, 255, 255}), HasSubstr("does not fit"));
  EXPECT_THAT(Written("kps", {255, 255, 255, 255}), HasSubstr("no keypoints"));
  EXPECT_THAT(Written("mat", {255, 255, 255, 127, 255, 255, 255, 127, 0, 0, 0, 0, 1}), HasSubstr("no matrix"));
  EXPECT_THAT(Written("mat2", {1, 0, 0, 0, 1, 0, 0, 0, 255, 255, 255, 255, 255, 255, 255, 255, 0, 0, 0, 0, 0, 0, 0, 0}),
              HasSubstr("no matrix"));
  EXPECT_THAT(Written("u64", {1}), HasSubstr("not of this layout"));
}

}  // namespace
}  // namespace slamdb
