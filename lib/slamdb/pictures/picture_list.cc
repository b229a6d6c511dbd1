// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/pictures/picture_list.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string_view>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"
#include "slamdb/base/file.h"

namespace slamdb {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMost = 1'000'000;
constexpr double kNanoseconds = 1e15;  // from here on a time is in these

std::string SuffixOf(const fs::path& path) {
  std::string suffix = path.extension().string();
  for (char& letter : suffix) letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  return suffix;
}

bool IsPicture(const fs::path& path) {
  constexpr std::array kSuffixes = {".png", ".jpg", ".jpeg", ".pgm", ".ppm"};
  return std::ranges::find(kSuffixes, SuffixOf(path)) != kSuffixes.end();
}

std::optional<double> TimeOf(std::string_view text) {
  const std::optional<double> number = detail::ParseNumber<double>(text);
  if (!number || !std::isfinite(*number)) return std::nullopt;
  return *number >= kNanoseconds ? *number / 1e9 : *number;
}

class Finder {
 public:
  void Add(const std::string& name) {
    const std::string suffix = SuffixOf(name);
    std::error_code error;
    if (fs::is_directory(name, error)) return AddFolder(name);
    if (suffix == ".txt" || suffix == ".csv") return AddList(name);
    AddOne(name, TimeOf(fs::path(name).stem().string()));
  }
  std::vector<PictureFile> Take() { return std::move(found_); }

 private:
  void AddOne(const std::string& path, std::optional<double> time) {
    if (found_.size() == kMost) throw Error(ErrorKind::kOutOfResources, "more than a million pictures were named");
    found_.push_back({path, time.value_or(static_cast<double>(found_.size() + 1)), time.has_value()});
  }

  void AddFolder(const std::string& name) {
    std::vector<std::string> paths;
    std::error_code error;
    for (fs::directory_iterator at(name, error), end; !error && at != end; at.increment(error))
      if (IsPicture(at->path())) paths.push_back(at->path().string());
    if (error) throw Error(ErrorKind::kPermission, name, "", error.message());
    if (paths.empty()) throw Error(ErrorKind::kNotFound, name, "", "is a folder without pictures");
    std::ranges::sort(paths);
    for (const std::string& path : paths) AddOne(path, TimeOf(fs::path(path).stem().string()));
  }

  void AddList(const std::string& name) {
    const WholeFile file{Source(name)};
    std::string_view text = detail::WithoutMark(file.text());
    const fs::path folder = fs::path(name).parent_path();
    const std::size_t before = found_.size();
    for (std::size_t number = 1; !text.empty(); ++number) {
      std::string_view line = detail::TakeLine(text);
      if (detail::Trimmed(line).empty() || detail::IsCommentMark(detail::Trimmed(line).front())) continue;
      AddLine(line, number, name, folder);
    }
    if (found_.size() == before) throw Error(ErrorKind::kDamaged, name, "", "names no pictures");
  }

  static std::string_view Unquoted(std::string_view word) {
    const bool quoted = word.size() > 1 && word.front() == '"' && word.back() == '"';
    return quoted ? word.substr(1, word.size() - 2) : word;
  }

  // Beside the list, or in the folder `data` there.
  static fs::path PlaceOf(std::string_view name, const fs::path& folder) {
    const fs::path path(name);
    std::error_code error;
    const fs::path place = path.is_absolute() ? path : folder / path, inside = folder / "data" / path;
    return !fs::exists(place, error) && fs::exists(inside, error) ? inside : place;
  }

  void AddLine(std::string_view line, std::size_t number, const std::string& name, const fs::path& folder) {
    std::optional<double> time;
    std::string_view rest = line;
    bool has_number = false;
    constexpr std::string_view kSeparators = " \t,;";
    for (std::string_view word;;) {
      rest.remove_prefix(std::min(rest.find_first_not_of(kSeparators), rest.size()));
      const fs::path whole = PlaceOf(Unquoted(detail::Trimmed(rest)), folder);  // of a name with spaces
      std::error_code error;
      if (IsPicture(whole) && fs::exists(whole, error))
        return AddOne(whole.string(), time ? time : TimeOf(whole.stem().string()));
      word = Unquoted(detail::TakeWord(rest, kSeparators));
      if (word.empty()) break;
      if (IsPicture(fs::path(word)))
        return AddOne(PlaceOf(word, folder).string(), time ? time : TimeOf(fs::path(word).stem().string()));
      has_number = has_number || TimeOf(word);
      if (!time) time = TimeOf(word);
    }
    if (number == 1 && !has_number) return;  // the names of columns
    throw Error(ErrorKind::kDamaged, name, detail::Concat("line ", number),
                "names no picture; a list has one a line, behind its time or alone: " + detail::Excerpt(line));
  }

  std::vector<PictureFile> found_;
};

}  // namespace

std::vector<PictureFile> FindPictures(std::span<const std::string> named) {
  Finder finder;
  for (const std::string& name : named) finder.Add(name);
  return finder.Take();
}

}  // namespace slamdb
