// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/layouts/from_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "slamdb/base/error.h"
#include "slamdb/formats/layouts/layout_text.h"
#include "tests/support/kind_of.h"
#include "tests/support/temporary_folder.h"

namespace slamdb::testing {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::string_view kSave =
    "void Save(Map* map) { std::ofstream f(\"a\"); boost::archive::binary_oarchive oa(f); oa << map; }\n";

DerivedLayout Derived(const std::string& text) {
  const SourceText source{"fork.h", text};
  return DeriveLayout(std::span(&source, 1));
}

// The members of Map, as `name type`.
std::vector<std::string> MembersOf(const DerivedLayout& derived, std::string_view name = "Map") {
  std::vector<std::string> members;
  if (const LayoutClass* of = derived.layout.Find(name))
    for (const LayoutMember& member : of->members) members.push_back(member.name + " " + member.type);
  return members;
}
std::vector<std::string> MembersOf(const std::string& declarations, const std::string& body) {
  return MembersOf(Derived("class Map {\n" + declarations +
                           "\ntemplate <class Archive> void serialize(Archive& ar, const unsigned int version) {\n" +
                           body + "\n}\n};\n" + std::string(kSave)));
}

TEST(FromSource, Scalars) {
  EXPECT_THAT(MembersOf("long unsigned int a; float b, c; bool d; double e; unsigned int f; std::string g; size_t h;",
                        "ar & a; ar & b; ar & c & d; ar & e; ar & f; ar & g; ar & h;"),
              ElementsAre("a u64", "b f32", "c f32", "d bool", "e f64", "f u32", "g string", "h size"));
}

TEST(FromSource, CharactersAreNumbersOfOneByte) {
  EXPECT_THAT(MembersOf("char a; signed char b; int8_t c; unsigned char d; uint8_t e;", "ar & a & b & c & d & e;"),
              ElementsAre("a i8", "b i8", "c i8", "d u8", "e u8"));
}

// u64 and long have 4 bytes where long has.
TEST(FromSource, WidthsThatTheNameSaysStay) {
  EXPECT_THAT(MembersOf("int64_t a; uint64_t b; size_t c; long d; unsigned long e;", "ar & a & b & c & d & e;"),
              ElementsAre("a i64", "b ulonglong", "c size", "d long", "e u64"));
}

TEST(FromSource, WhatIsDeclaredOfNoTypeIsAQuestion) {
  EXPECT_THAT(MembersOf("* a; & b; *&* c, d;", "ar & a; ar & b; ar & c; ar & d;"),
              ElementsAre("a ?", "b ?", "c ?", "d ?"));
}

TEST(FromSource, TypesTooDeepForALayoutAreAQuestion) {
  std::string type = "int";
  for (int i = 0; i < 12; ++i) type = "std::vector<" + type + ">";
  EXPECT_THAT(MembersOf(type + " a;", "ar & a;"), ElementsAre("a ?"));
}

TEST(FromSource, SaysWhatALayoutLacks) {
  EXPECT_THAT(
      Derived("class Map { int a; template <class A> void serialize(A& ar, const unsigned int) { ar & a; } };\n" +
              std::string(kSave))
          .missing,
      ElementsAre("the members of class Atlas", "the members of class KeyFrame", "the members of class MapPoint"));
}

TEST(FromSource, Containers) {
  EXPECT_THAT(MembersOf("std::vector<float> a; std::map<long unsigned int, int> b; std::set<int> c; "
                        "std::list<std::vector<double>> d;",
                        "ar & a; ar & b; ar & c; ar & d;"),
              ElementsAre("a vec<f32>", "b map<u64,i32>", "c set<i32>", "d list<vec<f64>>"));
}

TEST(FromSource, CommentsAreNoCode) {
  EXPECT_THAT(MembersOf("int a, b, c;", "ar & a; // ar & b;\n/* ar & b; */ ar & c; // \\\n ar & b;"),
              ElementsAre("a i32", "c i32"));
}

TEST(FromSource, TypedefsAndUsings) {
  EXPECT_THAT(MembersOf("typedef long unsigned int Id; using Ids = std::vector<Id>; Id a; Ids b;", "ar & a; ar & b;"),
              ElementsAre("a u64", "b vec<u64>"));
}

TEST(FromSource, Casts) {
  EXPECT_THAT(MembersOf("const int a; int b;", "ar & const_cast<int&>(a); ar & BOOST_SERIALIZATION_NVP(b);"),
              ElementsAre("a i32", "b i32"));
}

TEST(FromSource, ArraysOfKnownLength) {
  EXPECT_THAT(MembersOf("float a[3]; Eigen::Vector3f v;",
                        "ar & boost::serialization::make_array(a, 3); ar & boost::serialization::make_array(v.data(), "
                        "v.size());"),
              ElementsAre("a arr<f32,3>", "v arr<f32,3>"));
}

TEST(FromSource, BaseClasses) {
  const DerivedLayout derived = Derived(
      "class Base { public: int b; template <class A> void serialize(A& ar, const unsigned int) { ar & b; } };\n"
      "class Map : public Base { float m; template <class A> void serialize(A& ar, const unsigned int) {\n"
      "ar & boost::serialization::base_object<Base>(*this); ar & m; } };\n" +
      std::string(kSave));
  EXPECT_THAT(MembersOf(derived), ElementsAre("base val<Base>", "m f32"));
  EXPECT_THAT(MembersOf(derived, "Base"), ElementsAre("b i32"));
}

TEST(FromSource, TemplatesOutsideTheClass) {
  EXPECT_THAT(MembersOf(Derived("class Map { friend class boost::serialization::access; int a; float b;\n"
                                "template <class Archive> void serialize(Archive& ar, const unsigned int version); };\n"
                                "template <class Archive> void Map::serialize(Archive& ar, const unsigned int version) "
                                "{ ar & a & b; }\n" +
                                std::string(kSave))),
              ElementsAre("a i32", "b f32"));
}

TEST(FromSource, SavingCountsWhereLoadingDiffers) {
  EXPECT_THAT(MembersOf(Derived("class Map { int a; float b;\n"
                                "template <class A> void save(A& ar, const unsigned int) const { ar << a; ar << b; }\n"
                                "template <class A> void load(A& ar, const unsigned int) { ar >> b; ar >> a; }\n"
                                "BOOST_SERIALIZATION_SPLIT_MEMBER()\n};\n" +
                                std::string(kSave))),
              ElementsAre("a i32", "b f32"));
  EXPECT_THAT(MembersOf("int a, b;", "ar & a; if (Archive::is_loading::value) { ar & a; } else { ar & b; }"),
              ElementsAre("a i32", "b i32"));
}

TEST(FromSource, FreeFunctions) {
  EXPECT_THAT(MembersOf(Derived("struct Map { int a; };\nnamespace boost { namespace serialization {\n"
                                "template <class Archive> void serialize(Archive& ar, Map& map, const unsigned int) {\n"
                                "ar & map.a; } } }\n" +
                                std::string(kSave))),
              ElementsAre("a i32"));
}

TEST(FromSource, BothSidesOfAnIfdefAreAQuestion) {
  const DerivedLayout derived = Derived(
      "class Map { int a, b;\ntemplate <class A> void serialize(A& ar, const unsigned int) {\n#ifdef LAB\nar & a;\n"
      "#else\nar & b;\n#endif\n} };\n" +
      std::string(kSave));
  EXPECT_THAT(MembersOf(derived), ElementsAre("a i32"));
  EXPECT_THAT(derived.questions, Contains(Field(&LayoutQuestion::text, HasSubstr("#else"))));
}

TEST(FromSource, CodeThatIsSwitchedOffIsLeftOut) {
  EXPECT_THAT(MembersOf("int a, b;", "#if 0\nar & b;\n#endif\nar & a;"), ElementsAre("a i32"));
}

TEST(FromSource, AConditionIsAQuestion) {
  const DerivedLayout derived = Derived(
      "class Map { int a, b;\ntemplate <class A> void serialize(A& ar, const unsigned int) {\nar & a;\n"
      "if (a > 3)\nar & b;\n} };\n" +
      std::string(kSave));
  EXPECT_THAT(derived.questions, Contains(AllOf(Field(&LayoutQuestion::line, 5U),
                                                Field(&LayoutQuestion::text, HasSubstr("a condition")))));
  EXPECT_THAT(MembersOf(derived), ElementsAre("a i32", "(condition) ?"));
}

TEST(FromSource, ATypeThatIsNotKnownIsAQuestion) {
  const DerivedLayout derived =
      Derived("class Map { Blob a;\ntemplate <class A> void serialize(A& ar, const unsigned int) { ar & a; } };\n" +
              std::string(kSave));
  EXPECT_THAT(derived.questions, ::testing::Not(IsEmpty()));
}

TEST(FromSource, MacrosAreAskedAbout) {
  const DerivedLayout derived = Derived(
      "#define ARCHIVE(x) ar & x\nclass Map { int a;\n"
      "template <class A> void serialize(A& ar, const unsigned int) { ARCHIVE(a); ar & a; } };\n" +
      std::string(kSave));
  EXPECT_THAT(MembersOf(derived), Contains("a i32"));
}

TEST(FromSource, TheTextOfAWholeLayoutIsReadAgain) {
  const DerivedLayout derived =
      Derived("class Map { int a;\ntemplate <class A> void serialize(A& ar, const unsigned int) { ar & a; } };\n" +
              std::string(kSave));
  EXPECT_TRUE(SameBytes(ParseLayout(LayoutText(derived.layout)), derived.layout));
}

// ---- Sources that nobody should have

std::string Repeated(std::string_view text, int times) {
  std::string repeated;
  for (int i = 0; i < times; ++i) repeated += text;
  return repeated;
}

TEST(FromSource, SurvivesEveryCut) {
  const std::string text =
      "template <class T> struct V { T t[3]; };\nclass Map : public Base<int> { std::map<int, std::vector<V<float>>> "
      "a; "
      "/* c */ const char* s = R\"x(})x\";\ntemplate <class A> void serialize(A& ar, unsigned) { if "
      "(A::is_saving::value) "
      "{ ar & a; } for (int i = 0; i < 3; ++i) ar & s[i]; ar & boost::serialization::make_array(a.data(), 3); } };\n" +
      std::string(kSave);
  for (std::size_t size = 0; size <= text.size(); ++size) (void)Derived(text.substr(0, size));
  for (std::size_t begin = 0; begin < text.size(); ++begin) (void)Derived(text.substr(begin));
}

TEST(FromSource, SurvivesWhatIsNotBalanced) {
  for (const std::string_view piece :
       {"{", "}",  "(",    ")",         "<",          ">",   "[",     "]",       "#if 1\n", "#endif\n", "\"",
        "'", "/*", "R\"(", "class A {", "template <", "a::", "ar & ", "ar << (", "if (",    "else "})
    (void)Derived("class Map { template <class A> void serialize(A& ar, unsigned) { " + Repeated(piece, 20'000) +
                  std::string(kSave));
}

TEST(FromSource, SurvivesClassesThatHoldThemselves) {
  (void)Derived(
      "class Map { Map m; typedef T T; using U = V; using V = U; U u; T t;\n"
      "template <class A> void serialize(A& ar, unsigned) { ar & m; ar & u; ar & t; } };\n" +
      std::string(kSave));
}

TEST(FromSource, FoldersAreRead) {
  const TemporaryFolder folder;
  EXPECT_EQ(KindOf([&] { (void)DeriveLayoutOfFolder(folder / "none"); }), ErrorKind::kNotFound);
  EXPECT_EQ(KindOf([&] { (void)DeriveLayoutOfFolder(folder.path().string()); }), ErrorKind::kNotPossible);
}

}  // namespace
}  // namespace slamdb::testing
