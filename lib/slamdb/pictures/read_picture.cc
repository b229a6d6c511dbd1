// SPDX-License-Identifier: BSD-3-Clause
// The formats that cameras and datasets write, each by its own small library: OpenCV's reader of pictures would do, but
// brings a hundred libraries along, which every start of the command would load.
#include <png.h>
#include <turbojpeg.h>

#include <algorithm>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <string_view>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/pictures/color_picture.h"
#include "slamdb/pictures/pictures.h"

namespace slamdb {
namespace {

using detail::Concat;
using Bytes = std::span<const std::byte>;

constexpr std::uint64_t kMostPixels = std::uint64_t{1} << 26;

struct NotReadable {
  std::string why;
};

std::string_view TextOf(Bytes bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

enum class Wanted { kGray, kColor };

// Gray, or red, green and blue.
struct Pixels {
  std::int32_t width = 0, height = 0;
  std::size_t channels = 1;
  std::vector<std::uint8_t> values;
};

// Before anything is allocated.
Pixels PixelsOf(std::uint64_t width, std::uint64_t height, std::size_t channels) {
  if (width == 0 || height == 0) throw NotReadable{"has no pixels"};
  if (width > kMostPixels || height > kMostPixels || width * height > kMostPixels)
    throw Error(ErrorKind::kOutOfResources, Concat("has ", width, " x ", height, " pixels: too many"));
  Pixels pixels{.width = static_cast<std::int32_t>(width),
                .height = static_cast<std::int32_t>(height),
                .channels = channels,
                .values = {}};
  pixels.values.resize(width * height * channels);
  return pixels;
}

// As ORB-SLAM3 turns colours into gray.
std::vector<std::uint8_t> GrayOf(Pixels&& pixels) {
  if (pixels.channels == 1) return std::move(pixels.values);
  std::vector<std::uint8_t> gray(pixels.values.size() / pixels.channels);
  const cv::Mat from(pixels.height, pixels.width, CV_8UC3, pixels.values.data());
  const cv::Mat to(pixels.height, pixels.width, CV_8UC1, gray.data());
  cv::cvtColor(from, to, cv::COLOR_RGB2GRAY);
  return gray;
}

std::vector<std::uint8_t> ColorsOf(Pixels&& pixels) {
  if (pixels.channels == 3) return std::move(pixels.values);
  std::vector<std::uint8_t> colors;
  colors.reserve(3 * pixels.values.size());
  for (const std::uint8_t value : pixels.values) colors.insert(colors.end(), 3, value);
  return colors;
}

// Without what says how values are to be shown: they are taken as they are, as OpenCV and so ORB-SLAM3 take them.
std::string WithoutGamma(std::string_view png) {
  constexpr std::size_t kSignature = 8, kAround = 12;  // of a chunk: length, type, checksum
  std::string plain(png.substr(0, kSignature));
  for (png.remove_prefix(plain.size()); png.size() >= kAround;) {
    std::uint32_t length = 0;
    for (int i = 0; i < 4; ++i) length = length << 8U | static_cast<std::uint8_t>(png[static_cast<std::size_t>(i)]);
    const std::string_view type = png.substr(4, 4), chunk = png.substr(0, kAround + std::size_t{length});
    if (type != "gAMA" && type != "sRGB" && type != "iCCP" && type != "cHRM") plain += chunk;
    png.remove_prefix(chunk.size());
  }
  return plain;
}

Pixels ReadPng(Bytes bytes) {
  const std::string plain = WithoutGamma(TextOf(bytes));
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  const std::unique_ptr<png_image, decltype(&png_image_free)> guard(&image, png_image_free);
  const auto need = [&](int done) {
    if (done == 0 || PNG_IMAGE_FAILED(image)) throw NotReadable{image.message};
  };
  need(png_image_begin_read_from_memory(&image, plain.data(), plain.size()));
  const bool wide = (image.format & PNG_FORMAT_FLAG_LINEAR) != 0;  // 16 bits
  const bool color = (image.format & PNG_FORMAT_FLAG_COLOR) != 0;
  Pixels pixels = PixelsOf(image.width, image.height, color && !wide ? 3 : 1);
  const png_color black{};
  if (wide) {
    image.format = PNG_FORMAT_LINEAR_Y;
    std::vector<std::uint16_t> values(pixels.values.size());
    need(png_image_finish_read(&image, &black, values.data(), 0, nullptr));
    std::ranges::transform(values, pixels.values.begin(),
                           [](std::uint16_t value) { return static_cast<std::uint8_t>(value >> 8U); });
    return pixels;
  }
  image.format = color ? PNG_FORMAT_RGB : PNG_FORMAT_GRAY;
  need(png_image_finish_read(&image, &black, pixels.values.data(), 0, nullptr));
  return pixels;
}

Pixels ReadJpeg(Bytes bytes, Wanted wanted) {
  const std::unique_ptr<void, decltype(&tjDestroy)> decoder(tjInitDecompress(), tjDestroy);
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  const auto need = [&](int failed) {
    if (failed != 0) throw NotReadable{tjGetErrorStr2(decoder.get())};
  };
  int width = 0, height = 0, sampling = 0, colors = 0;
  need(tjDecompressHeader3(decoder.get(), data, bytes.size(), &width, &height, &sampling, &colors));
  const bool color = wanted == Wanted::kColor && colors != TJCS_GRAY;
  Pixels pixels = PixelsOf(static_cast<std::uint64_t>(width), static_cast<std::uint64_t>(height), color ? 3 : 1);
  need(tjDecompress2(decoder.get(), data, bytes.size(), pixels.values.data(), width, 0, height,
                     color ? TJPF_RGB : TJPF_GRAY, TJFLAG_LIMITSCANS | TJFLAG_STOPONWARNING));
  return pixels;
}

// "P5 WIDTH HEIGHT 255" or P6, with comments between, a single space, then the pixels.
Pixels ReadPnm(Bytes bytes) {
  std::string_view text = TextOf(bytes);
  const std::size_t channels = text[1] == '6' ? 3 : 1;
  text.remove_prefix(2);
  const auto next = [&] {
    for (constexpr std::string_view kSpaces = " \t\r\n";
         !text.empty() && (kSpaces.find(text.front()) != std::string_view::npos || text.front() == '#');)
      text.remove_prefix(text.front() == '#' ? std::min(text.find('\n'), text.size()) : 1);
    std::uint64_t number = 0;
    for (; !text.empty() && text.front() >= '0' && text.front() <= '9'; text.remove_prefix(1))
      number = std::min<std::uint64_t>(10 * number + static_cast<std::uint64_t>(text.front() - '0'), 2 * kMostPixels);
    return number;
  };
  const std::uint64_t width = next(), height = next();
  if (next() != 255) throw NotReadable{"has other values than of a byte"};
  if (text.empty() || width == 0 || height == 0 || (text.size() - 1) / channels / width < height)
    throw NotReadable{"ends within its pixels"};
  Pixels pixels = PixelsOf(width, height, channels);
  text = text.substr(1, pixels.values.size());
  std::copy(text.begin(), text.end(), pixels.values.begin());
  return pixels;
}

Pixels Read(const Source& source, Wanted wanted) {
  const WholeFile file(source);
  const std::string_view text = TextOf(file.bytes());
  try {
    if (text.starts_with("\x89PNG")) return ReadPng(file.bytes());
    if (text.starts_with("\xff\xd8\xff")) return ReadJpeg(file.bytes(), wanted);
    if (text.starts_with("P5") || text.starts_with("P6")) return ReadPnm(file.bytes());
  } catch (const NotReadable& error) {
    throw Error(ErrorKind::kDamaged, file.path(), "", "is a damaged picture: " + error.why);
  } catch (const Error& error) {
    throw Error(error.kind(), file.path(), "", error.problem());
  }
  throw Error(ErrorKind::kDamaged, file.path(), "", "is no picture: PNG, JPEG, PGM and PPM are read");
}

}  // namespace

GrayPicture ReadPicture(const Source& source) {
  Pixels pixels = Read(source, Wanted::kGray);
  return {.width = pixels.width, .height = pixels.height, .pixels = GrayOf(std::move(pixels))};
}

ColorPicture ReadColorPicture(const Source& source) {
  Pixels pixels = Read(source, Wanted::kColor);
  return {.width = pixels.width, .height = pixels.height, .pixels = ColorsOf(std::move(pixels))};
}

}  // namespace slamdb
