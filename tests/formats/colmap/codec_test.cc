// SPDX-License-Identifier: BSD-3-Clause
// Every byte of COLMAP's files, spelt out by hand.
#include <gmock/gmock.h>

#include "slamdb/base/error.h"
#include "slamdb/formats/export/detail/raw.h"
#include "tests/formats/colmap/model_files.h"
#include "tests/support/error_of.h"

namespace slamdb::colmap {
namespace {

template <class... Numbers>
std::string Packed(Numbers... numbers) {
  std::string bytes;
  (detail::AppendRaw(bytes, numbers), ...);
  return bytes;
}

using U32 = std::uint32_t;
using U64 = std::uint64_t;
using I32 = std::int32_t;
using U8 = std::uint8_t;

constexpr Pose kLeft{{1, 0, 0, 0}, {0.5, -1, 2}}, kRight{{0.5, 0.5, -0.5, 0.5}, {0, 0, 0.25}};

// A list of one part, as the parts of a model are compared.
Model Only(Part part, const Model& whole) {
  Model model;
  switch (part) {
    case Part::kCameras:
      model.cameras = whole.cameras;
      break;
    case Part::kImages:
      model.images = whole.images;
      break;
    case Part::kPoints:
      model.points = whole.points, model.tracks = whole.tracks;
      break;
    case Part::kRigs:
      model.rigs = whole.rigs;
      break;
    case Part::kFrames:
      model.frames = whole.frames;
      break;
  }
  return model;
}

constexpr std::array kParts = {Part::kCameras, Part::kImages, Part::kPoints, Part::kRigs, Part::kFrames};

std::string Encoded(Part part, bool binary) {
  std::string bytes;
  const Target target([&](Bytes more) { bytes.append(reinterpret_cast<const char*>(more.data()), more.size()); },
                      "memory");
  AtomicFile file(target);
  (binary ? EncodeBinary : EncodeText)(part, SmallModel(), file, {});
  file.Commit();
  return bytes;
}

TEST(ColmapBinary, ReadsWhatTheBytesSay) {
  for (const Part part : kParts) EXPECT_EQ(Decode(part, SmallBytes(part)), Only(part, SmallModel())) << int(part);
}

TEST(ColmapBinary, WritesTheSameBytes) {
  for (const Part part : kParts) EXPECT_EQ(Encoded(part, true), SmallBytes(part)) << int(part);
}

TEST(ColmapText, ReadsWhatTheLinesSay) {
  for (const Part part : kParts) EXPECT_EQ(Decode(part, SmallText(part), false), Only(part, SmallModel())) << int(part);
}

TEST(ColmapText, WritesLinesThatReadTheSame) {
  for (const Part part : kParts) {
    const std::string text = Encoded(part, false);
    EXPECT_TRUE(text.starts_with("# ")) << int(part);
    EXPECT_EQ(text.substr(text.find("\n", text.rfind("#")) + 1), SmallText(part)) << int(part);
  }
}

// The second line of an image is there when it is empty, too.
TEST(ColmapText, KnowsImagesWithoutKeypoints) {
  const Model model =
      Decode(Part::kImages, "# a\n\n1 1 0 0 0 0 0 0 1 a.png\n\n2 1 0 0 0 0 0 0 1 b.png\r\n3 4 -1\r\n", false);
  ASSERT_EQ(model.images.size(), 2U);
  EXPECT_TRUE(model.images[0].points.empty());
  EXPECT_EQ(model.images[1].points, (Column<Point2>{{3, 4, kNoPoint}}));
}

TEST(ColmapText, RefusesToWriteNamesWithBlanks) {
  Model model = SmallModel();
  model.images[0].name = "a b.png";
  AtomicFile file(Target([](Bytes) {}, "memory"));
  EXPECT_THROW(EncodeText(Part::kImages, model, file, {}), Error);
}

}  // namespace

Model SmallModel() {
  Model model;
  model.cameras = {{.id = 1, .model = kPinhole, .width = 64, .height = 48, .parameters = {100, 101, 32.5, 24.5}},
                   {.id = 7, .model = kSimpleRadial, .width = 64, .height = 48, .parameters = {100, 32, 24, 0.25}}};
  model.rigs = {{.id = 1,
                 .sensors = {{.sensor = {SensorType::kCamera, 1}, .sensor_from_rig = std::nullopt},
                             {.sensor = {SensorType::kCamera, 7}, .sensor_from_rig = kRight},
                             {.sensor = {SensorType::kImu, 2}, .sensor_from_rig = std::nullopt}}}};
  model.frames = {{.id = 4,
                   .rig = 1,
                   .rig_from_world = kLeft,
                   .data = {{{SensorType::kCamera, 1}, 5}, {{SensorType::kCamera, 7}, 6}}}};
  model.images = {
      {.id = 5, .camera = 1, .camera_from_world = kLeft, .name = "1.5.png", .points = {{1.5, 2, 9}, {3, 4, kNoPoint}}},
      {.id = 6, .camera = 7, .camera_from_world = kRight, .name = "r/1.5.png", .points = {{7, 8.25, 9}}}};
  model.points = {
      {.id = 9, .position = {1, 2, -3}, .color = {1, 2, 255}, .error = 0.5, .track_begin = 0, .track_length = 2},
      {.id = 11, .position = {0, 0, 0.125}, .color = {}, .error = -1, .track_begin = 2, .track_length = 0}};
  model.tracks = {{5, 0}, {6, 0}};
  return model;
}

std::string SmallBytes(Part part) {
  const std::string left = Packed(1., 0., 0., 0., 0.5, -1., 2.), right = Packed(0.5, 0.5, -0.5, 0.5, 0., 0., 0.25);
  switch (part) {
    case Part::kCameras:
      return Packed(U64{2}, U32{1}, I32{1}, U64{64}, U64{48}, 100., 101., 32.5, 24.5) +
             Packed(U32{7}, I32{2}, U64{64}, U64{48}, 100., 32., 24., 0.25);
    case Part::kImages:
      return Packed(U64{2}, U32{5}) + left + Packed(U32{1}) + std::string("1.5.png\0", 8) +
             Packed(U64{2}, 1.5, 2., U64{9}, 3., 4., ~U64{0}) + Packed(U32{6}) + right + Packed(U32{7}) +
             std::string("r/1.5.png\0", 10) + Packed(U64{1}, 7., 8.25, U64{9});
    case Part::kPoints:
      return Packed(U64{2}, U64{9}, 1., 2., -3., U8{1}, U8{2}, U8{255}, 0.5, U64{2}, U32{5}, U32{0}, U32{6}, U32{0}) +
             Packed(U64{11}, 0., 0., 0.125, U8{0}, U8{0}, U8{0}, -1., U64{0});
    case Part::kRigs:
      return Packed(U64{1}, U32{1}, U32{3}, I32{0}, U32{1}, I32{0}, U32{7}, U8{1}) + right +
             Packed(I32{1}, U32{2}, U8{0});
    case Part::kFrames:
      return Packed(U64{1}, U32{4}, U32{1}) + left + Packed(U32{2}, I32{0}, U32{1}, U64{5}, I32{0}, U32{7}, U64{6});
  }
  return {};
}

std::string SmallText(Part part) {
  switch (part) {
    case Part::kCameras:
      return "1 PINHOLE 64 48 100 101 32.5 24.5\n7 SIMPLE_RADIAL 64 48 100 32 24 0.25\n";
    case Part::kImages:
      return "5 1 0 0 0 0.5 -1 2 1 1.5.png\n1.5 2 9 3 4 -1\n6 0.5 0.5 -0.5 0.5 0 0 0.25 7 r/1.5.png\n7 8.25 9\n";
    case Part::kPoints:
      return "9 1 2 -3 1 2 255 0.5 5 0 6 0\n11 0 0 0.125 0 0 0 -1\n";
    case Part::kRigs:
      return "1 3 CAMERA 1 CAMERA 7 1 0.5 0.5 -0.5 0.5 0 0 0.25 IMU 2 0\n";
    case Part::kFrames:
      return "4 1 1 0 0 0 0.5 -1 2 2 CAMERA 1 5 CAMERA 7 6\n";
  }
  return {};
}

Model Decode(Part part, const std::string& bytes, bool binary) {
  const WholeFile file(Source(std::as_bytes(std::span(bytes)), "memory"));
  Model model;
  (binary ? DecodeBinary : DecodeText)(part, file, model);
  return model;
}

std::string Refusal(Part part, const std::string& bytes, bool binary) {
  return RefusalOf([&] { Decode(part, bytes, binary); });
}

void MakeFiles(const TemporaryFolder& folder, bool binary, const std::map<std::string, std::string>& instead) {
  for (const Part part : kParts) {
    const std::string name = std::string(kPartNames[static_cast<std::size_t>(part)]) + (binary ? ".bin" : ".txt");
    const auto other = instead.find(name);
    folder.Make(name, other != instead.end() ? other->second : binary ? SmallBytes(part) : SmallText(part));
  }
}

}  // namespace slamdb::colmap
