// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/boost_reference/boost_reference.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <exception>

#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/formats/orbslam3/crafted_atlases.h"
#include "tests/formats/orbslam3/real_atlases.h"
#include "tests/support/temporary_folder.h"

// Stock Boost reads what we write and we read what it writes, with the same bytes both ways.
namespace slamdb {
namespace {

using reference::Encoding;
using ::testing::HasSubstr;
using ::testing::Values;

Atlas Read(const Source& source) {
  Notices notices;
  return ReadOrbslam3(source, {}, notices);
}

void Write(const Atlas& atlas, const std::string& path, std::uint32_t version) {
  Notices notices;
  WriteOptions options;
  options.overwrite = true;
  options.sync = false;
  options.of<Orbslam3WriteOptions>().boost_version = version;
  WriteOrbslam3(atlas, path, options, notices);
}

// Writes the atlas, passes it through stock Boost, reads that back; all three files hold the same bytes.
void ExpectAgreement(Atlas atlas, bool text) {
  atlas.encoding = {.text = text, .boost_version = reference::ArchiveVersion()};
  const Encoding encoding = text ? Encoding::kText : Encoding::kBinary;
  const TemporaryFolder folder;
  const std::string ours = folder.Path("ours.osa"), theirs = folder.Path("theirs.osa"),
                    again = folder.Path("again.osa");
  Write(atlas, ours, reference::ArchiveVersion());
  reference::Save(reference::Load(ours, encoding), theirs, encoding);
  EXPECT_TRUE(ReadWhole(ours) == ReadWhole(theirs)) << "stock Boost writes other bytes";
  Write(Read(theirs), again, reference::ArchiveVersion());
  EXPECT_TRUE(ReadWhole(theirs) == ReadWhole(again)) << "we write other bytes";
}

struct World {
  const char* name;
  Sensor sensor;
  bool inertial;
  int maps;
};
void PrintTo(const World& world, std::ostream* stream) { *stream << world.name; }

class SyntheticWorld : public ::testing::TestWithParam<World> {
 protected:
  static Atlas Make() {
    SyntheticOptions options;
    options.sensor = GetParam().sensor;
    options.inertial = GetParam().inertial;
    options.maps = GetParam().maps;
    options.keyframes = 6;
    options.points = 200;
    options.features = 300;
    return SynthesizeAtlas(options);
  }
};

TEST_P(SyntheticWorld, BinaryAgrees) { ExpectAgreement(Make(), false); }
TEST_P(SyntheticWorld, TextAgrees) { ExpectAgreement(Make(), true); }

INSTANTIATE_TEST_SUITE_P(
    Sensors, SyntheticWorld,
    Values(World{"mono", Sensor::kMonocular, false, 1}, World{"stereo", Sensor::kStereo, false, 1},
           World{"rgbd", Sensor::kRgbd, false, 1}, World{"fisheye", Sensor::kFisheyeStereo, false, 1},
           World{"mono_inertial", Sensor::kMonocular, true, 1}, World{"stereo_inertial", Sensor::kStereo, true, 1},
           World{"rgbd_inertial", Sensor::kRgbd, true, 1}, World{"fisheye_inertial", Sensor::kFisheyeStereo, true, 1},
           World{"three_maps", Sensor::kRgbd, false, 3}),
    [](const auto& test) { return test.param.name; });

class CraftedForBoost : public ::testing::TestWithParam<bool> {};

TEST_P(CraftedForBoost, EveryIrregularityAgrees) {
  const std::string odd = CraftOddAtlas({.text = GetParam()}).bytes;
  ExpectAgreement(Read({std::as_bytes(std::span(odd)), "odd.osa"}), GetParam());
}

// A newer library reads what an older one wrote; an older one refuses a newer archive by its version alone.
TEST_P(CraftedForBoost, LoadsEveryVersionUpToItsOwn) {
  const Encoding encoding = GetParam() ? Encoding::kText : Encoding::kBinary;
  const TemporaryFolder folder;
  const std::string path = folder.Path("version.osa");
  const std::string tiny = CraftTinyAtlas({.text = GetParam()}).bytes;
  const Atlas atlas = Read({std::as_bytes(std::span(tiny)), "tiny.osa"});
  for (std::uint32_t version = 10; version <= reference::ArchiveVersion(); ++version) {
    Write(atlas, path, version);
    const Atlas loaded = reference::Load(path, encoding);
    ASSERT_EQ(loaded.maps.size(), 1U) << "version " << version;
    EXPECT_EQ(loaded.maps[0].keyframes.at(1).camera_from_world.translation.x(), -0.1F);
  }
  Write(atlas, path, reference::ArchiveVersion() + 1);
  try {
    reference::Load(path, encoding);
    ADD_FAILURE() << "stock Boost took an archive that is newer than itself";
  } catch (const std::exception& refusal) {
    EXPECT_THAT(refusal.what(), HasSubstr("unsupported version"));
  }
}

INSTANTIATE_TEST_SUITE_P(Encodings, CraftedForBoost, Values(false, true),
                         [](const auto& test) { return test.param ? "text" : "binary"; });

class RealFile : public ::testing::TestWithParam<const char*> {};

// Text archives of real files hold nan and inf, which stock Boost cannot read.
TEST_P(RealFile, BinaryAgrees) {
  SLAMDB_REQUIRE_REAL_ATLAS(path, GetParam());
  Atlas atlas = Read(path);
  atlas.encoding.text = false;
  ExpectAgreement(std::move(atlas), false);
}

// What we write is, byte for byte, what ORB-SLAM3 wrote.
TEST_P(RealFile, RewritingKeepsEveryByte) {
  SLAMDB_REQUIRE_REAL_ATLAS(path, GetParam());
  EXPECT_TRUE(EncodeOrbslam3(Read(path)) == ReadWhole(path));
}

INSTANTIATE_TEST_SUITE_P(OrbSlam3, RealFile, ::testing::ValuesIn(kRealAtlases),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace
}  // namespace slamdb
