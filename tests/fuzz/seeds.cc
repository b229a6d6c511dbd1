// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "slamdb/base/file.h"
#include "slamdb/checks/report.h"
#include "slamdb/edit/ids/id_map.h"
#include "slamdb/edit/ids/renumber.h"
#include "slamdb/edit/merge/three_way.h"
#include "slamdb/edit/repair/journal.h"
#include "slamdb/formats/layouts/layout.h"
#include "slamdb/formats/mrpt/detail/gzip.h"
#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/formats/osmap/detail/osmap.h"
#include "slamdb/formats/rows/detail/features_blob.h"
#include "slamdb/model/detail/record.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/formats/layouts/invented_layouts.h"
#include "tests/formats/orbslam3/crafted_atlases.h"
#include "tests/fuzz/colmap_parts.h"
#include "tests/fuzz/files.h"
#include "tests/fuzz/fork_parts.h"
#include "tests/fuzz/osa_mutator.h"

// Writes the inputs that fuzzing starts from: small archives of every kind of writer, whole and damaged where it hurts,
// the store's blobs of their keyframes, and small files of other formats.
namespace slamdb {
namespace {

using std::filesystem::path;
using Field = CraftedArchive::Field;

void Write(const path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

void WriteDamaged(const path& folder, const std::string& name, const Crafted& crafted, bool text) {
  for (std::size_t i = 1; i < 16; ++i)
    Write(folder / (name + "_cut_" + std::to_string(i)), crafted.bytes.substr(0, crafted.bytes.size() * i / 16));
  const std::uint64_t huge = std::uint64_t{1} << 61;
  for (std::size_t i = 0; i < crafted.fields.size(); ++i) {
    const Field& field = crafted.fields[i];
    std::string bytes = crafted.bytes;
    if (text)
      bytes.replace(field.offset, field.length, field.kind == Field::Kind::kCount ? std::to_string(huge) : "32767");
    else
      bytes.replace(field.offset, field.length, field.length, '\x7f');
    Write(folder / (name + "_field_" + std::to_string(i)), bytes);
  }
}

std::string StoreSeed(const KeyFrame& keyframe) {
  detail::ByteWriter details, picture, points;
  detail::EncodeDetails(keyframe, details);
  rows::EncodePicture(keyframe, picture);
  rows::EncodePoints(keyframe, points);
  const std::string features = rows::Join(picture.bytes(), points.bytes());
  const Features& counts = keyframe.features;
  const std::size_t length = details.bytes().size();
  std::string seed = {static_cast<char>(counts.count), static_cast<char>(counts.left_count),
                      static_cast<char>(counts.right_count), static_cast<char>(length & 0xff),
                      static_cast<char>(length >> 8)};
  for (const Bytes bytes : {details.bytes(), std::as_bytes(std::span(features))})
    seed.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return seed;
}

void WriteStoreSeeds(const path& folder, const path& archive, const std::string& name) {
  Notices notices;
  const Atlas atlas = ReadOrbslam3(archive.string(), {}, notices);
  for (const Map& map : atlas.maps)
    for (const KeyFrame& keyframe : map.keyframes) {
      const std::string seed = StoreSeed(keyframe), id = name + "_" + std::to_string(keyframe.id.value());
      Write(folder / id, seed);
      for (std::size_t i = 1; i < 64; ++i) {
        std::string damaged = seed;
        damaged[damaged.size() * i / 64] ^= static_cast<char>(0xff);
        Write(folder / (id + "_changed_" + std::to_string(i)), damaged);
      }
    }
}

// A file, parts of it, and what it is with one byte changed.
void WriteChanged(const path& folder, const std::string& name, const std::string& bytes) {
  std::filesystem::create_directories(folder);
  Write(folder / name, bytes);
  for (std::size_t i = 1; i < 32; ++i) {
    const std::size_t at = bytes.size() * i / 32;
    Write(folder / (name + "_cut_" + std::to_string(i)), bytes.substr(0, at));
    std::string changed = bytes;
    changed[at] ^= static_cast<char>(0x83);
    Write(folder / (name + "_changed_" + std::to_string(i)), changed);
  }
}

std::string ReadFixture(const std::string& name) {
  const WholeFile file(std::string(SLAMDB_FIXTURES) + "/" + name);
  return std::string(file.text());
}

void WriteSeedsOfFixtures(const path& base) {
  for (const std::string name : {"landmark.bin", "landmarks.bin"}) {
    const std::string bytes = ReadFixture("mrpt/" + name);
    WriteChanged(base / "mrpt", name, bytes);
    std::string compressed;
    mrpt::Compressor compressor([&](std::string_view block) { compressed += block; });
    compressor.Add(bytes);
    compressor.Finish();
    WriteChanged(base / "mrpt", name + ".gz", compressed);
  }
  for (const std::string name : {"stella", "stella-sqlite"})
    WriteChanged(base / "stella", name, ReadFixture("formats/" + name));
  WriteChanged(base / "rtabmap", "rtabmap", ReadFixture("formats/rtabmap"));
  for (const std::string name : {"small.txt", "small.bin"})
    WriteChanged(base / "vocabulary", name, ReadFixture("vocabulary/" + name));
  WriteChanged(base / "ndjson", "whole", ReadFixture("formats/ndjson"));
  WriteChanged(
      base / "ndjson", "sparse",
      "{\"type\":\"atlas\"}\n{\"type\":\"camera\",\"id\":0,\"model\":\"pinhole\",\"parameters\":[9,9,1,1]}\n"
      "{\"type\":\"map\",\"id\":1}\n{\"type\":\"keyframe\",\"id\":2,\"timestamp\":1,\"camera\":0,"
      "\"camera_from_world\":{\"rotation_xyzw\":[0,0,0,1],\"translation\":[0,0,0]},\"features\":{\"keypoints\":"
      "{\"x\":[1,2],\"y\":[3,4]},\"map_points\":[5,null]}}\n{\"type\":\"map_point\",\"id\":5,"
      "\"position\":[0,0,\"NaN\"]}\n{\"type\":\"landmark\",\"mean\":[1,2,3],\"features\":[{\"type\":\"orb\"}]}\n");
  WriteChanged(base / "picture", "camera.yaml", ReadFixture("room/camera.yaml"));
  WriteChanged(base / "trajectory", "tum", "# time x y z qx qy qz qw\n1.5 1 2 3 0 0 0 1\n2.5e0 -1 nan 3 0 0.6 0 0.8\n");
  WriteChanged(base / "trajectory", "euroc",
               "#timestamp, p_RS_R_x [m]\n1403636580838555648,4.6,-1.7,0.7,0.5,-0.1,-0.8,-0.1,0,0,0,0,0,0,0,0,0\n");
}

// Of slamdb, and with what others have: lists, big endian, padding, compressed fields.
void WriteSeedsOfClouds(const path& base) {
  WriteChanged(base / "ply", "ours", ReadFixture("formats/ply"));
  const std::string head =
      "element face 1\nproperty list uchar int i\nelement vertex 2\nproperty double x\nproperty "
      "short y\nproperty list uint float w\nproperty float z\nproperty char id\nend_header\n";
  WriteChanged(base / "ply", "ascii",
               "ply\r\nformat ascii 1.0\ncomment c\n" + head + "3 0 1 2\n1.5 2 2 9 9 nan 7\n-1e300 2 0 3 -1\n");
  const std::string lists(
      "\1\0\0\0\2"
      "12345678"
      "12"
      "\0\0\0\1"
      "wwww"
      "zzzz"
      "i"
      "12345678"
      "12"
      "\0\0\0\0"
      "zzzzi",
      47);
  WriteChanged(base / "ply", "big_endian", "ply\nformat binary_big_endian 1.0\n" + head + lists);
  WriteChanged(base / "pcd", "ours", ReadFixture("formats/pcd"));
  const std::string fields =
      "VERSION .7\nFIELDS x _ y z id\nSIZE 4 1 8 2 1\nTYPE F U F I U\nCOUNT 1 2 1 1 1\nWIDTH "
      "2\nHEIGHT 1\nVIEWPOINT 1 0 0 1 0 0 0\nPOINTS 2\nDATA ";
  WriteChanged(base / "pcd", "ascii", fields + "ascii\n1 0 0 2e0 3 4\nnan 0 0 nan -3 255\n");
  WriteChanged(base / "pcd", "binary", fields + "binary\n" + std::string(34, 'b'));
  const std::string lzf(
      "\x07\0\0\0\x22\0\0\0"
      "\1ab\xe0\x17\1\0\x20\0",
      16);  // two letters, over and over
  WriteChanged(base / "pcd", "compressed", fields + "binary_compressed\n" + lzf);
  WriteChanged(base / "xyz", "names", "//X Y Z nx ny nz id map i\n1 2 3 0 0 1 7 1 9\n-1e9 2 nan 0 0 1 8 0 9\n");
  WriteChanged(base / "xyz", "numbers", "# c\n1.5, 2, 3, 255\n\n+4, 5e-3, inf, 0\n");
  WriteChanged(base / "xyz", "commas", "1,5;2;3\r\n4;5,25;6\r\n");
}

void WriteSeedsOfColmap(const path& folder) {
  constexpr std::array kParts = {"cameras", "images", "points3D", "rigs", "frames"};
  for (const bool binary : {true, false}) {
    fuzz::ColmapParts parts{.binary = binary, .files = {}};
    const std::string place = std::string("formats/colmap") + (binary ? "/0/" : "-text/0/");
    for (std::size_t part = 0; part < kParts.size(); ++part)
      parts.files[part] = ReadFixture(place + kParts[part] + (binary ? ".bin" : ".txt"));
    WriteChanged(folder, binary ? "binary" : "text", JoinColmap(parts));
    parts.files[3].clear(), parts.files[4].clear();
    Write(folder / (binary ? "old_binary" : "old_text"), JoinColmap(parts));
  }
}

// Graphs of a handful of keyframes, in every form.
void WriteSeedsOfGraphs(const path& base) {
  WriteChanged(base / "orbslam2", "boost", ReadFixture("formats/orbslam2"));
  const std::string vertices =
      "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 1 2.5 -3 0 0.6 0 0.8\n# TIME 1 17.5\n";
  WriteChanged(
      base / "g2o", "se3",
      vertices + "FIX 0\nEDGE_SE3:QUAT 0 1 1 0 0 0 0 0 1 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\nPARAMS_X 1\n");
  WriteChanged(base / "g2o", "sim3",
               "VERTEX_SIM3:EXPMAP 3 0.1 0.2 0.3 1 2 3 0.5 9 9 1 1\nVERTEX_SIM3:EXPMAP 4 0 0 0 0 0 0 0\n"
               "FIX 3 4\nEDGE_SIM3:EXPMAP 4 3 1e-6 0 0 1 2 3 -0.5\n");
  const std::array<std::string, 3> vins = {ReadFixture("formats/vins/pose_graph.txt"),
                                           ReadFixture("formats/vins/0_keypoints.txt"),
                                           ReadFixture("formats/vins/0_briefdes.dat")};
  WriteChanged(base / "vins", "graph", fuzz::JoinFiles(vins));
}

void WriteSeedsOfOsmap(const path& folder) {
  const fuzz::Folder map("slamdb_seeds_osmap");
  Atlas atlas = SynthesizeAtlas({.keyframes = 3, .points = 20, .features = 60, .threads = 1});
  Notices notices;
  osmap::Write(atlas, map.Path("map.yaml"), {.sync = false}, notices);
  std::array<std::string, 4> files;
  for (std::size_t i = 0; const char* suffix : {"yaml", "mappoints", "keyframes", "features"})
    files[i++] = WholeFile(map.Path(std::string("map.") + suffix)).text();
  WriteChanged(folder, "whole", fuzz::JoinFiles(files));
  files[0].replace(files[0].find("Options: 0"), 10, "Options: 1");
  WriteChanged(folder, "delimited", fuzz::JoinFiles(files));
}

void WriteSeedsOfTables(const path& folder) {
  WriteChanged(folder, "fixes", "\xef\xbb\xbfTime [s];Lat;Lon;alt_ft\r\n+1.5;47.25;8.5;400\r\n2.5;-47;8;nan\r\n");
  WriteChanged(folder, "anchors", "# pairs\nfirst, second, first_x\n0, 1,\n\n2, 3, 1e3\n");
  WriteChanged(folder, "ids", "input,kind,old,new\n\"a, \"\"b\"\"\nc\",keyframe,0,5\na,point,1,\na,next_map,1,2\n");
  WriteChanged(folder, "keyframes", "map\tkeyframe\tx\n0\t7\t\t1\n0\t\"8\"\t0.5");
  WriteChanged(folder, "transform", "% matrix\n0 -2 0 1; 2 0 0 +2\n0,0,2,3 # metres\n0 0 0 1");
}

// Small atlases of every kind of sensor, sound but for their image grids, which would be most of the bytes; and what
// they are when fields and lists are changed.
void WriteAtlases(const path& folder) {
  std::filesystem::create_directories(folder);
  constexpr std::uint64_t kVariations = 100;
  std::uint64_t seed = 0;
  for (const Sensor sensor : {Sensor::kMonocular, Sensor::kStereo, Sensor::kRgbd, Sensor::kFisheyeStereo})
    for (const bool inertial : {false, true}) {
      Atlas atlas = SynthesizeAtlas({.sensor = sensor,
                                     .inertial = inertial,
                                     .maps = 2,
                                     .keyframes = 4,
                                     .points = 20,
                                     .features = 60,
                                     .threads = 1});
      for (Map& map : atlas.maps)
        for (KeyFrame& keyframe : map.keyframes) keyframe.features.grid = keyframe.features.right_grid = {};
      const std::string name = std::to_string(seed / kVariations);
      Write(folder / name, EncodeOrbslam3(atlas));
      for (std::uint64_t variation = 0; variation < kVariations; ++variation) {
        Atlas changed = atlas;
        fuzz::Mutate(changed, ++seed);
        if (const auto encoded = fuzz::Encoded(changed))
          Write(folder / (name + "_changed_" + std::to_string(variation)), *encoded);
      }
    }
}

// The same small atlas in every known layout, and in one with members of all kinds.
void WriteSeedsOfForks(const path& folder) {
  const Atlas small = SynthesizeAtlas({.keyframes = 2, .points = 3, .features = 4, .threads = 1});
  const auto write = [&](const std::string& name, const std::string& layout, bool text) {
    Atlas atlas = small;
    for (KeyFrame& keyframe : atlas.maps[0].keyframes) keyframe.features.grid = {};
    atlas.encoding.text = text;
    atlas.layout = layout;
    WriteChanged(folder, name, fuzz::JoinFork(layout, EncodeOrbslam3(atlas)));
  };
  for (const Layout& layout : KnownLayouts()) write(layout.id, layout.id, false);
  const std::string every =
      R"({"base":"v1.0","classes":{"T":{"fields":[["a","u32"],["b","list<u64>"]]},"U":{"fields":[["a","u8"]]}},"changes":[{"class":"KeyFrame",)"
      R"("after":"","add":[["a","string"],["b","map<u64,vec<f32>>"],["c","mat"],["d","mat2"],["e","kps"],)"
      R"(["f","ptr<T>"],["g","ptr<KeyFrame>"],["h","ptr<GeometricCamera>"],["i","vec<val<U>>"]]}]})";
  write("every", ToJson(ParseLayout(every)), false);
  write("every_text", ToJson(ParseLayout(every)), true);
}

// Small files of forks that nobody wrote, and the sources of one.
void WriteSeedsOfLayouts(const path& base) {
  const Atlas atlas = SynthesizeAtlas({.keyframes = 5, .points = 30, .features = 60, .threads = 1});
  std::filesystem::create_directories(base / "layout_infer");
  for (std::uint64_t seed = 0; seed < 2; ++seed) {
    std::mt19937_64 random(seed);
    const testing::Invention fork = testing::InventLayout(random, {.insertions = 1, .removals = seed % 3 == 0 ? 1 : 0});
    const std::string bytes = testing::Forge(atlas, fork.layout, random), name = std::to_string(seed);
    Write(base / "layout_infer" / name, bytes);
    for (std::size_t i = 1; i < 6; ++i) {
      std::string changed = bytes;
      changed[bytes.size() * i / 6] ^= static_cast<char>(0x83);
      Write(base / "layout_infer" / (name + "_changed_" + std::to_string(i)), changed);
      Write(base / "layout_infer" / (name + "_cut_" + std::to_string(i)), bytes.substr(0, bytes.size() * i / 6));
    }
  }
  WriteChanged(base / "layout_source", "fork",
               "#define N 3\nclass MapPoint;\nstruct Base { int b; template <class A> void serialize(A& ar, unsigned) "
               "{ ar & b; } };\nclass Map : public Base { std::vector<MapPoint*> p; float m[3]; char c; int8_t d; "
               "signed char * e; // c\n"
               "template <class Archive> void serialize(Archive& ar, const unsigned int v) {\n#ifdef X\nar & p;\n#else"
               "\nar & m; ar & c; ar & d;\n#endif\nar & boost::serialization::base_object<Base>(*this); if "
               "(Archive::is_saving::value) "
               "{ ar << p; } }\n};\nvoid Save(Map* map) { boost::archive::binary_oarchive oa(f); oa << map; }\n");
}

// Journals that lead from the atlas of fuzz_json.cc to what it is when fields and lists are changed, and ids for it.
void WriteSeedsOfJson(const path& folder) {
  const Atlas atlas = SynthesizeAtlas({.maps = 2, .keyframes = 4, .points = 20, .features = 60, .threads = 1});
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Atlas changed = atlas;
    fuzz::Mutate(changed, seed);
    Journal journal;
    try {
      AppendChanges(changed, atlas, "map-listed-once", journal);
    } catch (const Error&) {  // no journal brings entities back that are gone
      continue;
    }
    WriteChanged(folder, "journal_" + std::to_string(seed), ToJson(journal));
  }
  const std::vector<IdMap> ids = {PlanRenumbering(atlas)};
  WriteChanged(folder, "ids", IdMapsToJson(ids));
  Atlas broken = atlas;
  for (std::size_t i = 0; i < 3; ++i) broken.maps[0].points[i].reference = KeyFrameId(4711);
  const CheckedFile checked{.name = "a", .report = CheckAtlas(broken), .failure = {}, .file = {}};
  WriteChanged(folder, "check", ToJson({&checked, 1}));
  ThreeWayReport merged;
  merged.conflicts = {{{.point = MapPointId(7)}, "flags"}, {{.keyframe = KeyFrameId(1)}, "deletion"}};
  WriteChanged(folder, "merge", ToJson(merged));
}

// Patches of a store, see fuzz_store.cc: one or a few bytes anywhere.
void WriteStorePatches(const path& folder) {
  std::filesystem::create_directories(folder);
  std::mt19937_64 random(1);
  for (int seed = 0; seed < 300; ++seed) {
    std::string patches;
    for (int left = seed % 4; left >= 0; --left)
      for (int byte = 0; byte < 7; ++byte) patches += static_cast<char>(random());
    Write(folder / std::to_string(seed), patches);
  }
}

void WriteSeeds(const path& base) {
  WriteStorePatches(base / "store");
  WriteAtlases(base / "atlases");
  WriteSeedsOfFixtures(base);
  WriteSeedsOfLayouts(base);
  WriteSeedsOfTables(base / "table");
  WriteSeedsOfClouds(base);
  WriteSeedsOfColmap(base / "colmap");
  WriteSeedsOfForks(base / "fork");
  WriteSeedsOfGraphs(base);
  WriteSeedsOfOsmap(base / "osmap");
  WriteSeedsOfJson(base / "json");
  const path archives = base / "orbslam3", blobs = base / "store_blobs";
  std::filesystem::create_directories(archives);
  std::filesystem::create_directories(blobs);
  constexpr std::array<std::array<int, 2>, 3> kWidths = {{{8, 8}, {4, 8}, {4, 4}}};  // long, size_t
  for (const bool text : {false, true})
    for (const auto& [long_bytes, size_bytes] : kWidths) {
      const Craft craft{text, 18, long_bytes, size_bytes};
      const std::string kind = std::string(text ? "text" : "binary") + std::to_string(long_bytes * 10 + size_bytes);
      const Crafted tiny = CraftTinyAtlas(craft), odd = CraftOddAtlas(craft);
      Write(archives / ("tiny_" + kind), tiny.bytes);
      Write(archives / ("odd_" + kind), odd.bytes);
      if (long_bytes == 8) WriteDamaged(archives, "odd_" + kind, odd, text);
    }
  for (const char* name : {"tiny", "odd"}) WriteStoreSeeds(blobs, archives / (std::string(name) + "_binary88"), name);
}

}  // namespace
}  // namespace slamdb

int main(int count, char** arguments) {
  if (count != 2) {
    std::fputs("usage: fuzz_seeds FOLDER\n", stderr);
    return 2;
  }
  slamdb::WriteSeeds(arguments[1]);
  return 0;
}
