// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/colmap/detail/names.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <unordered_set>
#include <utility>

#include "slamdb/base/detail/amounts.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/median.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"

namespace slamdb::colmap {
namespace {

namespace fs = std::filesystem;
using detail::Concat;
using detail::Counted;

// The pictures in order of time.
class Pictures {
 public:
  explicit Pictures(const KeyFramePictures& pictures) : folder_(pictures.folder) {
    for (const PictureFile& file : pictures.files)
      if (file.has_time) files_.push_back(&file);
    if (files_.empty() && !pictures.files.empty())
      throw Error(
          ErrorKind::kUsage, pictures.files.front().path, "",
          Concat("has no time in its name, and none of the other pictures has: a list of `time name` tells them (",
                 Counted(pictures.files.size(), "picture"), ")"));
    std::ranges::stable_sort(files_, {}, &PictureFile::timestamp);
    std::vector<double> ways;
    for (std::size_t row = 1; row < files_.size(); ++row)
      ways.push_back(files_[row]->timestamp - files_[row - 1]->timestamp);
    constexpr double kAlone = 0.02;  // seconds
    most_ = ways.empty() ? kAlone : detail::ElementInOrder(ways, ways.size() / 2) / 2;
  }

  double first() const { return files_.front()->timestamp; }
  double last() const { return files_.back()->timestamp; }

  // Null when the nearest is too far away.
  const PictureFile* Nearest(double time) const {
    const auto after = std::ranges::lower_bound(files_, time, {}, &PictureFile::timestamp);
    const PictureFile* nearest = after == files_.end() ? nullptr : *after;
    if (after != files_.begin()) {
      const PictureFile* before = *(after - 1);
      if (nearest == nullptr || time - before->timestamp <= nearest->timestamp - time) nearest = before;
    }
    return nearest != nullptr && std::abs(nearest->timestamp - time) <= most_ ? nearest : nullptr;
  }

  // Relative to the folder, or the file's own where no way leads from one to the other.
  std::string NameOf(const PictureFile& file) const {
    const fs::path path(file.path);
    const fs::path relative = folder_.empty() ? fs::path() : path.lexically_relative(folder_);
    const bool inside = !relative.empty() && *relative.begin() != "..";
    return (inside ? relative : path.filename()).string();
  }

 private:
  std::string folder_;
  std::vector<const PictureFile*> files_;
  double most_ = 0;  // seconds
};

[[noreturn]] void RefuseAll(const KeyFramePictures& pictures, const Pictures& files, const View& first) {
  throw Error(ErrorKind::kUsage, pictures.files.front().path, "",
              Concat("none of the ", Counted(pictures.files.size(), "picture"),
                     " is near in time to a keyframe: they are from ", detail::SecondsText(files.first()), " s to ",
                     detail::SecondsText(files.last()), " s, and ", first.keyframe->id, " is of ",
                     detail::SecondsText(first.keyframe->timestamp), " s"));
}

std::string NameByTime(const View& view) {
  std::string name;
  if (std::isfinite(view.keyframe->timestamp))
    detail::AppendSeconds(name, view.keyframe->timestamp);
  else
    name = Concat("kf", view.keyframe->id.value());
  const bool pair = view.keyframe->features.is_fisheye_stereo();
  return (pair ? view.right ? "right/" : "left/" : "") + name + ".png";
}

}  // namespace

void NameImages(Outline& outline, const KeyFramePictures& pictures) {
  const Pictures files(pictures);
  const View* first = nullptr;
  std::uint64_t keyframes = 0;
  std::unordered_set<std::string> taken;
  for (MapOutline& map : outline.maps)
    for (View& view : map.views) {
      if (first == nullptr) first = &view;
      keyframes += view.right ? 0 : 1;
      const PictureFile* file = view.right ? nullptr : files.Nearest(view.keyframe->timestamp);
      if (file == nullptr && !view.right && !pictures.files.empty()) ++outline.without_picture;
      if (file != nullptr) view.picture = file->path;
      const std::string name = file == nullptr ? NameByTime(view) : files.NameOf(*file);
      view.name = name;
      while (!taken.insert(view.name).second) view.name = Concat(view.image, "/", view.name);
    }
  if (keyframes > 0 && outline.without_picture == keyframes) RefuseAll(pictures, files, *first);
}

std::optional<double> TimeInName(std::string_view name) {
  constexpr double kNanoseconds = 1e15;  // from here on a time is in these
  const std::string stem = fs::path(name).stem().string();
  const std::optional<double> number = detail::ParseNumber<double>(stem);
  if (!number || !std::isfinite(*number)) return std::nullopt;
  return *number >= kNanoseconds ? *number / 1e9 : *number;
}

}  // namespace slamdb::colmap
