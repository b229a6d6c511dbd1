// SPDX-License-Identifier: BSD-3-Clause
// What scenes hold and how they fail. That they see points where keypoints are, scene.py tests.
#include "slamdb/formats/splats/detail/splats.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>

#include "slamdb/base/error.h"
#include "slamdb/edit/frame/transform.h"
#include "slamdb/formats/colmap/detail/codec.h"
#include "slamdb/formats/colmap/options.h"
#include "slamdb/model/up.h"
#include "slamdb/pictures/color_picture.h"
#include "slamdb/synthetic/synthesize.h"
#include "tests/formats/formats/small_atlas.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr std::int32_t kWidth = 129, kHeight = 97;  // of the images of SmallAtlas()

// Of one colour.
std::string Plain(std::uint8_t red, std::uint8_t green, std::uint8_t blue, PictureFormat format = PictureFormat::kPng,
                  std::int32_t width = kWidth) {
  ColorPicture picture{.width = width, .height = kHeight, .pixels = {}};
  for (std::int32_t pixel = 0; pixel < width * kHeight; ++pixel)
    picture.pixels.insert(picture.pixels.end(), {red, green, blue});
  return EncodePicture(picture, format);
}

// OneMapAtlas() has keyframes of 0.5 and 1.5 s.
class Scenes : public ::testing::Test {
 protected:
  // What writing says, or why it does not.
  std::string Write(const Format& format, const Atlas& atlas) {
    Notices notices;
    const KeyFramePictures pictures{.files = files_, .folder = folder_.Path("")};
    try {
      format.write(atlas, out_, WriteOptions{.sync = false}.With(ColmapWriteOptions{.pictures = pictures}), notices);
    } catch (const Error& error) {
      return error.what();
    }
    std::string said = notices.written();
    for (const Notice& notice : notices.items()) said += "\n" + notice.text;
    keyframes_ = notices.counts().value_or(WrittenCounts()).keyframes;
    return said;
  }
  void Add(const std::string& name, double time, const std::string& bytes) {
    fs::create_directories(fs::path(folder_ / name).parent_path());
    folder_.Make(name, bytes);
    files_.push_back({folder_ / name, time, true});
  }
  template <class Part>
  colmap::Model Decoded(Part part, const std::string& name) const {
    const std::string bytes = ReadFile(out_ + "/" + name);
    const WholeFile file(Source(std::as_bytes(std::span(bytes)), name));
    colmap::Model model;
    colmap::DecodeBinary(part, file, model);
    return model;
  }
  std::vector<std::string> Names() const {
    std::vector<std::string> names;
    for (const colmap::Image& image : Decoded(colmap::Part::kImages, "sparse/0/images.bin").images)
      names.push_back(image.name);
    return names;
  }

  TemporaryFolder folder_;
  std::string out_ = folder_ / "out";
  std::vector<PictureFile> files_;
  std::uint64_t keyframes_ = 0;  // that were written
};

void Distort(Atlas& atlas) {
  for (Map& map : atlas.maps)
    for (KeyFrame& keyframe : map.keyframes) {
      keyframe.distortion = {4, 1, 5, true, Column<std::byte>(16)};
      keyframe.distortion.data[2] = keyframe.distortion.data[3] = std::byte{0x3d};  // 0.031
    }
}

// Scenes of an earlier run would stay beside the new ones.
TEST_F(Scenes, AreNotMixedWithThoseOfOtherMaps) {
  const auto write = [&](const Atlas& atlas) {
    Notices notices;
    try {
      detail::kGaussianFormat.write(atlas, out_, {.overwrite = true, .sync = false}, notices);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("written");
  };
  const Atlas several = SmallAtlas();
  ASSERT_GT(several.maps.size(), 1U);
  EXPECT_EQ(write(several), "written");
  EXPECT_EQ(write(several), "written");
  EXPECT_THAT(write(OneMapAtlas()), HasSubstr("out/0/sparse/0 that would be read with what is written"));
  EXPECT_FALSE(fs::exists(out_ + "/sparse"));
  fs::remove_all(out_);
  EXPECT_EQ(write(OneMapAtlas()), "written");
  EXPECT_EQ(write(OneMapAtlas()), "written");
  EXPECT_THAT(write(several), HasSubstr("out/sparse/0 that would be read with what is written"));
}

// Of more maps, or of a program that knows rigs.
TEST_F(Scenes, AreNotMixedWithWhatAnEarlierRunLeft) {
  const auto write = [&](const Format& format, const Atlas& atlas) {
    Notices notices;
    try {
      format.write(atlas, out_, {.overwrite = true, .sync = false}, notices);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("written");
  };
  const Atlas several = SmallAtlas();
  EXPECT_EQ(write(detail::kNerfFormat, several), "written");
  EXPECT_EQ(write(detail::kNerfFormat, several), "written");
  EXPECT_THAT(write(detail::kNerfFormat, OneMapAtlas()), HasSubstr("out/0 that would be read with what is written"));
  EXPECT_FALSE(fs::exists(out_ + "/transforms.json"));
  fs::remove_all(out_);
  EXPECT_EQ(write(detail::kGaussianFormat, OneMapAtlas()), "written");
  folder_.Make("out/sparse/0/rigs.bin", "of another model");
  EXPECT_THAT(write(detail::kGaussianFormat, OneMapAtlas()), HasSubstr("rigs.bin: is a part of a model"));
}

TEST_F(Scenes, OfSplatsWithoutPicturesAreGrey) {
  EXPECT_THAT(Write(detail::kGaussianFormat, OneMapAtlas()), HasSubstr("without pictures"));
  EXPECT_THAT(Names(), ElementsAre("1.5.png", "0.5.png"));
  for (const colmap::Point& point : Decoded(colmap::Part::kPoints, "sparse/0/points3D.bin").points)
    EXPECT_THAT(point.color, ElementsAre(128, 128, 128));
  EXPECT_FALSE(fs::exists(out_ + "/images"));
}

TEST_F(Scenes, OfSplatsHaveTheirPicturesAsTheyAreAndTheirColours) {
  Add("a.png", 0.5, Plain(10, 20, 30));
  Add("b.png", 1.5, Plain(30, 30, 31, PictureFormat::kPng));
  Write(detail::kGaussianFormat, OneMapAtlas());
  EXPECT_THAT(Names(), ElementsAre("b.png", "a.png"));
  EXPECT_EQ(ReadFile(out_ + "/images/a.png"), ReadFile(folder_ / "a.png"));
  EXPECT_EQ(ReadFile(out_ + "/images/b.png"), ReadFile(folder_ / "b.png"));
  const colmap::Model model = Decoded(colmap::Part::kPoints, "sparse/0/points3D.bin");
  EXPECT_THAT(model.points[0].color, ElementsAre(20, 25, 31));     // the mean of both, rounded
  EXPECT_THAT(model.points[1].color, ElementsAre(128, 128, 128));  // which no keyframe sees
  const colmap::Model cameras = Decoded(colmap::Part::kCameras, "sparse/0/cameras.bin");
  EXPECT_EQ(cameras.cameras[0].model, colmap::kPinhole);
  EXPECT_EQ(cameras.cameras[0].width, std::uint64_t{kWidth});
}

// Pictures in the folder may be anybody's, also the only ones there are.
TEST_F(Scenes, OfSplatsReplaceNoOtherPictures) {
  const auto write = [&] {
    Notices notices;
    const KeyFramePictures pictures{.files = files_, .folder = folder_.Path("")};
    const auto options = WriteOptions{.overwrite = true, .sync = false}.With(ColmapWriteOptions{.pictures = pictures});
    try {
      detail::kGaussianFormat.write(OneMapAtlas(), out_, options, notices);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("written");
  };
  Add("a.png", 0.5, Plain(10, 20, 30));
  EXPECT_EQ(write(), "written");
  EXPECT_EQ(write(), "written");
  const std::string mine = Plain(1, 2, 3), model = ReadFile(out_ + "/sparse/0/points3D.bin");
  folder_.Make("out/images/a.png", mine);
  EXPECT_THAT(write(), HasSubstr("out/images/a.png: is another file than the one that is written"));
  EXPECT_EQ(ReadFile(out_ + "/images/a.png"), mine);
  EXPECT_EQ(ReadFile(out_ + "/sparse/0/points3D.bin"), model);
}

TEST_F(Scenes, NameWhatTheyLeaveOut) {
  Atlas atlas = OneMapAtlas();
  atlas.maps[0].points[2].position.x() = std::nanf("");
  for (const Format* format : {&detail::kGaussianFormat, &detail::kNerfFormat}) {
    fs::remove_all(out_);
    EXPECT_THAT(Write(*format, atlas),
                AllOf(HasSubstr("2 poses, 1 point, 1 bad one left out"), HasSubstr("1 point left out, not finite")));
  }
}

// What the lens bent is made anew, and what is neither PNG nor JPEG becomes PNG.
TEST_F(Scenes, OfSplatsAreUndistorted) {
  Atlas atlas = OneMapAtlas();
  Distort(atlas);
  Add("a.pgm", 0.5, "P5 129 97 255\n" + std::string(static_cast<std::size_t>(kWidth) * kHeight, '\x40'));
  Add("b.jpeg", 1.5, Plain(64, 64, 64, PictureFormat::kJpeg));
  Write(detail::kGaussianFormat, atlas);
  EXPECT_THAT(Names(), ElementsAre("b.jpeg", "a.png"));
  const ColorPicture straight = ReadColorPicture(out_ + "/images/a.png");
  EXPECT_EQ(straight.pixels[3 * (48 * kWidth + 64)], 0x40);
  EXPECT_EQ(ReadFile(out_ + "/images/b.jpeg").substr(0, 3), "\xff\xd8\xff");
  for (const colmap::Camera& camera : Decoded(colmap::Part::kCameras, "sparse/0/cameras.bin").cameras)
    EXPECT_EQ(camera.model, colmap::kPinhole);
}

TEST_F(Scenes, OfSplatsHaveOneNameForEachPicture) {
  Add("a/b.png", 0.5, Plain(1, 1, 1));
  Add("a_b.png", 1.5, Plain(2, 2, 2));
  Write(detail::kGaussianFormat, OneMapAtlas());
  EXPECT_THAT(Names(), ElementsAre("a_b.png", "2_a_b.png"));
  EXPECT_EQ(ReadFile(out_ + "/images/a_b.png"), ReadFile(folder_ / "a_b.png"));
  EXPECT_EQ(ReadFile(out_ + "/images/2_a_b.png"), ReadFile(folder_ / "a/b.png"));
}

// Names of files may be nearly anything; none leads out of the folder.
TEST_F(Scenes, OfSplatsTakeHostileNames) {
  Add("..\n\"\xff.png", 0.5, Plain(1, 1, 1));
  Add("$(x) ;'.png", 1.5, Plain(2, 2, 2));
  files_[1].path = folder_ / "sub/../$(x) ;'.png";
  fs::create_directory(folder_ / "sub");
  Write(detail::kGaussianFormat, OneMapAtlas());
  ASSERT_THAT(Names(), ElementsAre("sub_.._$(x) ;'.png", "..\n\"\xff.png"));
  for (const std::string& name : Names()) EXPECT_TRUE(fs::exists(out_ + "/images/" + name)) << name;
}

TEST_F(Scenes, WithoutPicturesAreOfPoses) {
  Atlas atlas = OneMapAtlas();
  for (const Format& format : {detail::kGaussianFormat, detail::kNerfFormat}) {
    fs::remove_all(out_);
    EXPECT_THAT(Write(format, atlas), HasSubstr("2 poses, "));
  }
  fs::remove_all(out_);
  atlas.maps[0].keyframes[0].camera_from_world.rotation.coeffs().setZero();
  EXPECT_THAT(Write(detail::kNerfFormat, atlas), AllOf(HasSubstr("1 pose, "), HasSubstr("1 keyframe left out, whose")));
}

TEST_F(Scenes, LeaveOutImagesWithoutPicture) {
  Add("a.png", 0.5, Plain(1, 1, 1));
  EXPECT_THAT(Write(detail::kGaussianFormat, OneMapAtlas()),
              HasSubstr("1 image left out, of which there is no picture"));
  EXPECT_EQ(keyframes_, 1);
  EXPECT_THAT(Names(), ElementsAre("a.png"));
  const colmap::Model model = Decoded(colmap::Part::kPoints, "sparse/0/points3D.bin");
  EXPECT_THAT(model.tracks, ElementsAre(colmap::TrackElement{2, 0}));
  fs::remove_all(out_);
  Write(detail::kNerfFormat, OneMapAtlas());
  EXPECT_EQ(nlohmann::json::parse(ReadFile(out_ + "/transforms.json")).at("frames").size(), 1U);
}

TEST_F(Scenes, RefusePicturesThatAreNone) {
  const std::string whole = Plain(1, 2, 3);
  const auto refusal = [&](const Format& format, const std::string& bytes) {
    files_.clear();
    Add("a.png", 0.5, bytes);
    Add("b.png", 1.5, whole);
    const std::string problem = Write(format, OneMapAtlas());
    EXPECT_FALSE(fs::exists(out_));
    EXPECT_THAT(folder_.Names(), ElementsAre("a.png", "b.png"));  // and nothing beside it
    return problem;
  };
  for (const Format* format : {&detail::kGaussianFormat, &detail::kNerfFormat}) {
    for (const std::size_t size : {0UL, 4UL, 40UL, whole.size() / 2, whole.size() - 20})
      EXPECT_THAT(refusal(*format, whole.substr(0, size)), HasSubstr("a.png")) << size;
    EXPECT_THAT(refusal(*format, "no picture"), HasSubstr("a.png: is no picture"));
    EXPECT_THAT(refusal(*format, Plain(1, 1, 1, PictureFormat::kPng, 640)), HasSubstr("a.png: has 640 x 97 pixels"));
    EXPECT_THAT(refusal(*format, Plain(1, 1, 1, PictureFormat::kPng, kWidth + 1)),
                HasSubstr("and another picture of the camera"));
  }
}

TEST_F(Scenes, RefusePicturesThatAreNotThere) {
  files_ = {{folder_ / "a.png", 0.5, true}};
  EXPECT_THAT(Write(detail::kGaussianFormat, OneMapAtlas()), HasSubstr("a.png"));
  EXPECT_THAT(folder_.Names(), IsEmpty());
}

TEST_F(Scenes, RefusePicturesOfOtherTimesOrOfNone) {
  files_ = {{"a.png", 1, false}, {"b.png", 2, false}};
  EXPECT_THAT(Write(detail::kNerfFormat, OneMapAtlas()), HasSubstr("a list of `time name` tells them (2 pictures)"));
  files_ = {{"a.png", 1400, true}, {"b.png", 1401.5, true}};
  EXPECT_THAT(
      Write(detail::kNerfFormat, OneMapAtlas()),
      HasSubstr("none of the 2 pictures is near in time to a keyframe: they are from 1400 s to 1401.5 s, and kf 3 "
                "is of 1.5 s"));
}

TEST_F(Scenes, OfNerfsSayWhatSmallAtlasIs) {
  Write(detail::kNerfFormat, SmallAtlas());
  const auto json = nlohmann::json::parse(ReadFile(out_ + "/0/transforms.json"));
  EXPECT_EQ(json.at("camera_model"), "OPENCV");
  EXPECT_EQ(json.at("fl_x"), 100);
  EXPECT_EQ(json.at("cx"), 64.5);
  EXPECT_EQ(json.at("cy"), 48.5);
  EXPECT_EQ(json.at("applied_transform"), nlohmann::json::parse("[[1,0,0,0],[0,0,1,0],[0,-1,0,0]]"));
  const auto& frame = json.at("frames").at(0);
  EXPECT_EQ(frame.at("file_path"), "1.5.png");
  // At (1, 0, 0), looking along the z of the atlas, which is y of the scene; up is against y, which is z.
  EXPECT_EQ(frame.at("transform_matrix"), nlohmann::json::parse("[[1,0,0,1],[0,0,-1,0],[0,1,0,0],[0,0,0,1]]"));
  const std::string points = ReadFile(out_ + "/0/points.ply");
  EXPECT_THAT(points, HasSubstr("element vertex 2\n"));
  EXPECT_TRUE(fs::exists(out_ + "/1/transforms.json"));  // maps are not aligned
}

TEST_F(Scenes, OfNerfsHaveZUp) {
  const auto turn_of = [&](const Atlas& atlas) {
    fs::remove_all(out_);
    Write(detail::kNerfFormat, atlas);
    const auto applied = nlohmann::json::parse(ReadFile(out_ + "/transforms.json")).at("applied_transform");
    Eigen::Matrix3d turn;
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column) turn(row, column) = applied.at(row).at(column);
    return turn;
  };
  Atlas atlas = SynthesizeAtlas({.sensor = Sensor::kStereo, .inertial = true, .keyframes = 8, .points = 100});
  EXPECT_TRUE((turn_of(atlas) * UpOf(atlas.maps[0]).direction).isApprox(Eigen::Vector3d::UnitZ(), 0.05));
  EXPECT_TRUE(turn_of(atlas).isIdentity());
  const Eigen::Quaternionf tilt(Eigen::AngleAxisf(0.7F, Eigen::Vector3f(1, 2, 0.5F).normalized()));
  TransformMap(atlas.maps[0], {1, tilt.cast<double>(), Eigen::Vector3d::Zero()});
  EXPECT_TRUE((turn_of(atlas) * UpOf(atlas.maps[0]).direction).isApprox(Eigen::Vector3d::UnitZ(), 1e-4));
}

TEST_F(Scenes, OfNerfsLeaveThePicturesWhereTheyAre) {
  Add("pictures/\"a\n.png", 0.5, Plain(1, 1, 1));
  Write(detail::kNerfFormat, OneMapAtlas());
  const auto json = nlohmann::json::parse(ReadFile(out_ + "/transforms.json"));
  const std::string path = json.at("frames").at(0).at("file_path");
  EXPECT_EQ(path, "../pictures/\"a\n.png");
  EXPECT_TRUE(fs::exists(fs::path(out_) / path));
}

TEST_F(Scenes, OfNerfsCannotNameWhatIsNoUtf8) {
  Add("a\xff.png", 0.5, Plain(1, 1, 1));
  EXPECT_THAT(Write(detail::kNerfFormat, OneMapAtlas()), HasSubstr("no UTF-8, which JSON cannot hold"));
  EXPECT_FALSE(fs::exists(out_));
}

}  // namespace
}  // namespace slamdb
