// SPDX-License-Identifier: BSD-3-Clause
// Every type that a layout can name, as stock Boost writes it behind an atlas: we read it and write the same bytes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/archive/binary_oarchive.hpp>
#include <boost/archive/text_oarchive.hpp>
#include <boost/serialization/array.hpp>
#include <boost/serialization/list.hpp>
#include <boost/serialization/map.hpp>
#include <boost/serialization/set.hpp>
#include <boost/serialization/string.hpp>
#include <boost/serialization/tracking.hpp>
#include <boost/serialization/vector.hpp>
#include <sstream>

#include "slamdb/boost.h"
#include "slamdb/formats/layouts/layout.h"
#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/synthetic/synthesize.h"

namespace of_fork {

struct Label {
  float score = 0.25F;
  int id = -3;
  bool known = true;
  template <class Archive>
  void serialize(Archive& archive, const unsigned int) {
    archive& score& id& known;
  }
};
struct Thing {
  unsigned int number = 0;
  std::string text;
  template <class Archive>
  void serialize(Archive& archive, const unsigned int) {
    archive& number& text;
  }
};
// cv::Mat as ORB-SLAM3's helper archives it, and as ORB-SLAM2's programs do.
struct Mat2 {
  int columns = 2, rows = 1;
  std::size_t element = 4, type = 5;
  std::array<unsigned char, 8> bytes{1, 2, 3, 4, 5, 6, 7, 8};
  template <class Archive>
  void serialize(Archive& archive, const unsigned int) {
    archive& columns& rows& element& type& boost::serialization::make_array(bytes.data(), bytes.size());
  }
};

struct Everything {
  unsigned char u8 = 200;
  bool flag = true;
  short i16 = -7;
  unsigned short u16 = 65000;
  int i32 = -70000;
  unsigned int u32 = 4000000000U;
  unsigned long u64 = 1UL << 60U;
  long slong = -5;
  long long i64 = -(1LL << 50);
  unsigned long long ull = 1ULL << 63U;
  std::size_t size = 77;
  float f32 = 1.5F;
  double f64 = -2.25;
  std::string text = "two words";
  std::array<float, 3> array{1, 2, 3};
  std::vector<double> doubles{0.5, 0.75};
  std::vector<unsigned char> bytes{1, 2, 3};
  std::vector<bool> flags{true, false, true};
  std::vector<std::string> texts{"a", "", "bcd"};
  std::vector<std::vector<double>> rows{{1}, {}, {2, 3}};
  std::list<unsigned long> numbers{7, 8};
  std::list<float> floats;
  std::set<int> set{-1, 4};
  std::set<std::string> names{"x", "y"};
  std::map<int, double> weights{{1, 0.5}, {2, 0.25}};
  std::map<int, std::string> words{{5, "five"}};
  std::map<unsigned int, std::vector<double>> empty;
  Label label, another;
  std::vector<Label> labels{2};
  Mat2 matrix;
  Thing thing{9, "nine"};
  Thing *first = &thing, *again = &thing, *none = nullptr;
  std::vector<Thing*> things{&thing, nullptr};

  template <class Archive>
  void serialize(Archive& archive, const unsigned int) {
    archive& u8& flag& i16& u16& i32& u32& u64& slong& i64& ull& size& f32& f64& text;
    archive& boost::serialization::make_array(array.data(), array.size());
    archive& doubles& bytes& flags& texts& rows& numbers& floats& set& names& weights& words& empty;
    archive& label& another& labels& matrix;
    archive& first& again& none& things;
  }
};

}  // namespace of_fork

BOOST_CLASS_TRACKING(of_fork::Everything, boost::serialization::track_never)
BOOST_CLASS_TRACKING(of_fork::Label, boost::serialization::track_never)
BOOST_CLASS_TRACKING(of_fork::Mat2, boost::serialization::track_never)

namespace slamdb {
namespace {

constexpr const char* kLayout = R"({"base": "v1.0",
  "root": ["string", "string", "ptr<Atlas>", "val<Everything>", "string"],
  "classes": {
    "Label": {"fields": [["score", "f32"], ["id", "i32"], ["known", "bool"]]},
    "Thing": {"fields": [["number", "u32"], ["text", "string"]]},
    "Everything": {"fields": [
      ["u8", "u8"], ["flag", "bool"], ["i16", "i16"], ["u16", "u16"], ["i32", "i32"], ["u32", "u32"], ["u64", "u64"],
      ["slong", "long"], ["i64", "i64"], ["ull", "ulonglong"], ["size", "size"], ["f32", "f32"], ["f64", "f64"],
      ["text", "string"], ["array", "arr<f32,3>"], ["doubles", "vec<f64>"], ["bytes", "vec<u8>"],
      ["flags", "vec<bool>"], ["texts", "vec<string>"], ["rows", "vec<vec<f64>>"], ["numbers", "list<u64>"],
      ["floats", "list<f32>"], ["set", "set<i32>"], ["names", "set<string>"], ["weights", "map<i32,f64>"],
      ["words", "map<i32,string>"], ["empty", "map<u32,vec<f64>>"], ["label", "val<Label>"],
      ["another", "val<Label>"], ["labels", "vec<val<Label>>"], ["matrix", "mat2"], ["first", "ptr<Thing>"],
      ["again", "ptr<Thing>"], ["none", "ptr<Thing>"], ["things", "vec<ptr<Thing>>"]]}}})";

template <class Archive>
std::string Saved(const Atlas& atlas) {
  std::ostringstream stream;
  {
    Archive archive(stream);
    const of_fork::Everything everything;
    const std::string last = "the end";
    archive << atlas << everything << last;
  }
  return stream.str();
}

class ForkOfBoost : public ::testing::TestWithParam<bool> {};

TEST_P(ForkOfBoost, EveryTypeComesBackByteForByte) {
  const Atlas atlas = SynthesizeAtlas({.keyframes = 3, .points = 20, .features = 40});
  const std::string theirs =
      GetParam() ? Saved<boost::archive::text_oarchive>(atlas) : Saved<boost::archive::binary_oarchive>(atlas);
  ReadOptions options;
  options.of<Orbslam3ReadOptions>().layout = ToJson(ParseLayout(kLayout));
  Notices notices;
  const Atlas read = ReadOrbslam3({std::as_bytes(std::span(theirs)), "boost.osa"}, options, notices);
  EXPECT_TRUE(notices.items().empty());
  ASSERT_TRUE(read.carried);
  EXPECT_EQ(read.maps.at(0).keyframes.size(), atlas.maps[0].keyframes.size());
  const std::string ours = EncodeOrbslam3(read);
  const auto at = static_cast<std::size_t>(std::ranges::mismatch(ours, theirs).in1 - ours.begin());
  EXPECT_TRUE(ours == theirs) << "at byte " << at << " ours: " << ours.substr(at, 60)
                              << ", theirs: " << theirs.substr(at, 60);
}

INSTANTIATE_TEST_SUITE_P(Encodings, ForkOfBoost, ::testing::Values(false, true),
                         [](const auto& test) { return test.param ? "text" : "binary"; });

}  // namespace
}  // namespace slamdb
