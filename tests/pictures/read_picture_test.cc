// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <png.h>
#include <turbojpeg.h>

#include <memory>
#include <optional>
#include <string>

#include "slamdb/pictures/pictures.h"
#include "tests/support/kind_of.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace slamdb {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string Png(std::uint32_t format, std::uint32_t width, std::uint32_t height, const void* pixels) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.format = format;
  image.width = width;
  image.height = height;
  std::string bytes(10'000, '\0');
  png_alloc_size_t size = bytes.size();
  EXPECT_NE(png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels, 0, nullptr), 0) << image.message;
  bytes.resize(size);
  return bytes;
}

std::string Jpeg(int width, int height, const std::vector<unsigned char>& colors) {
  const std::unique_ptr<void, decltype(&tjDestroy)> encoder(tjInitCompress(), tjDestroy);
  unsigned char* out = nullptr;
  unsigned long size = 0;  // NOLINT(google-runtime-int): turbojpeg's
  EXPECT_EQ(tjCompress2(encoder.get(), colors.data(), width, 0, height, TJPF_RGB, &out, &size, TJSAMP_444, 100, 0), 0);
  std::string bytes(reinterpret_cast<const char*>(out), size);
  tjFree(out);
  return bytes;
}

class ReadPictureTest : public ::testing::Test {
 protected:
  GrayPicture Read(const std::string& bytes) { return ReadPicture(folder_.Make("picture", bytes)); }
  std::optional<ErrorKind> Refused(const std::string& bytes) {
    return KindOf([&] { (void)Read(bytes); });
  }

  const TemporaryFolder folder_;
};

TEST_F(ReadPictureTest, GrayPng) {
  const std::vector<std::uint8_t> pixels = {0, 64, 127, 16, 32, 255};
  const GrayPicture picture = Read(Png(PNG_FORMAT_GRAY, 3, 2, pixels.data()));
  EXPECT_EQ(picture.width, 3);
  EXPECT_EQ(picture.height, 2);
  EXPECT_EQ(picture.pixels, pixels);
}

// 0.299 R + 0.587 G + 0.114 B, of the values as they are.
TEST_F(ReadPictureTest, ColoursBecomeGray) {
  const std::vector<std::uint8_t> pixels = {200, 0, 0, 0, 200, 0, 0, 0, 200, 200, 200, 200};
  EXPECT_THAT(Read(Png(PNG_FORMAT_RGB, 4, 1, pixels.data())).pixels, ElementsAre(60, 117, 23, 200));
  EXPECT_THAT(Read("P6 4 1 255\n" + std::string(pixels.begin(), pixels.end())).pixels, ElementsAre(60, 117, 23, 200));
}

TEST_F(ReadPictureTest, TransparencyIsOnBlack) {
  const std::vector<std::uint8_t> pixels = {200, 200, 200, 255, 200, 200, 200, 0};
  EXPECT_THAT(Read(Png(PNG_FORMAT_RGBA, 2, 1, pixels.data())).pixels, ElementsAre(200, 0));
}

TEST_F(ReadPictureTest, OfSixteenBitsTheHighEightCount) {
  const std::vector<std::uint16_t> pixels = {0, 0x1234, 0xFFFF};
  EXPECT_THAT(Read(Png(PNG_FORMAT_LINEAR_Y, 3, 1, pixels.data())).pixels, ElementsAre(0, 0x12, 0xFF));
}

// As OpenCV, and so ORB-SLAM3, takes them: a gamma of 1 does not make them brighter.
TEST_F(ReadPictureTest, ValuesAreTakenAsTheyAre) {
  const std::vector<std::uint8_t> pixels = {0, 64, 127, 16, 32, 255};
  std::string png = Png(PNG_FORMAT_GRAY, 3, 2, pixels.data());
  const std::string gamma("\0\0\0\4gAMA\0\1\x86\xa0\x31\xe8\x96\x5f", 16);  // 1.0
  png.insert(33, gamma);                                                    // behind the header
  EXPECT_EQ(Read(png).pixels, pixels);
}

TEST_F(ReadPictureTest, Jpeg) {
  const GrayPicture picture = Read(Jpeg(16, 8, std::vector<unsigned char>(std::size_t{3} * 16 * 8, 90)));
  EXPECT_EQ(picture.width, 16);
  EXPECT_EQ(picture.height, 8);
  EXPECT_EQ(picture.pixels, std::vector<std::uint8_t>(std::size_t{16} * 8, 90));
}

TEST_F(ReadPictureTest, PgmWithComments) {
  const std::string pixels = {'\0', '\x40', '\x7f', '\n', '\x20', '#'};
  EXPECT_THAT(Read("P5\n# a camera's\n3 2\n255\n" + pixels).pixels, ElementsAre(0, 64, 127, 10, 32, 35));
}

TEST_F(ReadPictureTest, WhatIsNoneIsRefused) {
  EXPECT_THAT(MessageOf([&] { (void)Read("GIF89a no picture"); }), HasSubstr("PNG, JPEG, PGM and PPM are read"));
  EXPECT_EQ(Refused("GIF89a no picture"), ErrorKind::kDamaged);
  EXPECT_EQ(Refused(""), ErrorKind::kDamaged);
  EXPECT_EQ(KindOf([&] { (void)ReadPicture(folder_.Path("none.png")); }), ErrorKind::kNotFound);
}

TEST_F(ReadPictureTest, CutOnesAreDamaged) {
  const std::vector<std::uint8_t> pixels(48 * 32, 77);
  std::vector<unsigned char> colors;
  for (unsigned i = 0; i < 3 * 48 * 32; ++i) colors.push_back(static_cast<unsigned char>(i * 2654435761U >> 24U));
  for (const std::string& whole : {Png(PNG_FORMAT_GRAY, 48, 32, pixels.data()), Jpeg(48, 32, colors),
                                   "P5 48 32 255\n" + std::string(pixels.begin(), pixels.end())})
    for (const std::size_t size : {std::size_t{3}, whole.size() / 4, whole.size() / 2, whole.size() * 3 / 4})
      EXPECT_EQ(Refused(whole.substr(0, size)), ErrorKind::kDamaged) << size << " of " << whole.size();
}

TEST_F(ReadPictureTest, SizesAreHeldAgainstTheFileAndTheLimit) {
  EXPECT_EQ(Refused("P5\n900000 900000\n255\n"), ErrorKind::kDamaged);
  EXPECT_EQ(Refused("P5\n99999999999999999999 1\n255\n"), ErrorKind::kDamaged);
  std::string png = Png(PNG_FORMAT_GRAY, 1, 1, "x");
  png.replace(16, 8, std::string("\0\1\0\0\0\1\0\0", 8));  // 65536 x 65536; the checksum of the header is wrong now
  EXPECT_EQ(Refused(png), ErrorKind::kDamaged);
  std::string jpeg = Jpeg(16, 8, std::vector<unsigned char>(std::size_t{3} * 16 * 8, 90));
  jpeg.replace(jpeg.find("\xff\xc0") + 5, 4, "\xf0\x01\xf0\x01");  // 61441 x 61441
  EXPECT_EQ(Refused(jpeg), ErrorKind::kOutOfResources);
}

}  // namespace
}  // namespace slamdb
