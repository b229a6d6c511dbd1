// SPDX-License-Identifier: BSD-3-Clause
#include <png.h>
#include <turbojpeg.h>

#include <memory>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/pictures/color_picture.h"

namespace slamdb {
namespace {

[[noreturn]] void Fail(const std::string& why) {
  throw Error(ErrorKind::kNotPossible, "a picture cannot be encoded: " + why);
}

std::string EncodePng(const ColorPicture& picture) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(picture.width);
  image.height = static_cast<png_uint_32>(picture.height);
  image.format = PNG_FORMAT_RGB;
  const std::unique_ptr<png_image, decltype(&png_image_free)> guard(&image, png_image_free);
  std::string bytes(PNG_IMAGE_PNG_SIZE_MAX(image), '\0');
  png_alloc_size_t size = bytes.size();
  if (png_image_write_to_memory(&image, bytes.data(), &size, 0, picture.pixels.data(), 0, nullptr) == 0)
    Fail(image.message);
  bytes.resize(size);
  return bytes;
}

std::string EncodeJpeg(const ColorPicture& picture) {
  constexpr int kQuality = 95;
  const std::unique_ptr<void, decltype(&tjDestroy)> encoder(tjInitCompress(), tjDestroy);
  unsigned char* made = nullptr;
  unsigned long size = 0;
  const int failed = tjCompress2(encoder.get(), picture.pixels.data(), picture.width, 0, picture.height, TJPF_RGB,
                                 &made, &size, TJSAMP_444, kQuality, TJFLAG_ACCURATEDCT);
  const std::unique_ptr<unsigned char, decltype(&tjFree)> guard(made, tjFree);
  if (failed != 0) Fail(tjGetErrorStr2(encoder.get()));
  return {reinterpret_cast<const char*>(made), size};
}

}  // namespace

std::string EncodePicture(const ColorPicture& picture, PictureFormat format) {
  return format == PictureFormat::kPng ? EncodePng(picture) : EncodeJpeg(picture);
}

}  // namespace slamdb
