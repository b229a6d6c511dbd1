// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "slamdb/base/error.h"

// MRPT's archives: little endian; an object is a header byte 0x80 | length of the class name, the name, a version byte,
// the contents, and the end flag 0x88.
namespace slamdb::mrpt {

using namespace std::string_view_literals;

inline constexpr char kEndFlag = '\x88';
inline constexpr std::string_view kMapClass = "mrpt::maps::CLandmarksMap", kLandmarkClass = "mrpt::maps::CLandmark",
                                  kFeatureClass = "mrpt::vision::CFeature";
inline constexpr std::uint8_t kMapVersion = 0, kLandmarkVersion = 4, kFeatureVersion = 2;

// What stands before a std::optional of that type, and before a std::vector of features: strings with their lengths.
inline constexpr std::string_view kOptionalImage = "\x0d\0\0\0std::optional\x11\0\0\0mrpt::img::CImage"sv;
inline constexpr std::string_view kOptionalBytes = "\x0d\0\0\0std::optional\x14\0\0\0std::vector<uint8_t>"sv;
inline constexpr std::string_view kOptionalFloats = "\x0d\0\0\0std::optional\x12\0\0\0std::vector<float>"sv;
inline constexpr std::string_view kOptionalMatrix = "\x0d\0\0\0std::optional\x14\0\0\0mrpt::math::CMatrixF"sv;
inline constexpr std::string_view kFeatureVector = "\x0b\0\0\0std::vector\x16\0\0\0mrpt::vision::CFeature"sv;

inline std::string HeaderOf(std::string_view name, std::uint8_t version) {
  std::string header(1, static_cast<char>(0x80 | name.size()));
  return header.append(name).append(1, static_cast<char>(version));
}

// Reads bytes from front to back without trust.
class StreamReader {
 public:
  StreamReader(std::string path, std::string_view bytes) : path_(std::move(path)), bytes_(bytes) {}

  std::size_t left() const { return bytes_.size() - at_; }
  std::string_view rest() const { return bytes_.substr(at_); }

  // What is being read, for errors: `landmark 3`.
  void SetPlace(std::string place) { place_ = std::move(place); }
  Error Bad(const std::string& problem, ErrorKind kind = ErrorKind::kDamaged) const {
    return Error(kind, path_, "byte " + std::to_string(at_) + (place_.empty() ? "" : ", " + place_), problem);
  }

  std::string_view Take(std::size_t size, std::string_view what) {
    if (size > left())
      throw Bad(std::string(what) + " of " + std::to_string(size) + " bytes does not fit into the " +
                std::to_string(left()) + " bytes left: the file is truncated");
    at_ += size;
    return bytes_.substr(at_ - size, size);
  }
  template <class Number>
  Number Get(std::string_view what) {
    Number number;
    std::memcpy(&number, Take(sizeof number, what).data(), sizeof number);
    return number;
  }
  void Expect(std::string_view expected, std::string_view what) {
    if (left() < expected.size() && expected.starts_with(rest())) Take(expected.size(), what);  // throws
    if (!rest().starts_with(expected)) throw Bad("expected " + std::string(what));
    at_ += expected.size();
  }
  void ExpectEndFlag(std::string_view what) { Expect({&kEndFlag, 1}, "the end flag of " + std::string(what)); }

 private:
  std::string path_;
  std::string_view bytes_;
  std::size_t at_ = 0;
  std::string place_;
};

}  // namespace slamdb::mrpt
