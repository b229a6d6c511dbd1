// SPDX-License-Identifier: BSD-3-Clause
// Layouts as JSON: what is known, what is the same, and what is refused.
#include "slamdb/formats/layouts/layout.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "slamdb/base/error.h"
#include "tests/cli/json_schema.h"
#include "tests/support/error_of.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

std::string TextOfFile(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}
std::string BreachOf(const std::string& layout) { return testing::BreachOf(json::parse(layout), "layout.schema.json"); }

constexpr const char* kTypes[] = {"u8",
                                  "bool",
                                  "i16",
                                  "u16",
                                  "i32",
                                  "u32",
                                  "u64",
                                  "i64",
                                  "f32",
                                  "f64",
                                  "long",
                                  "size",
                                  "ulonglong",
                                  "mat2",
                                  "mat",
                                  "string",
                                  "kps",
                                  "vec<u8>",
                                  "vec<bool>",
                                  "arr<f32,9>",
                                  "set<u64>",
                                  "list<val<C>>",
                                  "map<u64,vec<ptr<C>>>",
                                  "raw<A::B>",
                                  "arr<arr<u8,2>,65536>"};

TEST(LayoutTypes, AreWrittenAsTheyWereRead) {
  for (const char* type : kTypes) EXPECT_EQ(ToString(ParseLayoutType(type)), type);
  EXPECT_EQ(ToString(ParseLayoutType("map<u64, i32>")), "map<u64,i32>");
}

TEST(LayoutTypes, ThatAreNoneAreRefusedWithTheirPlace) {
  const auto refusal = [](const std::string& type) { return MessageOf([&] { (void)ParseLayoutType(type); }); };
  EXPECT_THAT(refusal("u65"), HasSubstr("no type is called 'u65'"));
  EXPECT_THAT(refusal(""), HasSubstr("no type is called ''"));
  EXPECT_THAT(refusal("vec<>"), HasSubstr("no type is called ''"));
  EXPECT_THAT(refusal("vec<u8"), HasSubstr("expected '>'"));
  EXPECT_THAT(refusal("vec<u8>>"), HasSubstr("something stands behind"));
  EXPECT_THAT(refusal("map<u8>"), HasSubstr("expected ','"));
  EXPECT_THAT(refusal("ptr<>"), HasSubstr("expected the name of a class"));
  EXPECT_THAT(refusal("ptr<C"), HasSubstr("expected '>'"));
  for (const char* count : {"0", "65537", "-1", "1e3", "18446744073709551616", ""})
    EXPECT_THAT(refusal(std::string("arr<u8,") + count + ">"), HasSubstr("is no length")) << count;
  EXPECT_THAT(refusal(std::string(100, 'v')), HasSubstr("no type is called"));
  EXPECT_THAT(refusal(std::string(300, 'v')), HasSubstr("at most 256"));
  std::string deep = "u8";
  for (int i = 0; i < 9; ++i) deep = "vec<" + deep + ">";
  EXPECT_THAT(refusal(deep), HasSubstr("more than 8 deep"));
}

// ---- the known ones

TEST(KnownLayoutsAsJson, FitTheSchemaAsTheyStandInTheirFilesAndInFull) {
  for (const Layout& layout : KnownLayouts()) {
    const std::string file =
        TextOfFile(std::string(SLAMDB_FIXTURES "/../lib/slamdb/formats/layouts/known/") + layout.id + ".json");
    ASSERT_FALSE(file.empty()) << layout.id;
    EXPECT_EQ(BreachOf(file), "") << layout.id;
    EXPECT_EQ(BreachOf(ToJson(layout)), "") << layout.id;
    EXPECT_EQ(ParseLayout(file), layout);
    EXPECT_EQ(ParseLayout(ToJson(layout)), layout);
  }
}

TEST(KnownLayoutsAsJson, AreAllDifferentAndOnThePage) {
  const std::string page = TextOfFile(SLAMDB_FIXTURES "/../schema/layouts.md");
  EXPECT_EQ(KnownLayouts().front().id, "v1.0");
  for (const Layout& layout : KnownLayouts()) {
    EXPECT_THAT(page, HasSubstr("`" + layout.id + "`"));
    EXPECT_FALSE(layout.title.empty());
    EXPECT_FALSE(layout.who.empty());
    for (const Layout& other : KnownLayouts()) EXPECT_EQ(SameBytes(layout, other), layout.id == other.id);
  }
  for (const char* word :
       {"u8",       "bool",   "i16",    "u16",       "i32",    "u32",      "i64",    "f32",     "f64",
        "u64",      "long",   "size",   "ulonglong", "string", "arr<T,n>", "vec<T>", "list<T>", "set<T>",
        "map<K,V>", "ptr<C>", "val<C>", "raw<C>",    "mat",    "mat2",     "kps"})
    EXPECT_THAT(page, HasSubstr("`" + std::string(word) + "`"));
}

TEST(KnownLayoutsAsJson, AreNamedByIdOrByFile) {
  EXPECT_EQ(LoadLayout("obvi").id, "obvi");
  const TemporaryFolder folder;
  const std::string path = folder.Path("mine.json");
  std::ofstream(path) << R"({"base": "obvi", "id": "mine"})";
  EXPECT_TRUE(SameBytes(LoadLayout(path), *FindKnownLayout("obvi")));
  EXPECT_EQ(LayoutOf("obvi"), LayoutOf(ToJson(*FindKnownLayout("obvi"))));
  const Error error = ErrorOf([] { (void)LoadLayout("no-such"); });
  EXPECT_EQ(error.kind(), ErrorKind::kNotFound);
  EXPECT_THAT(error.problem(), AllOf(HasSubstr("visible-found"), HasSubstr("v03")));
}

// The short names of older layout files are ORB-SLAM3's own.
TEST(LayoutJson, TakesShortNames) {
  Layout layout = ParseLayout(R"({"root": "string string ptr<Atlas>", "classes": {
    "Atlas": {"registers": ["Pinhole", "KannalaBrandt8"],
              "fields": [["maps", "vec<ptr<Map>>"], ["cams", "vec<ptr<GeometricCamera>>"], ["cnt", "arr<u64,5>"],
                         ["last", "u64"]]},
    "Map": {"fields": [["mnId", "u64"], ["kfs", "vec<ptr<KeyFrame>>"], ["flags", "arr<bool,4>"]]},
    "KeyFrame": {"fields": [["mnId", "u64"], ["fx", "arr<f32,9>"], ["bounds", "arr<i32,4>"], ["mps", "vec<i64>"]]},
    "GeometricCamera": {"abstract": true, "fields": [["id", "u32"], ["type", "u32"], ["par", "vec<f32>"]]},
    "Pinhole": {"fields": [["base", "val<GeometricCamera>"]]},
    "KannalaBrandt8": {"fields": [["base", "val<GeometricCamera>"], ["prec", "f32"]]}}})");
  EXPECT_EQ(layout.root.size(), 3U);
  EXPECT_EQ(layout.Find("Atlas")->members, FindKnownLayout("v1.0")->Find("Atlas")->members);
  EXPECT_EQ(layout.Find("GeometricCamera")->members, FindKnownLayout("v1.0")->Find("GeometricCamera")->members);
  EXPECT_EQ(layout.Find("KeyFrame")->members.size(), 1U + 9 + 4 + 1);
  EXPECT_EQ(layout.Find("Map")->members.back().name, "mbIMU_BA2");
}

TEST(LayoutJson, ChangesStandWhereTheyAreSaid) {
  const Layout layout = ParseLayout(R"({"base": "v1.0", "changes": [
    {"class": "Map", "after": "", "add": [["first", "u8"]]},
    {"class": "Map", "after": "mbIMU_BA2", "add": [["last", "u8"]]},
    {"class": "Map", "replace": ["mnInitKFid", "mnMaxKFid"], "add": [["between", "u8"]]},
    {"class": "Atlas", "registers": ["Pinhole"]}]})");
  const LayoutClass& map = *layout.Find("Map");
  EXPECT_EQ(map.members.front().name, "first");
  EXPECT_EQ(map.members.back().name, "last");
  EXPECT_EQ(map.members[2].name, "between");
  EXPECT_EQ(layout.Find("Atlas")->registers, std::vector<std::string>{"Pinhole"});
  EXPECT_EQ(layout.id, "");
}

// ---- what means harm

class HostileJson : public ::testing::Test {
 protected:
  static std::string Refusal(const std::string& text) {
    const Error error = ErrorOf([&] { (void)ParseLayout(text, "hostile.json"); });
    EXPECT_EQ(error.kind(), ErrorKind::kDamaged) << error.what();
    EXPECT_EQ(error.path(), "hostile.json");
    return error.place() + ": " + error.problem();
  }
  static std::string OfClass(const std::string& of) { return R"({"root": ["ptr<A>"], "classes": {"A": )" + of + "}}"; }
};

TEST_F(HostileJson, NoJson) {
  for (const char* text : {"", "{", "{]", "nul", "{\"id\": \"\xff\"}", "{} {}"})
    EXPECT_THAT(Refusal(text), HasSubstr("no JSON")) << text;
  EXPECT_THAT(Refusal(std::string(100000, '[')), HasSubstr("no JSON"));
}

TEST_F(HostileJson, OtherJson) {
  for (const char* text : {"[]", "7", "null", "\"v1.0\""}) EXPECT_THAT(Refusal(text), HasSubstr("expected an object"));
}

TEST_F(HostileJson, DeepNesting) {
  EXPECT_THAT(Refusal(R"({"base": "v1.0", "id": )" + std::string(50000, '[') + std::string(50000, ']') + "}"),
              HasSubstr("id: expected a text"));
}

TEST_F(HostileJson, TooMuch) {
  EXPECT_THAT(Refusal(std::string(1100000, ' ')), HasSubstr("at most 1048576"));
  std::string classes, members;
  for (int i = 0; i < 200; ++i) classes += (i == 0 ? "\"C" : ",\"C") + std::to_string(i) + R"(": {"fields": []})";
  EXPECT_THAT(Refusal(R"({"base": "v1.0", "classes": {)" + classes + "}}"), HasSubstr("more than 128 classes"));
  for (int i = 0; i < 1100; ++i) members += i == 0 ? R"(["m","u8"])" : R"(,["m","u8"])";
  EXPECT_THAT(Refusal(OfClass(R"({"fields": [)" + members + "]}")), HasSubstr("1100 elements, at most 1024"));
  EXPECT_THAT(Refusal(R"({"base": "v1.0", "id": ")" + std::string(200, 'i') + "\"}"), HasSubstr("at most 128"));
}

TEST_F(HostileJson, WhatIsNeededAndNotThere) {
  EXPECT_THAT(Refusal("{}"), HasSubstr("expected 'root' and 'classes', or a 'base'"));
  EXPECT_THAT(Refusal(R"({"root": [], "classes": {}})"), HasSubstr("nothing is saved"));
  EXPECT_THAT(Refusal(OfClass("{}")), HasSubstr("classes.A: it has no 'fields'"));
  EXPECT_THAT(Refusal(R"({"base": "v1.0", "changes": [{}]})"), HasSubstr("changes[0]: it has no 'class'"));
}

TEST_F(HostileJson, MembersThatNobodyKnows) {
  EXPECT_THAT(Refusal(R"({"base": "v1.0", "colour": 1})"), HasSubstr("no member is called 'colour'"));
  EXPECT_THAT(Refusal(OfClass(R"({"fields": [], "size": 1})")), HasSubstr("no member is called 'size'"));
  EXPECT_THAT(Refusal(R"({"base": "v1.0", "changes": [{"class": "Map", "befor": "x"}]})"), HasSubstr("'befor'"));
}

TEST_F(HostileJson, MembersThatStandThereTwice) {
  EXPECT_THAT(Refusal(R"({"base": "v1.0", "base": "obvi"})"), HasSubstr("'base' stands there twice"));
  EXPECT_THAT(Refusal(R"({"root": ["ptr<A>"], "classes": {"A": {"fields": []}, "A": {"fields": []}}})"),
              HasSubstr("'A' stands there twice"));
}

TEST_F(HostileJson, OfTheWrongType) {
  EXPECT_THAT(Refusal(R"({"base": 1})"), HasSubstr("base: expected a text"));
  EXPECT_THAT(Refusal(R"({"base": "v1.0", "header": 41})"), HasSubstr("header: expected 40"));
  EXPECT_THAT(Refusal(R"({"base": "v1.0", "root": {}})"), HasSubstr("root: expected a text"));
  EXPECT_THAT(Refusal(R"({"base": "v1.0", "classes": []})"), HasSubstr("classes: expected an object"));
  EXPECT_THAT(Refusal(R"({"base": "v1.0", "changes": {}})"), HasSubstr("changes: expected an array"));
  EXPECT_THAT(Refusal(OfClass(R"({"fields": {}})")), HasSubstr("fields: expected an array"));
  EXPECT_THAT(Refusal(OfClass(R"({"fields": [["a"]]})")), HasSubstr("fields[0]: expected a name and a type"));
  EXPECT_THAT(Refusal(OfClass(R"({"fields": [["a", 1]]})")), HasSubstr("fields[0][1]: expected a text"));
  EXPECT_THAT(Refusal(OfClass(R"({"fields": [], "abstract": "yes"})")), HasSubstr("expected true or false"));
  EXPECT_THAT(Refusal(OfClass(R"({"fields": [["a b", "u8"]]})")), HasSubstr("'a b' is no name"));
  EXPECT_THAT(Refusal(OfClass(R"({"fields": [["", "u8"]]})")), HasSubstr("'' is no name"));
}

TEST_F(HostileJson, TypesAndClassesThatAreNotThere) {
  EXPECT_THAT(Refusal(OfClass(R"({"fields": [["a", "f16"]]})")), HasSubstr("fields[0][1]: type 'f16'"));
  EXPECT_THAT(Refusal(OfClass(R"({"fields": [["a", "vec<ptr<B>>"]]})")),
              HasSubstr("classes.A, a: no class is called B"));
  EXPECT_THAT(Refusal(OfClass(R"({"fields": [], "registers": ["B"]})")), HasSubstr("no class is called B"));
  EXPECT_THAT(Refusal(R"({"base": "v0.9"})"), HasSubstr("base: no layout is known by that id"));
  EXPECT_THAT(Refusal(R"({"base": "v1.0", "changes": [{"class": "Mapp", "add": []}]})"), HasSubstr("no such class"));
  EXPECT_THAT(Refusal(R"({"base": "v1.0", "changes": [{"class": "Map", "after": "x"}]})"),
              HasSubstr("Map has no member 'x'"));
  EXPECT_THAT(Refusal(R"({"base": "v1.0", "changes": [{"class": "Map", "replace": ["x"]}]})"),
              HasSubstr("Map has no member 'x'"));
  EXPECT_THAT(Refusal(R"({"base": "v1.0", "changes": [{"class": "Map", "replace": [], "after": ""}]})"),
              HasSubstr("either 'after' or 'replace'"));
}

TEST_F(HostileJson, ClassesWithoutEnd) {
  EXPECT_THAT(Refusal(OfClass(R"({"fields": [["a", "val<A>"]]})")), HasSubstr("holds itself by value"));
  EXPECT_THAT(Refusal(OfClass(R"({"fields": [["a", "vec<raw<A>>"]]})")), HasSubstr("holds itself by value"));
  EXPECT_THAT(Refusal(R"({"root": ["ptr<A>"], "classes": {
    "A": {"fields": [["b", "val<B>"]]}, "B": {"fields": [["c", "val<C>"]]}, "C": {"fields": [["a", "map<u8,val<A>>"]]}}})"),
              HasSubstr("holds itself by value"));
}

// Each class holds the next a thousand times.
TEST_F(HostileJson, ClassesThatMultiply) {
  std::string classes;
  for (int i = 0; i < 8; ++i) {
    classes += (i == 0 ? "\"C" : ",\"C") + std::to_string(i) + R"(": {"fields": [)";
    for (int member = 0; member < 1000; ++member)
      classes += (member == 0 ? "" : ",") +
                 (i == 7 ? std::string(R"(["m","u8"])") : "[\"m\",\"val<C" + std::to_string(i + 1) + ">\"]");
    classes += "]}";
  }
  EXPECT_THAT(Refusal(R"({"root": ["val<C0>"], "classes": {)" + classes + "}}"),
              HasSubstr("more than 65536 members in each other"));
}

TEST_F(HostileJson, ClassesThatAreDeepInEachOther) {
  std::string classes = R"("C0": {"fields": []})";
  for (int i = 1; i < 20; ++i)
    classes += ",\"C" + std::to_string(i) + R"(": {"fields": [["m", "val<C)" + std::to_string(i - 1) + ">\"]]}";
  EXPECT_THAT(Refusal(R"({"root": ["val<C19>"], "classes": {)" + classes + "}}"), HasSubstr("more than 8 deep"));
}

TEST(LayoutSchema, FindsWhatDoesNotFit) {
  for (const char* text : {"{}", R"({"base": "v1.0", "colour": 1})", R"({"base": "v1.0", "header": 41})",
                           R"({"base": "v1.0", "changes": [{"after": "x"}]})", R"({"root": [], "classes": {}})",
                           R"({"root": ["ptr<A>"], "classes": {"A": {"fields": [["a"]]}}})"}) {
    EXPECT_NE(BreachOf(text), "") << text;
    EXPECT_NE(ErrorOf([&] { (void)ParseLayout(text); }).kind(), ErrorKind::kInternal) << text;
  }
}

}  // namespace
}  // namespace slamdb
