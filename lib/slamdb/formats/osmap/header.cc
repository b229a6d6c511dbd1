// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/osmap/detail/header.h"

#include <algorithm>
#include <filesystem>
#include <span>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/links.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/import/detail/possible.h"

namespace slamdb::osmap {
namespace {

using detail::Concat;

constexpr std::array<std::string_view, 4> kMembers = {"fx", "fy", "cx", "cy"};

struct SideNames {
  std::string_view file, count;
  Side Header::*side;
  std::uint32_t without;  // bit of Options
};
constexpr std::array<SideNames, 3> kSides = {{{"mappointsFile", "nMappoints", &Header::points, kNoPoints},
                                              {"keyframesFile", "nKeyframes", &Header::keyframes, kNoKeyFrames},
                                              {"featuresFile", "nFeatures", &Header::features, kNoFeatures}}};

class Parser {
 public:
  Parser(std::string_view text, const std::string& path) : rest_(detail::WithoutMark(text)), path_(path) {}

  Header Parse() {
    while (!rest_.empty()) {
      line_ = detail::TakeLine(rest_);
      ++number_;
      if (line_.empty() || line_[0] == '%' || line_[0] == '#' || line_.starts_with("---") || line_ == "...") continue;
      const bool is_key = !detail::IsBlank(line_[0]) && line_[0] != '-';
      if (is_key)
        TakeKey();
      else if (in_cameras_)
        TakeCameraText(line_);
    }
    if (member_ != kMembers.size() && !header_.cameras.empty())
      Fail("a camera matrix without all of fx, fy, cx and cy");
    RequireSides();
    return std::move(header_);
  }

 private:
  [[noreturn]] void Fail(const std::string& problem) const {
    throw Error(ErrorKind::kDamaged, path_, Concat("line ", number_), problem);
  }

  // A header names all three files but those that its options leave out.
  void RequireSides() const {
    for (const SideNames& names : kSides) {
      const Side& side = header_.*names.side;
      if (!side.file.empty() || side.count == 0U || (header_.options & names.without) != 0) continue;
      throw Error(ErrorKind::kDamaged, path_, std::string(names.file),
                  Concat("names no file, and ", names.count, " is not 0; the header was cut off, or edited"));
    }
  }

  // `name: value` at the beginning of a line.
  void TakeKey() {
    const std::size_t colon = line_.find(':', line_[0] == '"' ? line_.find('"', 1) : 0);
    if (colon == std::string_view::npos) Fail(Concat("expected `name: value`, ", detail::Excerpt(line_)));
    const std::string key = Unquoted(line_.substr(0, colon));
    const std::string_view value = line_.substr(colon + 1);
    in_cameras_ = key == "cameraMatrices";
    if (in_cameras_) TakeCameraText(value);
    if (key == "Options") header_.options = static_cast<std::uint32_t>(Whole(value));
    for (const SideNames& names : kSides) {
      if (key == names.file) (header_.*names.side).file = Unquoted(value);
      if (key == names.count) (header_.*names.side).count = Whole(value);
    }
  }

  std::uint64_t Whole(std::string_view text) const {
    const auto number = detail::ParseNumber<std::uint32_t>(detail::Trimmed(text));
    if (!number) Fail(Concat("expected a whole number of at most 32 bits, ", detail::Excerpt(text)));
    return *number;
  }

  // Blanks around, and quotes, off.
  static std::string Unquoted(std::string_view text) {
    text = detail::Trimmed(text);
    if (text.size() < 2 || text.front() != '"' || text.back() != '"') return std::string(text);
    std::string plain;
    for (std::size_t i = 1; i + 1 < text.size(); ++i) {
      if (text[i] == '\\' && i + 2 < text.size()) ++i;
      plain += text[i];
    }
    return plain;
  }

  // `- { fx:1., fy:2.,`: a matrix may go over several lines, and have other members too.
  void TakeCameraText(std::string_view text) {
    while (true) {
      std::string_view name = detail::TakeWord(text, " \t,:{}[]-");
      if (name.empty()) return;
      const std::string_view value = detail::TakeWord(text, " \t,:{}[]");
      const auto member = std::find(kMembers.begin(), kMembers.end(), name) - kMembers.begin();
      if (static_cast<std::size_t>(member) == kMembers.size()) continue;
      if (member == 0) {
        header_.cameras.emplace_back();
        member_ = 0;
      }
      const auto number = detail::ParseNumber<float>(value);
      if (!number) Fail(Concat("`", name, "` must be a number, ", detail::Excerpt(value)));
      if (static_cast<std::size_t>(member) != member_) Fail("a camera matrix is fx, fy, cx and cy, in this order");
      header_.cameras.back()[member_++] = *number;
      if (member_ < kMembers.size()) continue;
      if (const std::string why = WhyNoCamera(header_.cameras.back()); !why.empty()) Fail(why);
    }
  }

  std::string_view rest_, line_;
  const std::string& path_;
  std::size_t number_ = 0;
  bool in_cameras_ = false;
  std::size_t member_ = kMembers.size();  // of the last camera matrix that comes next
  Header header_;
};

std::string Quoted(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + '"';
}

}  // namespace

std::string WhyNoCamera(const CameraMatrix& camera) {
  const std::array<double, 4> numbers = {camera[0], camera[1], camera[2], camera[3]};
  return detail::WhyNoCameraOrNone(numbers[0], numbers[1], std::span(numbers).subspan(2));
}

bool IsHeader(const Probe& probe) {
  return probe.head.starts_with("%YAML") && probe.head.find("mappointsFile") != std::string::npos;
}

std::string PathOf(const std::string& header, const Side& side) {
  const std::filesystem::path name = std::filesystem::path(side.file).filename();
  const auto beside = [&name](const std::string& path) {
    return (std::filesystem::path(path).parent_path() / name).string();
  };
  std::error_code missing;
  const std::string path = beside(detail::LeadsTo(header));
  return std::filesystem::exists(path, missing) ? path : beside(header);
}

Header ParseHeader(std::string_view text, const std::string& path) { return Parser(text, path).Parse(); }

std::string HeaderText(const Header& header) {
  std::string text = "%YAML:1.0\n---\n";
  for (const SideNames& names : kSides) {
    const Side& side = header.*names.side;
    text += Concat(names.file, ": ", Quoted(side.file), "\n", names.count, ": ", side.count.value_or(0), "\n");
  }
  text += Concat("Options: ", header.options, "\n");
  if (header.options == kDelimited) text += "\"Options descriptions\": [ FEATURES_FILE_DELIMITED ]\n";
  text += header.cameras.empty() ? "cameraMatrices: []\n" : "cameraMatrices:\n";
  for (const CameraMatrix& camera : header.cameras) {
    text += "   - { ";
    for (std::size_t i = 0; i < camera.size(); ++i) {
      text.append(i == 0 ? "" : ", ").append(kMembers[i]).append(":");
      detail::AppendNumber(text, camera[i]);
    }
    text += " }\n";
  }
  return text;
}

}  // namespace slamdb::osmap
